// Readers of what we write, for tests: SVG, DXF and PDF back into lines. They accept no more than we write
// and say so where a file is anything else.
#pragma once
#include <gtest/gtest.h>
#include <zlib.h>

#include <sstream>
#include <string>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

// --- SVG

struct SvgPath {
  std::string operation, part, copy, seam, d;
  std::vector<std::vector<Vector2>> lines;
  bool closed = false;
};

inline std::string attribute(const std::string& tag, const std::string& name) {
  const std::size_t at = tag.find(' ' + name + "=\"");
  if (at == std::string::npos) return "";
  const std::size_t begin = at + name.size() + 3;
  return tag.substr(begin, tag.find('"', begin) - begin);
}

inline void read_path_data(SvgPath& p) {
  std::istringstream in(p.d);
  std::string word;
  while (in >> word) {
    if (word == "Z") {
      p.closed = true;
      continue;
    }
    if (word[0] == 'M') p.lines.emplace_back();
    double y = 0;
    in >> y;
    p.lines.back().emplace_back(std::stod(word.substr(1)), y);
  }
}

// Tags in order; checks on the way that they nest.
inline std::vector<SvgPath> svg_paths(const std::string& svg) {
  std::vector<SvgPath> out;
  std::vector<std::string> open, parts, operations, ids;
  for (std::size_t at = svg.find('<'); at != std::string::npos; at = svg.find('<', at + 1)) {
    const std::string tag = svg.substr(at + 1, svg.find('>', at) - at - 1);
    EXPECT_EQ(tag.find('<'), std::string::npos);
    if (tag[0] == '?') continue;
    const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
    if (tag[0] == '/') {
      EXPECT_FALSE(open.empty());
      EXPECT_EQ('/' + open.back(), tag);
      open.pop_back(), parts.pop_back(), operations.pop_back(), ids.pop_back();
      continue;
    }
    if (name == "path") {
      SvgPath p;
      p.operation = operations.back(), p.part = parts.back(), p.d = attribute(tag, "d");
      p.copy = ids.back(), p.seam = attribute(tag, "data-seam");
      read_path_data(p);
      out.push_back(std::move(p));
    }
    if (tag.back() == '/') continue;
    open.push_back(name);
    ids.push_back(attribute(tag, "id"));
    const std::string part = attribute(tag, "data-part"), operation = attribute(tag, "data-op");
    parts.push_back(part.empty() && !parts.empty() ? parts.back() : part);
    operations.push_back(operation.empty() && !operations.empty() ? operations.back() : operation);
  }
  EXPECT_TRUE(open.empty());
  return out;
}

// --- DXF

using Groups = std::vector<std::pair<int, std::string>>;

inline Groups dxf_groups(const std::string& dxf) {
  Groups out;
  std::istringstream in(dxf);
  std::string code, value;
  while (std::getline(in, code)) {
    EXPECT_TRUE(std::getline(in, value));
    EXPECT_EQ(code.back(), '\r');
    value.pop_back();
    EXPECT_LE(value.size(), 255u);
    out.emplace_back(std::stoi(code), value);
  }
  return out;
}

struct DxfLine {
  std::string layer;
  bool closed = false;
  std::vector<Vector2> points;
};

inline std::vector<DxfLine> dxf_lines(const Groups& groups) {
  std::vector<DxfLine> out;
  std::string entity;
  bool entities = false;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const auto& [code, value] = groups[i];
    if (code == 2 && groups[i - 1].second == "SECTION") entities = value == "ENTITIES";
    if (!entities) continue;
    if (code == 0) entity = value;
    if (code == 0 && (value == "POLYLINE" || value == "LWPOLYLINE")) out.emplace_back();
    if (code == 8 && entity != "SEQEND") out.back().layer = value;
    if (code == 70 && entity != "VERTEX") out.back().closed = value == "1";
    if (code == 10 && entity != "POLYLINE") out.back().points.emplace_back(std::stod(value), 0);
    if (code == 20 && entity != "POLYLINE") out.back().points.back().y() = std::stod(value);
  }
  return out;
}

// --- PDF

/// What is stroked on a page, millimetres from its lower left corner.
struct PdfLine {
  std::vector<Vector2> points;
  bool closed = false;
};

inline std::string inflated(const std::string& packed) {
  std::string out(packed.size() * 40 + 1000, '\0');
  uLongf size = out.size();
  while (true) {
    const int status = uncompress(reinterpret_cast<Bytef*>(out.data()), &size,
                                  reinterpret_cast<const Bytef*>(packed.data()), packed.size());
    if (status == Z_OK) break;
    EXPECT_EQ(status, Z_BUF_ERROR);
    if (status != Z_BUF_ERROR) return "";
    out.resize(2 * out.size()), size = out.size();
  }
  out.resize(size);
  return out;
}

/// The content of every page in order, unpacked; pictures are left out.
inline std::vector<std::string> pdf_contents(const std::string& pdf) {
  std::vector<std::string> out;
  for (std::size_t at = 0; (at = pdf.find("\nstream\n", at)) != std::string::npos; at += 8) {
    const std::size_t head = pdf.rfind("<<", at), length = pdf.find("/Length ", head);
    const std::string entries = pdf.substr(pdf.rfind("obj", at), at - pdf.rfind("obj", at));
    if (entries.find("/Image") != std::string::npos) continue;
    out.push_back(inflated(pdf.substr(at + 8, std::stoul(pdf.substr(length + 8)))));
  }
  return out;
}

inline std::vector<PdfLine> pdf_lines(const std::string& content) {
  std::vector<PdfLine> out;
  std::istringstream in(content);
  std::vector<double> numbers;
  double unit = 1;
  for (std::string word; in >> word;) {
    char* end = nullptr;
    const double x = std::strtod(word.c_str(), &end);
    if (end && *end == '\0') {
      numbers.push_back(x);
      continue;
    }
    if (word == "cm" && out.empty()) unit = numbers.at(0) * 25.4 / 72;
    if (word == "m") out.emplace_back();
    if (word == "m" || word == "l") out.back().points.push_back(unit * Vector2(numbers.at(0), numbers.at(1)));
    if (word == "s") out.back().closed = true;
    numbers.clear();
  }
  return out;
}

}  // namespace sheetform
