#include "sheetform/blueprint/exports.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "sheetform/base/error.h"
#include "sheetform/decompose.h"
#include "support/shapes.h"
#include "support/strip_shapes.h"
#include "unit/blueprint/drawn_files.h"

namespace sheetform {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

struct Stored {
  std::string obj, json;
};

Stored stored(const StripMesh& strips, double scale = 50) {
  Decomposition d;
  d.strips = strips;
  d.params.scale = scale;
  d.bbox_diagonal = 1, d.input_vertices = d.input_faces = 1;
  const auto files = write_artifacts(d);
  return {files[0].content, files[1].content};
}

Artifact exported(const Stored& s, const std::string& format,
                  const std::map<std::string, std::string>& query = {}) {
  return export_result(s.obj, s.json, read_export_request(format, query),
                       {"1.0", "job-7", "model", "sha256:00", "https://example.org/jobs/7", ""});
}

TEST(Exports, EveryFormatGivesAFileWithItsType) {
  const Stored s = stored(shapes::torus_pieces(12, 4, 15));
  const std::vector<std::array<std::string, 4>> cases = {
      {"svg", "sheet-1.svg", "image/svg+xml", "<?xml"},
      {"dxf", "sheet-1.dxf", "image/vnd.dxf", "999"},
      {"pdf", "blueprint.pdf", "application/pdf", "%PDF"},
      {"fold", "blueprint.fold", "application/json", "{"},
      {"obj", "blueprint.obj", "model/obj", "#"},
      {"frame", "frame.stl", "model/stl", "sheetform"},
      {"parts-json", "parts.json", "application/json", "{"},
      {"parts-csv", "parts.csv", "text/csv", "label"},
      {"parts-dxf", "blueprint.zip", "application/zip", "PK"},
      {"parts-svg", "blueprint.zip", "application/zip", "PK"},
      {"zip", "blueprint.zip", "application/zip", "PK"}};
  for (const auto& [format, name, type, start] : cases) {
    const Artifact a = exported(s, format);
    EXPECT_EQ(a.name, name);
    EXPECT_EQ(a.media_type, type);
    EXPECT_THAT(a.content, StartsWith(start));
    EXPECT_EQ(a.content, exported(s, format).content);
  }
}

TEST(Exports, SheetsAndPartsCanBeAskedForAlone) {
  const Stored s = stored(shapes::torus_pieces(12, 4, 15));
  EXPECT_EQ(exported(s, "svg", {{"sheet_size", "300x200"}}).name, "blueprint.zip");
  EXPECT_EQ(exported(s, "svg", {{"sheet_size", "300x200"}, {"sheet", "2"}}).name, "sheet-2.svg");
  EXPECT_EQ(exported(s, "parts-dxf", {{"part", "A7"}}).name, "A7.dxf");
  EXPECT_THROW(exported(s, "svg", {{"sheet", "9"}}), Error);
  EXPECT_THROW(exported(s, "parts-dxf", {{"part", "Z9"}}), Error);
}

TEST(Exports, CarryWhereTheyComeFrom) {
  const Stored s = stored(shapes::cube_faces());
  for (const char* format : {"svg", "dxf", "fold", "obj", "parts-json"}) {
    std::string text = exported(s, format, {{"kerf", "0.15"}}).content;
    // As XML, JSON in JSON, lines of DXF, and JSON for people have it.
    for (const auto& [from, to] :
         {std::pair("&quot;", "\""), {"\\\"", "\""}, {"\r\n999\r\n", ""}, {"\": \"", "\":\""}})
      for (std::size_t at; (at = text.find(from)) != std::string::npos;)
        text.replace(at, std::string(from).size(), to);
    for (const char* part : {"job-7", "sha256:00", "https://example.org/jobs/7", "e_max", "sheetform 1.0",
                             "\"kerf\":\"0.15\"", "\"tab_pitch\":\"12\""})
      EXPECT_NE(text.find(part), std::string::npos) << format << ": " << part;
  }
}

TEST(Exports, QueriesAreReadOrRefusedByName) {
  const ExportRequest r = read_export_request("pdf", {{"kerf", "0.15"},
                                                      {"tabs", "alternate"},
                                                      {"face", "inside"},
                                                      {"page", "a4"},
                                                      {"cover", "off"},
                                                      {"copies", "3"},
                                                      {"sheet_size", "letter"},
                                                      {"rulings", "ticks"},
                                                      {"dxf", "r2000"},
                                                      {"frame_radius", "2"}});
  EXPECT_EQ(r.blueprint.kerf, 0.15);
  EXPECT_EQ(r.blueprint.tabs, TabSides::kAlternate);
  EXPECT_EQ(r.blueprint.marked_face, Face::kInside);
  EXPECT_EQ(r.pdf.page_height, 297);
  EXPECT_FALSE(r.pdf.cover);
  EXPECT_EQ(r.blueprint.copies, 3);
  EXPECT_NEAR(r.blueprint.sheet_width, 215.9, 1e-9);
  EXPECT_EQ(r.dxf, DxfVersion::kR2000);
  EXPECT_EQ(r.frame.radius, 2);
  const std::vector<std::array<std::string, 2>> bad = {
      {"kerf", "x"},         {"kerf", ""},          {"kerf", "1e999"},     {"kerf", "0.1mm"},
      {"kerf", "-1"},        {"tabs", "yes"},       {"copies", "1.5"},     {"copies", "0"},
      {"sheet_size", "5x5"}, {"sheet_size", "axb"}, {"page", "huge"},      {"dxf", "r14"},
      {"cover", "maybe"},    {"sheet", "0"},        {"page_margin", "-1"}, {"page_overlap", "1e6"},
      {"frame_radius", "0"}, {"frame_text", "-1"},  {"nonsense", "1"}};
  for (const auto& [name, value] : bad) {
    try {
      read_export_request("svg", {{name, value}});
      FAIL() << name << "=" << value;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
      EXPECT_FALSE(e.where().empty());
    }
  }
  EXPECT_THROW(read_export_request("exe", {}), Error);
}

TEST(Exports, DocumentedDefaultsAreTheDefaults) {
  std::set<std::string> names;
  for (const ExportParameter& p : export_parameters()) {
    EXPECT_TRUE(names.insert(p.name).second);
    EXPECT_FALSE(p.text.empty());
    for (const std::string& word : p.choices)
      EXPECT_NO_THROW(
          read_export_request("svg", {{p.name, word}, {"material", "plywood"}, {"thickness", "3"}}))
          << p.name << "=" << word;
    if (p.otherwise.empty()) continue;
    const ExportRequest given = read_export_request("svg", {{p.name, p.otherwise}}),
                        plain = read_export_request("svg", {});
    EXPECT_EQ(given.blueprint.kerf, plain.blueprint.kerf);
    EXPECT_EQ(given.blueprint.rulings, plain.blueprint.rulings);
    EXPECT_EQ(given.blueprint.sheet_width, plain.blueprint.sheet_width);
    EXPECT_EQ(given.blueprint.ruling_step, plain.blueprint.ruling_step);
    EXPECT_EQ(given.pdf.page_margin, plain.pdf.page_margin);
  }
}

TEST(Exports, ParametersSayAllThatAFormNeeds) {
  std::set<std::string> formats;
  for (const ExportFormatText& f : export_formats()) {
    EXPECT_TRUE(formats.insert(f.name).second);
    EXPECT_NO_THROW(read_export_request(f.name, {}));
    EXPECT_FALSE(f.text.empty());
  }
  for (const ExportParameter& p : export_parameters()) {
    for (const std::string& f : p.formats) EXPECT_TRUE(formats.count(f)) << p.name;
    EXPECT_THAT((std::set<std::string>{"sheet", "marks", "joints", "file"}), Contains(p.group)) << p.name;
    EXPECT_THAT((std::set<std::string>{"number", "integer", "choice", "switch", "size", "text"}),
                Contains(p.type))
        << p.name;
    EXPECT_EQ(p.choices.empty(),
              p.type == "number" || p.type == "text" || (p.type == "integer" && p.name != "sheet"))
        << p.name;
    if (!p.choices.empty()) {
      EXPECT_THAT(p.choices, Contains(p.otherwise)) << p.name;
    }
    EXPECT_EQ(p.low.has_value(), p.type == "number" || p.type == "integer") << p.name;
    EXPECT_EQ(p.high.has_value(), p.low.has_value());
    EXPECT_FALSE(p.text.empty());
  }
}

TEST(Exports, WhatIsAllowedIsTakenAndWhatIsNotIsRefused) {
  const auto refused = [](const std::string& name, const std::string& value) {
    try {
      read_export_request("svg", {{name, value}});
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
      EXPECT_EQ(e.where(), name) << value;
      return true;
    }
    return false;
  };
  // Some values want others beside them.
  const std::map<std::string, std::string> room{
      {"hinges", "on"}, {"material", "plywood"}, {"thickness", "2"}, {"sheet_size", "a0"}};
  for (const ExportParameter& p : export_parameters()) {
    for (const std::string& value : p.choices) {
      std::map<std::string, std::string> query =
          p.name == "hinges" || p.name == "margin" ? room : decltype(room){};
      query[p.name] = value;
      EXPECT_NO_THROW(read_export_request("svg", query)) << p.name << "=" << value;
    }
    if (p.type == "choice" && p.name != "profile") {
      EXPECT_TRUE(refused(p.name, "nonsense")) << p.name;
    }
    if (!p.low) continue;
    EXPECT_NO_THROW(read_export_request("svg", {{p.name, std::to_string(*p.low)}})) << p.name;
    EXPECT_NO_THROW(read_export_request("svg", {{p.name, std::to_string(*p.high)}})) << p.name;
    EXPECT_TRUE(refused(p.name, std::to_string(*p.low - 1))) << p.name;
    EXPECT_TRUE(refused(p.name, std::to_string(*p.high + 1))) << p.name;
  }
}

TEST(Exports, ModelSizeIsThatOfTheFinishedModel) {
  const Stored s = stored(shapes::cube_faces(), 3);  // sides of 2 units
  const auto totals =
      nlohmann::json::parse(exported(s, "parts-json", {{"model_size", "80"}}).content)["totals"];
  EXPECT_NEAR(totals["cut_mm"], 6 * 4 * 80, 1e-6);
  EXPECT_NEAR(totals["glue_mm"], 12 * 80, 1e-6);
}

// Of the files in an archive, from the headers that stand before each.
std::vector<std::string> names_in_zip(const std::string& zip) {
  const auto little = [&](std::size_t at, int bytes) {
    std::size_t v = 0;
    for (int i = bytes - 1; i >= 0; --i) v = v << 8 | static_cast<unsigned char>(zip.at(at + i));
    return v;
  };
  std::vector<std::string> out;
  for (std::size_t at = 0; little(at, 4) == 0x04034b50;) {
    out.push_back(zip.substr(at + 30, little(at + 26, 2)));
    at += 30 + out.back().size() + little(at + 18, 4);
  }
  return out;
}

// Everything that a stranger can name, as markup, as lines of DXF, as a formula, as broken UTF-8.
const char* const kEvil = "</text><script>alert(1)</script>\"'&\r\n  0\r\nEOF\r\n)>>endobj \xff ../../x";

TEST(Exports, EvilTextsStayTextInEveryFormat) {
  Stored s = stored(shapes::cube_faces());
  nlohmann::json layout = nlohmann::json::parse(s.json);
  layout["patches"][0]["label"] = "=cmd|'/c x'!A1<script>\r\n0\r\nEOF\r\n\"&";
  layout["patches"][1]["label"] = "../../etc/passwd";
  layout["parameters"]["e_max_note"] = "</metadata><script>\r\n  0\r\nEOF";
  s.json = layout.dump();
  for (const ExportFormatText& format : export_formats()) {
    const Artifact a = export_result(s.obj, s.json, read_export_request(format.name, {}),
                                     {kEvil, kEvil, kEvil, kEvil, kEvil, ""});
    const std::string& text = a.content;
    EXPECT_EQ(a.name.find_first_of("/\\<>"), std::string::npos);
    if (format.name == "svg") {
      EXPECT_THAT(text, Not(HasSubstr("<script")));
      EXPECT_FALSE(svg_paths(text).empty());
    } else if (format.name == "dxf") {
      const Groups groups = dxf_groups(text);
      EXPECT_EQ(std::count(groups.begin(), groups.end(), std::pair(0, std::string("EOF"))), 1);
      EXPECT_EQ(groups.back().second, "EOF");
    } else if (format.name == "pdf") {
      for (const char* bad : {"script", ")>>endobj", "/JavaScript", "/OpenAction"})
        EXPECT_THAT(text, Not(HasSubstr(bad)));
    } else if (format.media_type == "application/json") {
      EXPECT_NO_THROW(nlohmann::json::parse(text)) << format.name;
    } else if (format.name == "obj") {
      std::istringstream in(text);
      for (std::string line; std::getline(in, line);)
        EXPECT_THAT((std::set<std::string>{"#", "v", "vt", "g", "f"}),
                    Contains(line.substr(0, line.find(' '))));
    } else if (format.name == "parts-csv") {
      EXPECT_THAT(text, Not(HasSubstr("\"=cmd")));
      // Quotes that open and close; a line ends only outside of them.
      EXPECT_EQ(std::count(text.begin(), text.end(), '"') % 2, 0);
    } else if (format.name == "frame") {
      std::uint32_t triangles = 0;
      for (int k = 3; k >= 0; --k) triangles = triangles << 8 | static_cast<unsigned char>(text[80 + k]);
      EXPECT_EQ(text.size(), 84 + 50 * std::size_t{triangles});
      EXPECT_THAT(text.substr(0, 80), Not(HasSubstr("\n")));
    } else {
      EXPECT_EQ(a.media_type, "application/zip");
      for (const std::string& name : names_in_zip(text)) {
        EXPECT_EQ(name.find(".."), std::string::npos) << name;
        EXPECT_EQ(
            name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./"),
            std::string::npos)
            << name;
      }
    }
  }
}

TEST(Exports, OperatorsProfilesAreOffered) {
  const auto own = read_profiles(R"({"profiles": [{"name": "ours"}]})");
  for (const ExportParameter& p : export_parameters(own))
    if (p.name == "profile") {
      EXPECT_THAT(p.choices, Contains("ours"));
      EXPECT_THAT(p.choices, Contains("makerspace"));
      EXPECT_THAT(p.choices, Contains("lightburn"));
    }
}

TEST(Exports, ObjShowsEachPieceOfTheModelInItsPlaceOnTheSheet) {
  const Stored s = stored(shapes::torus_pieces(12, 4, 15));
  const std::string obj = exported(s, "obj", {{"sheet_size", "300x200"}}).content;
  std::vector<Vector3> points;
  std::vector<Vector2> uvs;
  std::set<std::string> groups;
  std::istringstream in(obj);
  std::string line;
  int faces = 0;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "v") words >> points.emplace_back().x() >> points.back().y() >> points.back().z();
    if (key == "vt") words >> uvs.emplace_back().x() >> uvs.back().y();
    if (key == "g") {
      EXPECT_TRUE(groups.insert(line).second);
    }
    if (key != "f") continue;
    ++faces;
    std::array<int, 3> v{}, vt{};
    char slash = 0;
    for (int k = 0; k < 3; ++k) words >> v[k] >> slash >> vt[k];
    for (int k = 0; k < 3; ++k) {
      const auto on_sheet = [&](int i) {
        const Vector2 q = uvs.at(vt[i] - 1);
        return Vector2(300 * q.x(), 200 * q.y());
      };
      const double solid = (points.at(v[k] - 1) - points.at(v[(k + 1) % 3] - 1)).norm();
      EXPECT_NEAR((on_sheet(k) - on_sheet((k + 1) % 3)).norm(), solid, 1e-6);
      EXPECT_EQ(std::floor(uvs.at(vt[k] - 1).x()), std::floor(uvs.at(vt[0] - 1).x()));  // on one sheet
    }
  }
  EXPECT_EQ(groups.size(), 48u);
  EXPECT_EQ(faces, 48 * 30);
}

}  // namespace
}  // namespace sheetform
