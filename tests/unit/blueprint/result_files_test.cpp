// ruled.obj, layout.json and layout.svg: written, read back, compared.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <regex>
#include <set>

#include "sheetform/blueprint/page_layout.h"
#include "sheetform/blueprint/result_reader.h"
#include "sheetform/blueprint/result_writer.h"
#include "sheetform/blueprint/text.h"
#include "sheetform/decompose.h"
#include "sheetform/strip/outline.h"
#include "support/shapes.h"
#include "support/strip_shapes.h"

namespace sheetform {
namespace {

using ::testing::HasSubstr;

Decomposition result_of(StripMesh strips, double scale = 25) {
  Decomposition d;
  d.strips = std::move(strips);
  d.params.scale = scale;
  const TriangleSoup soup = shapes::soup_of(d.strips);
  d.bbox_diagonal = bounding_box_diagonal(soup.points);
  d.input_vertices = static_cast<int>(soup.points.size()),
  d.input_faces = static_cast<int>(soup.faces.size());
  d.report.patches = static_cast<int>(d.strips.patches.size());
  d.report.e_max_met = true;
  d.report.notes = {"a note with \"quotes\", <b>tags</b> & broken \xff UTF-8"};
  return d;
}

const std::string& content(const std::vector<Artifact>& files, const std::string& name) {
  for (const Artifact& a : files)
    if (a.name == name) return a.content;
  throw std::runtime_error("no " + name);
}

std::vector<StripMesh> shapes_to_write() {
  return {shapes::cube_faces(), shapes::tube(24), shapes::cone(24), shapes::two_leaves(60, 0.4, 12),
          shapes::torus_pieces(12, 4, 15)};
}

TEST(ResultFiles, ReadBackTheSameResult) {
  for (const StripMesh& strips : shapes_to_write()) {
    const Decomposition d = result_of(strips);
    const auto files = write_artifacts(d);
    const StoredResult back = read_result(content(files, "ruled.obj"), content(files, "layout.json"));
    EXPECT_EQ(back.strips.points, strips.points);
    EXPECT_EQ(back.scale, 25);
    EXPECT_EQ(back.bbox_diagonal, d.bbox_diagonal);
    EXPECT_EQ(back.labels, part_labels(strips));
    EXPECT_EQ(back.e_max, 0.02);
    ASSERT_EQ(back.strips.patches.size(), strips.patches.size());
    for (std::size_t p = 0; p < strips.patches.size(); ++p) {
      const StripMesh::Patch &a = back.strips.patches[p], &b = strips.patches[p];
      EXPECT_EQ(a.boundary, b.boundary);
      EXPECT_EQ(a.boundary_vt, b.boundary_vt);
      EXPECT_EQ(a.corners, b.corners);
      EXPECT_EQ(a.arches, b.arches);
      EXPECT_EQ(a.rulings, b.rulings);
      ASSERT_EQ(a.triangles.size(), b.triangles.size());
      for (std::size_t i = 0; i < a.triangles.size(); ++i) EXPECT_EQ(a.triangles[i].v, b.triangles[i].v);
    }
    ASSERT_EQ(back.strips.arches.size(), strips.arches.size());
    for (std::size_t a = 0; a < strips.arches.size(); ++a) {
      EXPECT_EQ(back.strips.arches[a].vertices, strips.arches[a].vertices);
      EXPECT_EQ(back.strips.arches[a].patches, strips.arches[a].patches);
    }
    double isometry = 1;
    EXPECT_TRUE(check_structure(back.strips, nullptr, 6, d.bbox_diagonal, &isometry).empty());
    EXPECT_LT(isometry, 1e-12);  // turned and moved on the page, and still as long
  }
}

TEST(ResultFiles, AreTheSameBytesAgain) {
  const Decomposition d = result_of(shapes::torus_pieces(12, 4, 15));
  const auto a = write_artifacts(d), b = write_artifacts(d);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].content, b[i].content);
}

TEST(ResultFiles, PartsLieApartInTheLayout) {
  for (const StripMesh& strips : shapes_to_write()) {
    const auto files = write_artifacts(result_of(strips));
    const StoredResult back = read_result(content(files, "ruled.obj"), content(files, "layout.json"));
    std::vector<Polygon> parts;
    for (const StripMesh::Patch& patch : back.strips.patches) {
      parts.emplace_back();
      for (int t : patch.boundary_vt) parts.back().push_back(back.scale * back.strips.uvs[t]);
      EXPECT_GT(signed_area(parts.back()), 0);  // turned, never mirrored
    }
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_FALSE(contains(parts[i], parts[j][0]) || contains(parts[j], parts[i][0]));
        for (std::size_t k = 0; k < parts[i].size(); k += 3)
          for (std::size_t l = 0; l < parts[j].size(); l += 3)
            EXPECT_GT(segment_distance(parts[i][k], parts[i][(k + 1) % parts[i].size()], parts[j][l],
                                       parts[j][(l + 1) % parts[j].size()]),
                      1.0);
      }
  }
}

TEST(ResultFiles, SvgIsTrueToScaleAndCarriesEachPartOnce) {
  const Decomposition d = result_of(shapes::torus_pieces(12, 4, 15));
  const auto files = write_artifacts(d);
  const std::string& svg = content(files, "layout.svg");
  std::smatch page;
  ASSERT_TRUE(std::regex_search(
      svg, page,
      std::regex("width=\"([0-9.]+)mm\" height=\"([0-9.]+)mm\" viewBox=\"0 0 ([0-9.]+) ([0-9.]+)\"")));
  EXPECT_EQ(page[1], page[3]);
  EXPECT_EQ(page[2], page[4]);
  std::set<std::string> ids;
  int cuts = 0, rulings = 0;
  for (std::size_t at = svg.find('<'); at != std::string::npos; at = svg.find('<', at + 1)) {
    const std::string tag = svg.substr(at, svg.find('>', at) - at);
    if (tag.rfind("<g id=\"part-", 0) == 0) ids.insert(tag);
    rulings += tag.find("class=\"ruling\"") != std::string::npos;
    if (tag.find("class=\"cut\"") == std::string::npos) continue;
    ++cuts;
    const std::string data = tag.substr(tag.find(" d=\""));
    EXPECT_EQ(std::count(data.begin(), data.end(), 'M'), 1);
    EXPECT_EQ(std::count(data.begin(), data.end(), 'Z'), 1);
  }
  EXPECT_EQ(ids.size(), 48u);
  EXPECT_EQ(cuts, 48);
  EXPECT_EQ(rulings, 48 * 14);
}

TEST(ResultFiles, LabelsAreUniqueAndTellComponentsApart) {
  StripMesh strips = shapes::torus_pieces(12, 4, 15);
  for (std::size_t p = 0; p < strips.patches.size(); ++p)
    strips.patches[p].component = static_cast<int>(p) / 16 * 26;
  const std::vector<std::string> labels = part_labels(strips);
  EXPECT_EQ(labels.front(), "A1");
  EXPECT_EQ(labels[16], "AA1");
  EXPECT_EQ(labels.back(), "BA16");
  EXPECT_EQ(std::set<std::string>(labels.begin(), labels.end()).size(), labels.size());
}

struct Spoilt {
  const char* name;
  const char* file;
  std::string from, to;  // the first place is replaced
  ErrorCode code = ErrorCode::kUnreadableMesh;
};
void PrintTo(const Spoilt& s, std::ostream* out) { *out << s.name; }

class SpoiltFile : public ::testing::TestWithParam<Spoilt> {};

TEST_P(SpoiltFile, IsRefusedWithItsPlace) {
  const auto files = write_artifacts(result_of(shapes::two_leaves(60, 0.4, 12)));
  std::string obj = content(files, "ruled.obj"), json = content(files, "layout.json");
  std::string& text = std::string(GetParam().file) == "ruled.obj" ? obj : json;
  const std::size_t at = text.find(GetParam().from);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, GetParam().from.size(), GetParam().to);
  try {
    read_result(obj, json);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), GetParam().code);
    EXPECT_THAT(e.where(), HasSubstr(GetParam().file));
  }
}

INSTANTIATE_TEST_SUITE_P(
    ResultFiles, SpoiltFile,
    ::testing::Values(
        Spoilt{"no_number", "ruled.obj", "v 0", "v zero"}, Spoilt{"nan", "ruled.obj", "v 0", "v nan"},
        Spoilt{"huge", "ruled.obj", "v 0", "v 1e99"}, Spoilt{"index_zero", "ruled.obj", "f 14/", "f 0/"},
        Spoilt{"index_far", "ruled.obj", "f 14/", "f 999999/"},
        Spoilt{"index_endless", "ruled.obj", "f 14/", "f 99999999999999999999/"},
        Spoilt{"no_vt", "ruled.obj", "f 14/1 ", "f 14 "},
        Spoilt{"foreign_group", "ruled.obj", "g patch_1", "g patch_7"},
        Spoilt{"face_without_group", "ruled.obj", "g patch_0", "# "},
        Spoilt{"not_json", "layout.json", "{", "["}, Spoilt{"truncated", "layout.json", "\"report\"", ""},
        Spoilt{"schema", "layout.json", "layout/1", "layout/9"},
        Spoilt{"scale_zero", "layout.json", "\"scale\": 25", "\"scale\": 0"},
        Spoilt{"scale_text", "layout.json", "\"scale\": 25", "\"scale\": \"25\""},
        Spoilt{"e_max", "layout.json", "\"e_max\":0.02", "\"e_max\":2"},
        Spoilt{"no_boundary", "layout.json", "\"boundary\"", "\"boundaries\""},
        Spoilt{"negative_index", "layout.json", "\"boundary\":[", "\"boundary\":[-1,"},
        Spoilt{"fraction_index", "layout.json", "\"boundary\":[", "\"boundary\":[1.5,"},
        Spoilt{"far_index", "layout.json", "\"boundary\":[", "\"boundary\":[1000000,"},
        Spoilt{"corner_far", "layout.json", "\"corners\":[", "\"corners\":[999,"},
        Spoilt{"ruling_triple", "layout.json", "\"rulings\":[[", "\"rulings\":[[1,"},
        Spoilt{"arch_unknown", "layout.json", "\"arches\":[", "\"arches\":[77,"},
        Spoilt{"id_twice", "layout.json", "\"id\":1", "\"id\":0"},
        Spoilt{"label_empty", "layout.json", "\"A1\"", "\"\""},
        Spoilt{"mirror_unknown", "layout.json", "\"mirror_of\":null", "\"mirror_of\":12"}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(ResultFiles, TooLargeIsRefusedBeforeReading) {
  try {
    read_result(std::string(100, 'v'), "{}", ResultLimits{99});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kLimitExceeded);
  }
}

TEST(ResultFiles, DeepNestingDoesNotOverflow) {
  const auto files = write_artifacts(result_of(shapes::cube_faces()));
  EXPECT_THROW(read_result(content(files, "ruled.obj"), std::string(2'000'000, '[')), Error);
}

TEST(PageLayout, TurnsTheSmallestRectangleFlat) {
  Polygon p{{0, 0}, {10, 0}, {10, 1}, {0, 1}};
  const double a = 0.7;
  for (Vector2& q : p)
    q = Vector2(std::cos(a) * q.x() - std::sin(a) * q.y(), std::sin(a) * q.x() + std::cos(a) * q.y());
  const Placement turn = flat_turn(p);
  Vector2 low(1e9, 1e9), high(-1e9, -1e9);
  for (const Vector2& q : p) low = low.cwiseMin(turn(q)), high = high.cwiseMax(turn(q));
  EXPECT_NEAR((high - low).x(), 10, 1e-12);
  EXPECT_NEAR((high - low).y(), 1, 1e-12);
}

TEST(Text, NumbersReadBackExactlyAndWithoutNoise) {
  for (double x : {0.1, 1.0 / 3, 1e-300, -123456789.123456789, 5e22}) EXPECT_EQ(std::stod(exact(x)), x);
  EXPECT_EQ(exact(-0.0), "0");
  EXPECT_EQ(rounded(-0.000001, 4), "0");
  EXPECT_EQ(rounded(1.50004, 4), "1.5");
  EXPECT_EQ(rounded(1e7, 3), "10000000");
  EXPECT_THROW(exact(std::nan("")), Error);
}

TEST(Text, IsEscapedForXml) {
  EXPECT_EQ(xml_escaped("<a b=\"c\">&'"), "&lt;a b=&quot;c&quot;&gt;&amp;&#39;");
  EXPECT_EQ(xml_escaped(std::string("a\0b\x1b", 4)),
            "a\xEF\xBF\xBD"
            "b\xEF\xBF\xBD");
  EXPECT_EQ(xml_escaped("\xC3\xA4\xF0\x9F\x8F\xA0"), "\xC3\xA4\xF0\x9F\x8F\xA0");
  EXPECT_EQ(xml_escaped("\xC0\x80 \xED\xA0\x80"),
            "\xEF\xBF\xBD\xEF\xBF\xBD \xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");
}

}  // namespace
}  // namespace sheetform
