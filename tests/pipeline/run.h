// One line from a shape to a result, and the promises that hold of every result.
#pragma once
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "sheetform/decompose.h"
#include "support/shapes.h"

namespace sheetform {

inline Decomposition run(const TriangleSoup& soup, const DecomposeParams& params = {}, int threads = 1,
                         const UserField* field = nullptr, const UserGuides* guides = nullptr) {
  InputMesh input;
  input.soup = soup;
  RunContext context;
  context.threads = threads;
  return decompose(input, params, field, context, guides);
}

inline DecomposeParams with_e_max(double e_max) {
  DecomposeParams params;
  params.e_max = e_max;
  return params;
}

/// Valence of each point: edges that lie on the border, between patches or on a seam of a patch with itself.
inline std::map<int, int> valences(const StripMesh& strips) {
  std::map<int, int> valence;
  for (const StripMesh::Arch& a : strips.arches)
    for (std::size_t i = 0; i + 1 < a.vertices.size(); ++i)
      ++valence[a.vertices[i]], ++valence[a.vertices[i + 1]];
  return valence;
}

/// Nodes in the middle of a side: places of three or more patch edges that are no corner of some patch.
inline int t_junctions(const StripMesh& strips) {
  const std::map<int, int> valence = valences(strips);
  int count = 0;
  for (const StripMesh::Patch& p : strips.patches) {
    const std::set<int> corners(p.corners.begin(), p.corners.end());
    for (int i = 0; i < static_cast<int>(p.boundary.size()); ++i)
      count += valence.at(p.boundary[i]) >= 3 && !corners.count(i);
  }
  return count;
}

inline int self_seams(const StripMesh& strips) {
  int count = 0;
  for (const StripMesh::Arch& a : strips.arches) count += a.patches[0] == a.patches[1];
  return count;
}

inline int creases(const StripMesh& strips) {
  int count = 0;
  for (const StripMesh::Arch& a : strips.arches) count += a.crease;
  return count;
}

inline double crease_length(const StripMesh& strips) {
  double sum = 0;
  for (const StripMesh::Arch& a : strips.arches)
    for (std::size_t i = 0; a.crease && i + 1 < a.vertices.size(); ++i)
      sum += (strips.points[a.vertices[i + 1]] - strips.points[a.vertices[i]]).norm();
  return sum;
}

/// Flat area of one patch.
inline double area_of(const StripMesh& strips, const StripMesh::Patch& patch) {
  double area = 0;
  for (const auto& t : patch.triangles)
    area += (strips.points[t.v[1]] - strips.points[t.v[0]])
                .cross(strips.points[t.v[2]] - strips.points[t.v[0]])
                .norm() /
            2;
  return area;
}

/// Every promise that is independent of the shape; the figures of the report are computed anew.
void expect_sound(const TriangleSoup& soup, const Decomposition& result);

}  // namespace sheetform
