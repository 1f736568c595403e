// Every format parsed back and compared with the blueprint.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>
#include <Eigen/LU>

#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/assembly.h"
#include "sheetform/blueprint/dxf.h"
#include "sheetform/blueprint/fold_file.h"
#include "sheetform/blueprint/pdf.h"
#include "sheetform/blueprint/pdf_file.h"
#include "sheetform/blueprint/result_writer.h"
#include "sheetform/blueprint/seam_frame.h"
#include "sheetform/blueprint/sheet_svg.h"
#include "sheetform/blueprint/zip.h"
#include "sheetform/strip/outline.h"
#include "support/shapes.h"
#include "support/strip_shapes.h"
#include "unit/blueprint/drawn_files.h"

namespace sheetform {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const char* const kEvil = "</text><script>alert(1)</script>\"'&\n0\nEOF\n)>>endobj \xff =cmd|'/c calc'!A1";

Blueprint blueprint_of(const StripMesh& strips, const BlueprintOptions& options = {}, double scale = 50,
                       const BlueprintOrigin& origin = {}) {
  return make_blueprint(strips, scale, part_labels(strips), options, origin);
}

BlueprintOrigin evil_origin() { return {kEvil, kEvil, kEvil, kEvil, kEvil, kEvil}; }

// --- SVG
// -----------------------------------------------------------------------------------------------------------

TEST(SheetSvg, HasOneClosedCutForEachPartAndKeepsItsShape) {
  BlueprintOptions o;
  o.sheet_width = 400, o.sheet_height = 300;
  const Blueprint b = blueprint_of(shapes::torus_pieces(12, 4, 15), o);
  std::map<std::string, int> cuts;
  for (std::size_t s = 0; s < b.sheets.size(); ++s) {
    const std::string svg = to_svg(b, static_cast<int>(s), profile_named("makerspace"));
    EXPECT_THAT(svg, HasSubstr("width=\"400mm\" height=\"300mm\" viewBox=\"0 0 400 300\""));
    for (const char* banned : {"<text", "<use", "<style", " style=", "transform=", "clip-path",
                               "stroke-dasharray", "display:none"})
      EXPECT_THAT(svg, Not(HasSubstr(banned)));
    for (const SvgPath& path : svg_paths(svg)) {
      for (const auto& line : path.lines)
        for (const Vector2& p : line) EXPECT_TRUE(p.x() >= 0 && p.y() >= 0 && p.x() <= 400 && p.y() <= 300);
      if (path.operation != "cut_outer") continue;
      ++cuts[path.part];
      EXPECT_TRUE(path.closed);
      ASSERT_EQ(path.lines.size(), 1u);
      const auto part = std::find_if(b.parts.begin(), b.parts.end(),
                                     [&](const BlueprintPart& p) { return p.label == path.part; });
      ASSERT_NE(part, b.parts.end());
      const Polygon& drawn = path.lines[0];
      ASSERT_EQ(drawn.size(), part->outline.size());
      EXPECT_LT(signed_area(drawn), 0);  // y runs down: turned over here, counter-clockwise on the material
      for (std::size_t i = 0; i < drawn.size(); ++i)
        for (std::size_t j : {(i + 1) % drawn.size(), (i + 7) % drawn.size()})
          EXPECT_NEAR((drawn[i] - drawn[j]).norm(), (part->outline[i] - part->outline[j]).norm(), 1e-3);
    }
  }
  EXPECT_EQ(cuts.size(), 48u);
  for (const auto& [part, count] : cuts) EXPECT_EQ(count, 1) << part;
}

TEST(SheetSvg, HasNoLineTwice) {
  BlueprintOptions o;
  o.tabs = TabSides::kOne;
  const Blueprint b = blueprint_of(shapes::torus_pieces(12, 4, 15), o);
  std::set<std::array<long long, 4>> seen;
  for (const SvgPath& path : svg_paths(to_svg(b, 0, profile_named("makerspace")))) {
    if (path.operation == "text" || path.operation == "notch") continue;
    for (const auto& line : path.lines)
      for (std::size_t i = 0; i + (path.closed ? 0 : 1) < line.size(); ++i) {
        Vector2 p = line[i], q = line[(i + 1) % line.size()];
        if (q.x() < p.x() || (q.x() == p.x() && q.y() < p.y())) std::swap(p, q);
        EXPECT_TRUE(seen.insert({std::llround(1e3 * p.x()), std::llround(1e3 * p.y()),
                                 std::llround(1e3 * q.x()), std::llround(1e3 * q.y())})
                        .second);
      }
  }
}

TEST(SheetSvg, LayersStandInTheOrderOfWork) {
  const Blueprint b = blueprint_of(shapes::tube(24));
  const std::string svg = to_svg(b, 0, profile_named("makerspace"));
  std::size_t last = 0;
  for (const char* layer : {"id=\"text\"", "id=\"notch\"", "id=\"score_mountain\"", "id=\"score_valley\"",
                            "id=\"cut_inner\"", "id=\"cut_outer\""}) {
    const std::size_t at = svg.find(layer);
    ASSERT_NE(at, std::string::npos) << layer;
    EXPECT_GT(at, last);
    last = at;
  }
}

TEST(SheetSvg, ProfilesDecideColoursWidthsAndWhatIsLeftOut) {
  const Blueprint b = blueprint_of(shapes::tube(24));
  const std::string ponoko = to_svg(b, 0, profile_named("ponoko"));
  EXPECT_THAT(ponoko, HasSubstr("stroke=\"#0000ff\" stroke-width=\"0.01\""));
  EXPECT_THAT(ponoko, Not(HasSubstr("id=\"guide\"")));
  const std::string origami = to_svg(b, 0, profile_named("origami"));
  EXPECT_THAT(origami, HasSubstr("opacity=\""));
  EXPECT_THAT(origami, Not(HasSubstr("id=\"text\"")));
  const std::string lightburn = to_svg(b, 0, profile_named("lightburn"));
  EXPECT_THAT(lightburn, HasSubstr("#f36926"));
}

TEST(SheetSvg, EvilTextsStayText) {
  StripMesh strips = shapes::cube_faces();
  std::vector<std::string> labels = part_labels(strips);
  labels[0] = kEvil;
  const Blueprint b = make_blueprint(strips, 50, labels, {}, evil_origin());
  const std::string svg = to_svg(b, 0, profile_named("makerspace"));
  EXPECT_THAT(svg, Not(HasSubstr("<script")));
  svg_paths(svg);  // still nests
}

// --- DXF
// -----------------------------------------------------------------------------------------------------------

class Dxf : public ::testing::TestWithParam<DxfVersion> {};
INSTANTIATE_TEST_SUITE_P(Versions, Dxf, ::testing::Values(DxfVersion::kR12, DxfVersion::kR2000));

TEST_P(Dxf, IsTheSheetInMillimetres) {
  const Blueprint b = blueprint_of(shapes::torus_pieces(12, 4, 15));
  const Profile& profile = profile_named("makerspace");
  const Groups groups = dxf_groups(to_dxf(b, 0, profile, GetParam()));
  EXPECT_EQ(groups.back().second, "EOF");
  bool units = false;
  std::set<std::string> layers;
  for (std::size_t i = 0; i + 1 < groups.size(); ++i) {
    if (groups[i].second == "$INSUNITS") units = groups[i + 1].second == "4";
    if (groups[i].second == "$ACADVER") {
      EXPECT_EQ(groups[i + 1].second, GetParam() == DxfVersion::kR12 ? "AC1009" : "AC1015");
    }
    if (groups[i].first == 0 && groups[i].second == "LAYER")
      for (std::size_t k = i + 1; groups[k].first != 0; ++k)
        if (groups[k].first == 2) layers.insert(groups[k].second);
  }
  EXPECT_TRUE(units);
  std::vector<DxfLine> cuts;
  for (const DxfLine& line : dxf_lines(groups)) {
    EXPECT_TRUE(layers.count(line.layer)) << line.layer;
    if (line.layer == "CUT") cuts.push_back(line);
  }
  ASSERT_EQ(cuts.size(), b.sheets[0].parts.size());
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const PlacedPart& p = b.sheets[0].parts[i];
    EXPECT_TRUE(cuts[i].closed);
    const Polygon wanted = placed(b.parts[p.part].outline, p.placement);
    ASSERT_EQ(cuts[i].points.size(), wanted.size());
    for (std::size_t k = 0; k < wanted.size(); ++k) EXPECT_LT((cuts[i].points[k] - wanted[k]).norm(), 2e-6);
  }
}

TEST_P(Dxf, HandlesAreUniqueAndEvilTextsStayOneLine) {
  const Blueprint b = blueprint_of(shapes::cube_faces(), {}, 50, evil_origin());
  const Groups groups = dxf_groups(to_dxf(b, 0, profile_named("inventor"), GetParam()));
  std::set<std::string> handles;
  int ends = 0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if ((groups[i].first == 5 || groups[i].first == 105) && groups[i - 1].second != "$HANDSEED") {
      EXPECT_TRUE(handles.insert(groups[i].second).second);
    }
    ends += groups[i].first == 0 && groups[i].second == "EOF";
  }
  EXPECT_EQ(ends, 1);
  EXPECT_EQ(handles.empty(), GetParam() == DxfVersion::kR12);
}

TEST(DxfPart, StandsAloneAtTheOrigin) {
  const Blueprint b = blueprint_of(shapes::torus_pieces(12, 4, 15));
  const auto lines = dxf_lines(dxf_groups(part_to_dxf(b, 5, profile_named("inventor"), DxfVersion::kR2000)));
  int outer = 0;
  for (const DxfLine& line : lines) {
    outer += line.layer == "IV_OUTER_PROFILE";
    for (const Vector2& p : line.points) EXPECT_GE(p.minCoeff(), -1e-6);
  }
  EXPECT_EQ(outer, 1);
}

// --- FOLD
// ----------------------------------------------------------------------------------------------------------

TEST(Fold, PatternAndFoldedFormAgree) {
  const Blueprint b = blueprint_of(shapes::two_leaves(60, 0.4, 12));
  const auto j = nlohmann::json::parse(to_fold(b));
  EXPECT_EQ(j["file_spec"], 1.2);
  EXPECT_EQ(j["frame_unit"], "mm");
  const auto &flat = j["vertices_coords"], &solid = j["file_frames"][0]["vertices_coords"],
             &edges = j["edges_vertices"];
  ASSERT_EQ(flat.size(), solid.size());
  const auto length = [](const nlohmann::json& p, const nlohmann::json& q) {
    double sum = 0;
    for (std::size_t k = 0; k < p.size(); ++k) sum += std::pow(p[k].get<double>() - q[k].get<double>(), 2);
    return std::sqrt(sum);
  };
  std::set<std::pair<int, int>> known;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const int p = edges[e][0], q = edges[e][1];
    EXPECT_TRUE(known.insert({std::min(p, q), std::max(p, q)}).second);
    EXPECT_NEAR(length(flat[p], flat[q]), length(solid[p], solid[q]), 1e-9);
    const std::string a = j["edges_assignment"][e];
    const double angle = j["edges_foldAngle"][e];
    EXPECT_TRUE((a == "M" && angle < 0) || (a == "V" && angle > 0) || ((a == "F" || a == "B") && angle == 0));
  }
  std::map<std::pair<int, int>, int> uses;
  for (const auto& f : j["faces_vertices"]) {
    double area = 0;
    for (int k = 0; k < 3; ++k) {
      const int p = f[k], q = f[(k + 1) % 3];
      ++uses[{std::min(p, q), std::max(p, q)}];
      area += flat[p][0].get<double>() * flat[q][1].get<double>() -
              flat[q][0].get<double>() * flat[p][1].get<double>();
    }
    EXPECT_GT(area, 0);
  }
  EXPECT_EQ(uses.size(), edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const int p = edges[e][0], q = edges[e][1];
    const int faces = uses.at({std::min(p, q), std::max(p, q)});
    EXPECT_EQ(faces, j["edges_assignment"][e] == "B" ? 1 : 2);
    EXPECT_EQ(j["edges_sheetform:kind"][e] == "seam", !j["edges_sheetform:seam"][e].is_null());
  }
}

TEST(Fold, OnePartAlone) {
  const Blueprint b = blueprint_of(shapes::torus_pieces(12, 4, 15));
  const auto j = nlohmann::json::parse(to_fold(b, 7));
  EXPECT_EQ(j["faces_vertices"].size(), 30u);
  EXPECT_EQ(j["faces_sheetform:part"][0], "A8");
}

// --- PDF
// -----------------------------------------------------------------------------------------------------------

// Offsets of the table point at their objects; gives the number of pages.
int check_pdf(const std::string& pdf) {
  EXPECT_EQ(pdf.rfind("%PDF-1.6", 0), 0u);
  const std::size_t start = std::stoul(pdf.substr(pdf.rfind("startxref") + 10));
  EXPECT_EQ(pdf.compare(start, 4, "xref"), 0);
  std::istringstream in(pdf.substr(start + 5));
  int first = 0, count = 0;
  in >> first >> count;
  std::string offset, generation, kind;
  for (int i = 0; i < count; ++i) {
    in >> offset >> generation >> kind;
    if (i == 0) continue;
    const std::string wanted = std::to_string(i) + " 0 obj";
    EXPECT_EQ(pdf.compare(std::stoul(offset), wanted.size(), wanted), 0);
  }
  const std::size_t pages = pdf.find("/Type /Pages ");
  return std::stoi(pdf.substr(pdf.find("/Count ", pages) + 7));
}

TEST(Pdf, HasAPageForEachSheetInItsSize) {
  BlueprintOptions o;
  o.sheet_width = 300, o.sheet_height = 200;
  const Blueprint b = blueprint_of(shapes::torus_pieces(12, 4, 15), o);
  PdfOptions p;
  p.cover = p.steps = false;
  const std::string pdf = to_pdf(b, profile_named("makerspace"), p);
  EXPECT_EQ(check_pdf(pdf), static_cast<int>(b.sheets.size()));
  EXPECT_THAT(pdf, HasSubstr("/MediaBox [0 0 850.3937 566.9291]"));  // 300 x 200 mm in points
  EXPECT_THAT(pdf, HasSubstr("/PrintScaling /None"));
  EXPECT_EQ(pdf, to_pdf(b, profile_named("makerspace"), p));
}

TEST(Pdf, TilesCoverTheSheetWithOverlap) {
  EXPECT_EQ(tiles_needed(190, 190, 10), 1);
  EXPECT_EQ(tiles_needed(190.1, 190, 10), 2);
  EXPECT_EQ(tiles_needed(370, 190, 10), 2);
  EXPECT_EQ(tiles_needed(371, 190, 10), 3);
  const Blueprint b = blueprint_of(shapes::tube(24));  // 314 x 100 mm and its frame
  PdfOptions p;
  p.page_width = 210, p.page_height = 297, p.cover = p.steps = false;
  EXPECT_EQ(check_pdf(to_pdf(b, profile_named("print"), p)), 2);
  p.page_width = 30;
  EXPECT_THROW(to_pdf(b, profile_named("print"), p), Error);
}

TEST(Pdf, StepsLookTheSameHoweverTheModelStands) {
  struct Turn {
    UpAxis up;
    Eigen::Matrix3d turn;  // of the model, so that what pointed along z points along `up`
  };
  const auto turn = [](UpAxis up, const Vector3& x, const Vector3& y, const Vector3& z) {
    Eigen::Matrix3d m;
    m << x, y, z;
    return Turn{up, m};
  };
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
  PdfOptions p;
  p.cover = false;
  const StripMesh upright = shapes::torus_pieces(12, 4, 15);
  const std::string wanted = to_pdf(blueprint_of(upright), profile_named("makerspace"), p);
  for (const Turn& t :
       {turn(UpAxis::kX, y, z, x), turn(UpAxis::kY, x, -z, y), turn(UpAxis::kMinusX, y, -z, -x),
        turn(UpAxis::kMinusY, x, z, -y), turn(UpAxis::kMinusZ, x, -y, -z)}) {
    EXPECT_EQ(t.turn.determinant(), 1);
    StripMesh turned = upright;
    for (Vector3& point : turned.points) point = t.turn * point;
    const Blueprint b = blueprint_of(turned);
    p.up = UpAxis::kZ;
    EXPECT_NE(to_pdf(b, profile_named("makerspace"), p), wanted);
    p.up = t.up;
    EXPECT_EQ(to_pdf(b, profile_named("makerspace"), p), wanted) << static_cast<int>(t.up);
  }
}

TEST(Pdf, EvilTextsStayText) {
  const Blueprint b = blueprint_of(shapes::cube_faces(), {}, 50, evil_origin());
  const std::string pdf = to_pdf(b, profile_named("print"), {});
  EXPECT_GT(check_pdf(pdf), 2);
  EXPECT_THAT(pdf, Not(HasSubstr("script")));
}

TEST(Pdf, HelveticaIsMeasured) {
  EXPECT_NEAR(helvetica_width("A", 718), 667, 1e-9);
  EXPECT_NEAR(helvetica_width("il", 718), 444, 1e-9);
}

// --- archives, STL, lists
// ------------------------------------------------------------------------------------------

std::uint32_t little(const std::string& s, std::size_t at, int bytes) {
  std::uint32_t v = 0;
  for (int i = 0; i < bytes; ++i)
    v |= static_cast<std::uint32_t>(static_cast<unsigned char>(s[at + static_cast<std::size_t>(i)]))
         << (8 * i);
  return v;
}

TEST(Zip, UnpacksToWhatWentIn) {
  const std::vector<ZipEntry> entries{
      {"a.txt", "hello hello hello"}, {"parts/b-1.dxf", std::string(100000, 'x')}, {"empty", ""}};
  const std::string zip = write_zip(entries);
  EXPECT_EQ(zip, write_zip(entries));
  std::size_t at = 0;
  for (const ZipEntry& e : entries) {
    ASSERT_EQ(little(zip, at, 4), 0x04034b50u);
    const std::uint32_t crc = little(zip, at + 14, 4), packed = little(zip, at + 18, 4),
                        size = little(zip, at + 22, 4), name = little(zip, at + 26, 2);
    EXPECT_EQ(zip.substr(at + 30, name), e.name);
    EXPECT_EQ(size, e.content.size());
    std::string out(size + 1, '\0'), in = zip.substr(at + 30 + name, packed);
    z_stream z{};
    ASSERT_EQ(inflateInit2(&z, -15), Z_OK);
    z.next_in = reinterpret_cast<Bytef*>(in.data()), z.avail_in = packed;
    z.next_out = reinterpret_cast<Bytef*>(out.data()), z.avail_out = size + 1;
    EXPECT_EQ(inflate(&z, Z_FINISH), Z_STREAM_END);
    inflateEnd(&z);
    out.resize(size);
    EXPECT_EQ(out, e.content);
    EXPECT_EQ(
        crc, crc32(0, reinterpret_cast<const Bytef*>(e.content.data()), static_cast<uInt>(e.content.size())));
    at += 30 + name + packed;
  }
  EXPECT_EQ(little(zip, at, 4), 0x02014b50u);
  EXPECT_EQ(little(zip, zip.size() - 22, 4), 0x06054b50u);
}

TEST(Zip, RefusesNamesThatCouldDoHarm) {
  for (const char* name : {"", "/etc/passwd", "../x", "a/../b", "a b", "x\n", "a\\b", "\xC3\xA4"})
    EXPECT_THROW(write_zip({{name, ""}}), Error) << name;
  EXPECT_THROW(write_zip({{"a", ""}, {"a", ""}}), Error);
  EXPECT_EQ(file_name_of("A1"), "A1");
  EXPECT_EQ(file_name_of("../A 1"), "___A_1");
  EXPECT_EQ(file_name_of(""), "_");
}

TEST(SeamFrame, IsClosedAndInMillimetres) {
  const Blueprint b = blueprint_of(shapes::torus_pieces(12, 4, 15));
  FrameOptions o;
  const std::string stl = to_seam_frame_stl(b, o);
  const std::uint32_t n = little(stl, 80, 4);
  ASSERT_EQ(stl.size(), 84u + 50u * n);
  std::map<std::array<std::string, 2>, int> edges;  // by the bytes of both ends; directed
  double volume = 0;
  Vector3 low = Vector3::Constant(1e9), high = -low;
  for (std::uint32_t i = 0; i < n; ++i) {
    std::array<std::string, 3> corner;
    std::array<Vector3, 3> p;
    for (int k = 0; k < 3; ++k) {
      corner[k] = stl.substr(84 + 50 * i + 12 + 12 * static_cast<std::size_t>(k), 12);
      for (int c = 0; c < 3; ++c) {
        float f = 0;
        std::memcpy(&f, corner[k].data() + 4 * c, 4);
        p[k][c] = f;
      }
      low = low.cwiseMin(p[k]), high = high.cwiseMax(p[k]);
    }
    for (int k = 0; k < 3; ++k) ++edges[{corner[k], corner[(k + 1) % 3]}];
    volume += p[0].dot(p[1].cross(p[2])) / 6;
  }
  for (const auto& [e, count] : edges) {
    const auto back = edges.find({e[1], e[0]});
    ASSERT_TRUE(back != edges.end() && back->second == count);
  }
  double rods = 0;
  for (const StripMesh::Arch& a : b.strips.arches)
    for (std::size_t i = 0; i + 1 < a.vertices.size(); ++i)
      rods += 50 * (b.strips.points[a.vertices[i]] - b.strips.points[a.vertices[i + 1]]).norm();
  EXPECT_GT(volume, 0.9 * rods * shapes::kPi * 1.5 * 1.5);  // the solids overlap at the nodes
  EXPECT_GT(high.x(), 50 * 1.4);
  EXPECT_LT(high.x(), 50 * 1.4 + 12);
}

TEST(PartList, NamesNeighboursAndIsSafeInASpreadsheet) {
  StripMesh strips = shapes::cube_faces();
  std::vector<std::string> labels = part_labels(strips);
  labels[0] = "=1+\"2\"";
  const Blueprint b = make_blueprint(strips, 50, labels, {}, evil_origin());
  const std::string csv = to_part_list_csv(b);
  EXPECT_THAT(csv, HasSubstr("\"'=1+\"\"2\"\"\","));
  const auto j = nlohmann::json::parse(to_part_list_json(b, profile_named("makerspace")));
  EXPECT_EQ(j["parts"].size(), 6u);
  for (const auto& part : j["parts"]) {
    EXPECT_EQ(part["neighbours"].size(), 4u);
    EXPECT_NEAR(part["width_mm"], 100, 1e-9);
  }
  EXPECT_EQ(j["seams"].size(), 12u);
  EXPECT_EQ(j["steps"].size(), 6u);
  EXPECT_NEAR(j["totals"]["cut_mm"], 2400, 1e-6);
}

// --- profiles
// ------------------------------------------------------------------------------------------------------

TEST(Profiles, OfTheOperatorBuildOnTheBuiltIn) {
  const auto own = read_profiles(
      R"({"profiles": [{"name": "ours", "like": "ponoko", "layers": {"cut_outer": {"layer": "CUT-1", "colour": "#12ab34", "width": 0.2,
    "dash": [2, 1]}, "text": {"drawn": false}}, "order": ["cut_outer", "cut_inner", "text", "notch", "score_mountain", "score_valley", "guide"],
    "minutes_per_metre_cut": 9}]})");
  ASSERT_EQ(own.size(), 1u);
  const Profile& p = profile_named("ours", own);
  EXPECT_EQ(p.of(Operation::kCutOuter).colour, "#12ab34");
  EXPECT_EQ(p.of(Operation::kCutOuter).dash.size(), 2u);
  EXPECT_FALSE(p.of(Operation::kText).drawn);
  EXPECT_EQ(p.of(Operation::kCutInner).colour, "#0000ff");
  EXPECT_EQ(p.order[0], static_cast<int>(Operation::kCutOuter));
  EXPECT_EQ(p.minutes_per_metre_cut, 9);
}

TEST(Profiles, MistakesAreRefused) {
  for (const char* text :
       {"", "[]", "{}", R"({"profiles": 1})", R"({"profiles": [{}]})",
        R"({"profiles": [{"name": "a", "like": "nobody"}]})",
        R"({"profiles": [{"name": "a", "layers": {"burn": {}}}]})",
        R"({"profiles": [{"name": "a", "layers": {"text": {"colour": "red"}}}]})",
        R"({"profiles": [{"name": "a", "layers": {"text": {"colour": "#000000\"/><script>"}}}]})",
        R"({"profiles": [{"name": "a", "layers": {"text": {"layer": "a b"}}}]})",
        R"({"profiles": [{"name": "a", "layers": {"text": {"dash": [1]}}}]})",
        R"({"profiles": [{"name": "a", "order": ["text"]}]})",
        R"({"profiles": [{"name": "a", "layers": {"text": {"width": -1}}}]})"})
    EXPECT_THROW(read_profiles(text), Error) << text;
  EXPECT_THROW(profile_named("nobody"), Error);
}

TEST(Profiles, BuiltInOnesAreComplete) {
  std::set<std::string> names;
  for (const Profile& p : built_in_profiles()) {
    EXPECT_TRUE(names.insert(p.name).second);
    EXPECT_FALSE(p.text.empty());
    for (const LayerStyle& s : p.layers) {
      EXPECT_TRUE(std::regex_match(s.colour, std::regex("#[0-9a-f]{6}")));
      EXPECT_TRUE(std::regex_match(s.layer, std::regex("[A-Za-z0-9_-]+")));
    }
    EXPECT_TRUE(p.of(Operation::kCutOuter).drawn);
  }
  for (const char* name : {"makerspace", "lightburn", "boxes", "ponoko", "silhouette", "inventor", "print"})
    EXPECT_TRUE(names.count(name));
}

TEST(Profiles, DashesAreRealSegments) {
  const auto dashes = dashed({{0, 0}, {10, 0}}, false, {2, 1});
  ASSERT_EQ(dashes.size(), 4u);
  for (const auto& d : dashes) EXPECT_LE((d.back() - d.front()).norm(), 2 + 1e-9);
  EXPECT_EQ(dashes[1].front(), Vector2(3, 0));
  const auto around = dashed({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, true, {15, 5});
  ASSERT_EQ(around.size(), 2u);
  EXPECT_EQ(around[0].size(), 3u);  // around a corner
  EXPECT_EQ(dashed({{0, 0}, {1, 0}}, true, {}).at(0).size(), 3u);
}

}  // namespace
}  // namespace sheetform
