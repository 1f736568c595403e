#include "support/drawing.h"

#include <algorithm>
#include <stdexcept>

#include "support/shapes.h"

namespace sheetform::shapes {
namespace {

// The characters of a drawing: cells and the walls right of them and below them.
struct Cells {
  int columns = 0, rows = 0;
  std::vector<std::string> letter;
  std::vector<std::vector<char>> wall_right, wall_below;

  explicit Cells(const std::string& text) {
    std::size_t at = 0;
    while (at <= text.size()) {
      const std::size_t end = std::min(text.find('/', at), text.size());
      add_line(text.substr(at, end - at));
      at = end + 1;
    }
    rows = static_cast<int>(letter.size());
    columns = static_cast<int>(letter.front().size());
    for (const std::string& row : letter)
      if (static_cast<int>(row.size()) != columns)
        throw std::invalid_argument("rows of unequal length: " + text);
  }

 private:
  void add_line(const std::string& line) {
    if (!letter.empty() && line.find_first_not_of("- ") == std::string::npos) {
      for (std::size_t i = 0; i < line.size(); ++i) wall_below.back().at(i) = line[i] == '-';
      return;
    }
    letter.emplace_back(), wall_right.emplace_back();
    for (char c : line) {
      if (c == '|') {
        wall_right.back().back() = 1;
      } else {
        letter.back() += c, wall_right.back().push_back(0);
      }
    }
    wall_below.emplace_back(letter.back().size(), 0);
  }
};

class Painter {
 public:
  Painter(const std::string& text, const Canvas& canvas) : cells_(text), canvas_(canvas), n_(canvas.steps) {
    width_ = cells_.columns * n_, height_ = cells_.rows * n_;
  }

  Drawing paint() {
    make_mesh();
    out_.network = bare_network(out_.mesh);
    out_.versions.assign(out_.mesh.points.size(), 0);
    for (int row = 0; row <= cells_.rows; ++row) horizontal_line(row);
    for (int column = 0; column <= cells_.columns; ++column) vertical_line(column);
    return std::move(out_);
  }

 private:
  // Grid point i from the left, j from the top.
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j) * (width_ + 1) + i; }
  int& id(int i, int j) {
    return out_.grid_vertex[at(canvas_.roll ? i % width_ : i, canvas_.close ? j % height_ : j)];
  }
  int vertex(int i, int j) {
    int& v = id(i, j);
    if (v >= 0) return v;
    const double x = double(canvas_.roll ? i % width_ : i) / n_;
    const double y = cells_.rows - double(canvas_.close ? j % height_ : j) / n_;
    v = static_cast<int>(points_.size());
    points_.push_back(canvas_.place ? canvas_.place(x, y) : Vector3(x, y, 0));
    return v;
  }

  void make_mesh() {
    out_.grid_vertex.assign(at(0, height_ + 1), -1);
    out_.columns = cells_.columns, out_.rows = cells_.rows, out_.steps = n_;
    std::vector<std::array<int, 3>> faces;
    for (int j = 0; j < height_; ++j)
      for (int i = 0; i < width_; ++i) {
        const char letter = cells_.letter[j / n_][i / n_];
        if (letter == '.') continue;
        const int a = vertex(i, j), b = vertex(i, j + 1), c = vertex(i + 1, j + 1), d = vertex(i + 1, j);
        if ((i + j) % 2 == 0) {
          faces.push_back({a, b, c}), faces.push_back({a, c, d});
        } else {
          faces.push_back({a, b, d}), faces.push_back({b, c, d});
        }
        out_.face_letter.insert(out_.face_letter.end(), 2, letter);
      }
    for (int j = 0; j <= height_; ++j)
      for (int i = 0; i <= width_; ++i) out_.grid_vertex[at(i, j)] = id(i, j);
    out_.mesh = build_surface_mesh(std::move(points_), std::move(faces));
    for (int row = 0; row <= cells_.rows; ++row)
      for (int column = 0; column <= cells_.columns; ++column)
        out_.corner_vertex.push_back(out_.grid_vertex[at(column * n_, row * n_)]);
  }

  char letter(int column, int row) const {
    if (canvas_.roll) column = (column + cells_.columns) % cells_.columns;
    if (canvas_.close) row = (row + cells_.rows) % cells_.rows;
    return row < 0 || column < 0 || row >= cells_.rows || column >= cells_.columns
               ? '.'
               : cells_.letter[row][column];
  }
  bool wall_above(int column, int row) const {
    const char below = letter(column, row), above = letter(column, row - 1);
    if (below == '.' || above == '.') return false;  // the border: already there
    const int from = (row + cells_.rows - 1) % cells_.rows;
    return below != above || cells_.wall_below[from][column];
  }
  bool wall_left(int column, int row) const {
    const char right = letter(column, row), left = letter(column - 1, row);
    if (right == '.' || left == '.') return false;
    const int from = (column + cells_.columns - 1) % cells_.columns;
    return right != left || cells_.wall_right[row][from];
  }

  void mark(bool wall, bool& running, int a, int b) {
    if (!wall) {
      running = false;
      return;
    }
    if (!running && (!canvas_.one_path || path_ < 0)) path_ = out_.network.add_path(PathKind::kTraced);
    running = true;
    out_.network.edge_path[out_.mesh.find_edge(a, b)] = path_;
  }
  void horizontal_line(int row) {
    if (canvas_.close && row == cells_.rows) return;
    bool running = false;
    for (int i = 0; i < width_; ++i)
      mark(wall_above(i / n_, row), running, id(i, row * n_), id(i + 1, row * n_));
  }
  void vertical_line(int column) {
    if (canvas_.roll && column == cells_.columns) return;
    bool running = false;
    for (int j = 0; j < height_; ++j)
      mark(wall_left(column, j / n_), running, id(column * n_, j), id(column * n_, j + 1));
  }

  Cells cells_;
  const Canvas& canvas_;
  int n_, width_, height_, path_ = -1;
  std::vector<Vector3> points_;
  Drawing out_;
};

}  // namespace

std::vector<int> Drawing::faces_of(char letter) const {
  std::vector<int> faces;
  for (std::size_t f = 0; f < face_letter.size(); ++f)
    if (face_letter[f] == letter) faces.push_back(static_cast<int>(f));
  return faces;
}

int Drawing::patch_of(const PatchLayout& layout, char letter) const {
  return layout.face_patch[faces_of(letter).at(0)];
}

int Drawing::vertex_at(int column, int row) const { return corner_vertex.at(row * (columns + 1) + column); }

std::vector<int> Drawing::line(int column, int row, int to_column, int to_row) const {
  const int dx = (to_column > column) - (to_column < column), dy = (to_row > row) - (to_row < row);
  const auto at = [&](int i, int j) { return grid_vertex.at(j * (columns * steps + 1) + i); };
  std::vector<int> edges;
  for (int i = column * steps, j = row * steps; i != to_column * steps || j != to_row * steps;
       i += dx, j += dy)
    edges.push_back(mesh.find_edge(at(i, j), at(i + dx, j + dy)));
  return edges;
}

Drawing drawn(const std::string& text, const Canvas& canvas) { return Painter(text, canvas).paint(); }

}  // namespace sheetform::shapes
