// Layouts written as text: "AAB/AAC" is a mesh of two rows of three cells with the network between the
// letters.
#pragma once
#include <functional>
#include <string>

#include "sheetform/layout/layout.h"

namespace sheetform::shapes {

/// How the cells of a drawing become a mesh.
struct Canvas {
  int steps = 4;          ///< quads along each side of a cell
  bool roll = false;      ///< the right end is glued to the left one: a tube
  bool close = false;     ///< the lower end is glued to the upper one as well: a torus
  bool one_path = false;  ///< the whole network is one path: turns of it are no nodes
  /// Place of (x, y), in cells: x to the right, y up. The plane z = 0 when empty.
  std::function<Vector3(double, double)> place;
};

struct Drawing {
  SurfaceMesh mesh;
  PathNetwork network;
  std::vector<int> versions;      ///< all 0
  std::vector<char> face_letter;  ///< per face
  int columns = 0, rows = 0;

  PatchLayout layout(const LayoutRules& rules = {}) const {
    return extract_layout(mesh, network, versions, rules);
  }
  std::vector<int> faces_of(char letter) const;
  /// The patch that holds the first face of this letter.
  int patch_of(const PatchLayout& layout, char letter) const;
  /// The mesh vertex at a corner of cells: column from the left, row from the top.
  int vertex_at(int column, int row) const;
  /// Mesh edges of the straight line between two corners of cells on one line, in order.
  std::vector<int> line(int column, int row, int to_column, int to_row) const;
  std::vector<int> corner_vertex;  ///< (columns + 1) * (rows + 1) entries, -1 where there is no cell
  std::vector<int> grid_vertex;    ///< the same for all grid points
  int steps = 1;
};

/// Rows from top to bottom, separated by '/'; one character a cell, '.' is a hole. Cells of one letter hang
/// together; the lines between different letters are the network, and every straight run of it is one path.
/// Walls inside of one letter: '|' after a cell stands for its right edge; a row of '-' and ' ' alone, under
/// another row, for lower edges.
///   "AA|AA"      two cells, a wall, two cells     "AAA/ - /AAA"  a wall in the middle that ends inside
///   "AAAA|" rolled: a tube with one seam
Drawing drawn(const std::string& text, const Canvas& canvas = {});

}  // namespace sheetform::shapes
