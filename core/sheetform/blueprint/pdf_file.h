// A PDF 1.6 written from scratch: vector pages in millimetres, layers, no date, the same bytes every time.
#pragma once
#include <string>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Pixels by palette, row by row from the top.
struct PdfImage {
  int width = 0, height = 0;
  std::string pixels;   ///< width * height indices
  std::string palette;  ///< 3 bytes a colour, up to 256
};

/// Content of one page; origin at its lower left, y up, millimetres.
class PdfPage {
 public:
  PdfPage(double width, double height) : width_(width), height_(height) {}
  /// colour "#rrggbb", line width mm.
  void pen(const std::string& colour, double width);
  void line(const std::vector<Vector2>& points, bool closed);
  void fill(const std::vector<Vector2>& points, const std::string& colour);
  /// Helvetica; `size` is the height of capitals in mm. Characters outside Latin-1 become '?'.
  void text(const Vector2& at, const std::string& utf8, double size);
  void image(const Vector2& low, const Vector2& high, PdfImage image);
  /// Everything until end_clip() is drawn inside the rectangle only.
  void begin_clip(const Vector2& low, const Vector2& high);
  void end_clip();
  /// Everything until end_layer() belongs to the optional-content layer of this name.
  void begin_layer(int layer);
  void end_layer();

 private:
  friend class PdfFile;
  void number(double value);
  void point(const Vector2& p);
  double width_, height_;
  std::string content_;
  std::vector<PdfImage> images_;
};

/// Collects pages and writes the file; PrintScaling None, so that viewers print at 100 %.
class PdfFile {
 public:
  /// Index of the layer, for PdfPage::begin_layer.
  int add_layer(const std::string& name);
  void add_page(PdfPage page) { pages_.push_back(std::move(page)); }
  /// Title and the like as UTF-8 text; keys as in the information dictionary ("Title", "Subject", "Creator",
  /// "Keywords").
  void set_info(const std::string& key, const std::string& utf8) { info_.emplace_back(key, utf8); }
  int page_count() const { return static_cast<int>(pages_.size()); }
  std::string write() const;

 private:
  std::vector<PdfPage> pages_;
  std::vector<std::string> layers_;
  std::vector<std::pair<std::string, std::string>> info_;
};

/// Width of a text in Helvetica whose capitals are `size` high, mm.
double helvetica_width(const std::string& utf8, double size);

}  // namespace sheetform
