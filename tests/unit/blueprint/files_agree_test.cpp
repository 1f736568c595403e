// What a workshop holds in its hands: every format read back and held against the geometry of the result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/dxf.h"
#include "sheetform/blueprint/fold_file.h"
#include "sheetform/blueprint/pdf.h"
#include "sheetform/blueprint/result_writer.h"
#include "sheetform/blueprint/sheet_svg.h"
#include "sheetform/strip/outline.h"
#include "support/strip_shapes.h"
#include "unit/blueprint/drawn_files.h"

namespace sheetform {
namespace {

using Segment = std::array<Vector2, 2>;
using Lines = std::vector<std::vector<Vector2>>;

Blueprint blueprint_of(const StripMesh& strips, const BlueprintOptions& options = {}, double scale = 50) {
  return make_blueprint(strips, scale, part_labels(strips), options);
}

std::vector<StripMesh> models() {
  return {shapes::cube_faces(), shapes::tube(24), shapes::cone(24), shapes::two_leaves(60, 0.4, 12),
          shapes::torus_pieces(8, 3, 12)};
}

/// Ways to draw the same result.
std::vector<BlueprintOptions> ways() {
  std::vector<BlueprintOptions> out(7);
  out[1].tabs = TabSides::kOne, out[1].kerf = 0.2;
  out[2].notches = NotchStyle::kVee, out[2].rulings = RulingStyle::kPerforation;
  out[3].marked_face = Face::kInside, out[3].rulings = RulingStyle::kTicks;
  out[4].ruling_step = 0, out[4].sheet_width = 400, out[4].sheet_height = 300;
  out[5].material = "plywood", out[5].thickness = 1, out[5].hinges = true, out[5].kerf = 0.15;
  out[6].tabs = TabSides::kAlternate, out[6].copies = 2, out[6].label_height = 20;
  return out;
}

std::vector<Segment> segments_of(const std::vector<Vector2>& points, bool closed) {
  std::vector<Segment> out;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < points.size(); ++i)
    out.push_back({points[i], points[(i + 1) % points.size()]});
  return out;
}

// Shorter by `by` at both ends; what is left of nothing is its middle.
Segment shortened(const Segment& s, double by) {
  const double length = (s[1] - s[0]).norm(), share = length > 2 * by ? by / length : 0.5;
  return {s[0] + share * (s[1] - s[0]), s[1] - share * (s[1] - s[0])};
}

// --- nothing on anything else

/// Strokes of one kind that may touch each other: a text, the notches or scores of a seam, one score.
struct Group {
  std::string name;
  std::vector<Segment> segments;
};

std::vector<Group> groups_of(const BlueprintPart& part) {
  std::map<std::string, std::vector<Segment>> by_name;
  int scores = 0;
  for (const BlueprintLine& line : part.lines) {
    std::string name = to_string(line.operation);
    const bool score =
        line.operation == Operation::kScoreMountain || line.operation == Operation::kScoreValley;
    if (line.operation == Operation::kCutOuter) continue;
    // The fold of a tab runs on the part's outline, where notches have their feet.
    if (score && line.seam > 0) continue;
    name += ' ' + std::to_string(line.seam);
    if (line.operation != Operation::kText) name += " #" + std::to_string(scores++);
    for (const Segment& s : segments_of(line.points, line.closed)) by_name[name].push_back(s);
  }
  std::vector<Group> out;
  for (auto& [name, segments] : by_name) out.push_back({name, std::move(segments)});
  return out;
}

TEST(Drawing, NothingLiesOnAnythingElse) {
  for (const StripMesh& strips : models())
    for (const BlueprintOptions& o : ways()) {
      const Blueprint b = blueprint_of(strips, o);
      for (const BlueprintPart& part : b.parts) {
        const std::vector<Group> groups = groups_of(part);
        for (std::size_t i = 0; i < groups.size(); ++i)
          for (std::size_t j = 0; j < i; ++j)
            for (const Segment& s : groups[i].segments)
              for (const Segment& t : groups[j].segments) {
                if ((s[0].cwiseMax(s[1]).array() < t[0].cwiseMin(t[1]).array()).any() ||
                    (t[0].cwiseMax(t[1]).array() < s[0].cwiseMin(s[1]).array()).any())
                  continue;
                ASSERT_GT(segment_distance(s[0], s[1], t[0], t[1]), 0)
                    << part.label << ": " << groups[i].name << " on " << groups[j].name;
              }
      }
    }
}

TEST(Drawing, NothingButNotchesMeetsACut) {
  for (const StripMesh& strips : models())
    for (const BlueprintOptions& o : ways()) {
      const Blueprint b = blueprint_of(strips, o);
      for (const BlueprintPart& part : b.parts) {
        std::vector<Segment> cuts;
        for (const BlueprintLine& line : part.lines)
          if (line.operation == Operation::kCutOuter) {
            EXPECT_TRUE(line.closed);
            EXPECT_LT(self_contact(line.points, 1e-9).i, 0) << part.label;
            for (const Segment& s : segments_of(line.points, true)) cuts.push_back(s);
          }
        for (const BlueprintLine& line : part.lines) {
          if (line.operation == Operation::kCutOuter) continue;
          const bool on_the_outline = line.seam > 0 && line.operation != Operation::kText;
          for (Segment s : segments_of(line.points, line.closed)) {
            if (on_the_outline) s = shortened(s, 0.05);
            if (on_the_outline && o.kerf == 0 && line.operation != Operation::kNotch) continue;
            for (const Segment& c : cuts) {
              if ((s[0].cwiseMax(s[1]).array() < c[0].cwiseMin(c[1]).array()).any() ||
                  (c[0].cwiseMax(c[1]).array() < s[0].cwiseMin(s[1]).array()).any())
                continue;
              ASSERT_GT(segment_distance(s[0], s[1], c[0], c[1]), 0)
                  << part.label << ": " << to_string(line.operation) << " of seam " << line.seam;
            }
          }
        }
      }
    }
}

// --- one geometry in all files

// All lines of an operation on a sheet as the blueprint means them.
std::vector<PdfLine> meant(const Blueprint& b, int sheet, Operation operation) {
  std::vector<PdfLine> out;
  for (const PlacedPart& p : b.sheets[sheet].parts)
    for (const BlueprintLine& line : b.parts[p.part].lines)
      if (line.operation == operation) out.push_back({placed(line.points, p.placement), line.closed});
  return out;
}

double length_of_all(const std::vector<PdfLine>& lines) {
  double sum = 0;
  for (const PdfLine& line : lines)
    for (const Segment& s : segments_of(line.points, line.closed)) sum += (s[1] - s[0]).norm();
  return sum;
}

TEST(Files, SvgDxfAndPdfHoldTheSameLines) {
  // A profile without two operations on one layer, so that each can be told apart in every file.
  const Profile profile = read_profiles(R"({"profiles": [{"name": "apart", "layers": {
      "text": {"layer": "L_text", "colour": "#000001"}, "notch": {"layer": "L_notch", "colour": "#000002"},
      "score_mountain": {"layer": "L_score_mountain", "colour": "#000003"},
      "score_valley": {"layer": "L_score_valley", "colour": "#000004"},
      "cut_inner": {"layer": "L_cut_inner", "colour": "#000005"},
      "cut_outer": {"layer": "L_cut_outer", "colour": "#000006"}}}]})")
                              .front();
  for (const StripMesh& strips : models())
    for (BlueprintOptions o : ways()) {
      o.reference_bar = false;
      const Blueprint b = blueprint_of(strips, o);
      PdfOptions pages;
      pages.cover = pages.steps = false;
      const std::vector<std::string> contents = pdf_contents(to_pdf(b, profile, pages));
      ASSERT_EQ(contents.size(), b.sheets.size());
      for (int s = 0; s < static_cast<int>(b.sheets.size()); ++s) {
        const std::vector<SvgPath> svg = svg_paths(to_svg(b, s, profile));
        const std::vector<DxfLine> r12 = dxf_lines(dxf_groups(to_dxf(b, s, profile, DxfVersion::kR12))),
                                   r2000 = dxf_lines(dxf_groups(to_dxf(b, s, profile, DxfVersion::kR2000)));
        std::vector<PdfLine> all;
        for (int i = 0; i < kOperations; ++i) {
          const auto operation = static_cast<Operation>(i);
          const std::vector<PdfLine> wanted = meant(b, s, operation);
          all.insert(all.end(), wanted.begin(), wanted.end());
          std::vector<PdfLine> from_svg, from_r12, from_r2000;
          for (const SvgPath& path : svg)
            if (path.operation == to_string(operation))
              for (std::vector<Vector2> line : path.lines) {
                for (Vector2& p : line) p.y() = b.sheets[s].height - p.y();
                from_svg.push_back({line, path.closed});
              }
          for (const auto& [lines, out] : {std::pair(&r12, &from_r12), {&r2000, &from_r2000}})
            for (const DxfLine& line : *lines)
              if (line.layer == "L_" + std::string(to_string(operation)))
                out->push_back({line.points, line.closed});
          ASSERT_EQ(from_svg.size(), wanted.size());
          for (const auto* read : {&from_r12, &from_r2000}) {
            ASSERT_EQ(read->size(), wanted.size()) << to_string(operation);
            for (std::size_t k = 0; k < wanted.size(); ++k) {
              EXPECT_EQ((*read)[k].closed, wanted[k].closed);
              ASSERT_EQ((*read)[k].points.size(), wanted[k].points.size());
              for (std::size_t q = 0; q < wanted[k].points.size(); ++q)
                EXPECT_LT(((*read)[k].points[q] - wanted[k].points[q]).norm(), 1e-5);
            }
          }
          // Texts and notches of a seam are one path in SVG, so only lengths are in order there.
          EXPECT_NEAR(length_of_all(from_svg), length_of_all(wanted),
                      1e-4 * static_cast<double>(10 + wanted.size()) * 10);
        }
        const std::vector<PdfLine> pdf = pdf_lines(contents[s]);
        ASSERT_EQ(pdf.size(), all.size());
        EXPECT_NEAR(length_of_all(pdf), length_of_all(all), 1e-3 * static_cast<double>(all.size() + 10));
        for (std::size_t k = 0; k < pdf.size(); ++k) {
          EXPECT_EQ(pdf[k].closed, all[k].closed);
          ASSERT_EQ(pdf[k].points.size(), all[k].points.size());
          for (std::size_t q = 0; q < all[k].points.size(); ++q)
            EXPECT_LT((pdf[k].points[q] - all[k].points[q]).norm(), 2e-4);
        }
      }
    }
}

// --- which edge goes where, from the sheet alone

double along(const std::vector<Vector2>& outline, const Vector2& point, double& distance) {
  double best = 1e300, at = 0, s = 0;
  for (const Segment& e : segments_of(outline, true)) {
    const Vector2 d = e[1] - e[0];
    const double n = d.squaredNorm(), t = n > 0 ? std::clamp((point - e[0]).dot(d) / n, 0.0, 1.0) : 0.0;
    const double here = (e[0] + t * d - point).norm();
    if (here < best) best = here, at = s + t * std::sqrt(n);
    s += std::sqrt(n);
  }
  distance = best;
  return at;
}

// The ticks of one seam on one part, as distances from the first along the outline, counter-clockwise on the
// material. The walk starts behind the largest gap.
std::vector<double> tick_gaps(const std::vector<Vector2>& outline, const Lines& ticks) {
  double total = 0;
  for (const Segment& e : segments_of(outline, true)) total += (e[1] - e[0]).norm();
  std::vector<double> at;
  for (const std::vector<Vector2>& tick : ticks) {
    double distance = 0;
    at.push_back(along(outline, tick.front(), distance));
    EXPECT_LT(distance, 2e-3) << "a notch starts off the edge";
  }
  std::sort(at.begin(), at.end());
  std::size_t first = 0;
  double widest = -1;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const double gap = i == 0 ? at[0] + total - at.back() : at[i] - at[i - 1];
    if (gap > widest) widest = gap, first = i;
  }
  std::vector<double> gaps;
  for (std::size_t k = 1; k < at.size(); ++k) {
    const double gap = at[(first + k) % at.size()] - at[(first + k - 1) % at.size()];
    gaps.push_back(gap < 0 ? gap + total : gap);
  }
  return gaps;
}

TEST(Files, NotchesOfASheetMatchInCodeAndPlace) {
  for (const StripMesh& strips :
       {shapes::cube_faces(), shapes::two_leaves(60, 0.4, 12), shapes::torus_pieces(8, 3, 12)})
    for (const Face face : {Face::kOutside, Face::kInside}) {
      BlueprintOptions o;
      o.marked_face = face;
      const Blueprint b = blueprint_of(strips, o);
      std::map<std::string, std::vector<Vector2>> outlines;
      std::map<std::string, std::map<std::string, Lines>> ticks;  // seam -> part -> ticks
      for (const SvgPath& path : svg_paths(to_svg(b, 0, profile_named("makerspace")))) {
        Lines lines = path.lines;
        for (std::vector<Vector2>& line : lines)
          for (Vector2& p : line) p.y() = b.sheets[0].height - p.y();
        if (path.operation == "cut_outer") outlines[path.part] = lines.at(0);
        if (path.operation == "notch") ticks[path.seam][path.part] = lines;
      }
      EXPECT_EQ(ticks.size(), b.seams.size());
      for (const auto& [seam, sides] : ticks) {
        ASSERT_EQ(sides.size(), 2u) << "seam " << seam;
        const auto& [first_part, first] = *sides.begin();
        const auto& [second_part, second] = *sides.rbegin();
        const std::vector<double> here = tick_gaps(outlines.at(first_part), first);
        std::vector<double> there = tick_gaps(outlines.at(second_part), second);
        // Joined, the outlines run against each other, whichever face is marked.
        std::reverse(there.begin(), there.end());
        ASSERT_EQ(here.size(), there.size()) << "seam " << seam;
        for (std::size_t i = 0; i < here.size(); ++i) EXPECT_NEAR(here[i], there[i], 0.01) << "seam " << seam;
        std::vector<double> turned = here;
        std::reverse(turned.begin(), turned.end());
        bool same = true;
        for (std::size_t i = 0; i < here.size(); ++i) same = same && std::abs(here[i] - turned[i]) < 0.5;
        EXPECT_FALSE(same) << "seam " << seam << " could be joined end for end";
      }
    }
}

// --- FOLD 1.2

bool all_in(const nlohmann::json& list, const std::set<std::string>& allowed) {
  return std::all_of(list.begin(), list.end(), [&](const auto& x) {
    return x.is_string() &&
           (allowed.count(x) || x.template get<std::string>().find(':') != std::string::npos);
  });
}

// The rules of the specification (edemaine/fold, doc/spec.md, version 1.2) for what a frame holds.
void check_frame(const nlohmann::json& frame) {
  const std::set<std::string> keys{
      "file_spec",        "file_creator",      "file_author",    "file_title",     "file_description",
      "file_classes",     "file_frames",       "frame_author",   "frame_title",    "frame_description",
      "frame_classes",    "frame_attributes",  "frame_unit",     "frame_parent",   "frame_inherit",
      "vertices_coords",  "vertices_vertices", "vertices_faces", "edges_vertices", "edges_faces",
      "edges_assignment", "edges_foldAngle",   "edges_length",   "faces_vertices", "faces_edges",
      "faceOrders",       "edgeOrders"};
  std::map<std::string, std::size_t> lengths;
  for (const auto& [key, value] : frame.items()) {
    EXPECT_TRUE(keys.count(key) || key.find(':') != std::string::npos) << key;
    for (const std::string prefix : {"vertices_", "edges_", "faces_"})
      if (key.rfind(prefix, 0) == 0) {
        ASSERT_TRUE(value.is_array()) << key;
        EXPECT_EQ(lengths.emplace(prefix, value.size()).first->second, value.size()) << key;
      }
  }
  EXPECT_TRUE(all_in(frame.at("frame_classes"), {"creasePattern", "foldedForm", "graph", "linkage"}));
  EXPECT_TRUE(all_in(frame.at("frame_attributes"),
                     {"2D", "3D", "abstract", "manifold", "nonManifold", "orientable", "nonOrientable",
                      "selfTouching", "nonSelfTouching", "selfIntersecting", "nonSelfIntersecting", "cuts",
                      "noCuts", "joins", "noJoins", "convexFaces", "nonConvexFaces"}));
  const std::set<std::string> units{"unit", "in", "pt", "m", "cm", "mm", "um", "nm"};
  EXPECT_TRUE(units.count(frame.at("frame_unit")));
}

// Vertices, edges and faces of a manifold crease pattern.
void check_mesh(const nlohmann::json& j) {
  const auto &coords = j.at("vertices_coords"), &edges = j.at("edges_vertices"),
             &faces = j.at("faces_vertices");
  std::map<std::pair<int, int>, std::size_t> edge_of;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    ASSERT_EQ(edges[e].size(), 2u);
    const int p = edges[e][0], q = edges[e][1];
    EXPECT_TRUE(p >= 0 && q >= 0 && p != q && std::max(p, q) < static_cast<int>(coords.size()));
    EXPECT_TRUE(edge_of.emplace(std::minmax(p, q), e).second) << "an edge twice";
  }
  std::map<std::pair<int, int>, int> directed;
  std::vector<int> uses(edges.size(), 0);
  std::set<int> used;
  for (const auto& face : faces) {
    ASSERT_GE(face.size(), 3u);
    double area = 0;
    for (std::size_t k = 0; k < face.size(); ++k) {
      const int p = face[k], q = face[(k + 1) % face.size()];
      const auto edge = edge_of.find(std::minmax(p, q));
      ASSERT_NE(edge, edge_of.end()) << "a side of a face that is no edge";
      ++uses[edge->second], used.insert(p);
      EXPECT_EQ(++directed[std::pair(p, q)], 1) << "faces that disagree on a side";
      area += coords[p][0].get<double>() * coords[q][1].get<double>() -
              coords[q][0].get<double>() * coords[p][1].get<double>();
    }
    EXPECT_GT(area, 0) << "a face that is not counter-clockwise";
  }
  EXPECT_EQ(used.size(), coords.size()) << "vertices of no face";
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::string a = j.at("edges_assignment")[e];
    const double angle = j.at("edges_foldAngle")[e];
    EXPECT_EQ(uses[e], a == "B" ? 1 : 2);
    EXPECT_TRUE((std::set<std::string>{"B", "M", "V", "F", "U", "C", "J"}.count(a)));
    EXPECT_TRUE(angle >= -180 && angle <= 180);
    EXPECT_TRUE(a == "V" ? angle > 0 : a == "M" ? angle < 0 : angle == 0) << a << ' ' << angle;
  }
}

void check_fold(const std::string& text) {
  const auto j = nlohmann::json::parse(text);
  EXPECT_EQ(j.at("file_spec"), 1.2);
  EXPECT_TRUE(all_in(j.at("file_classes"), {"singleModel", "multiModel", "animation", "diagrams"}));
  check_frame(j);
  check_mesh(j);
  for (const auto& p : j.at("vertices_coords")) EXPECT_EQ(p.size(), 2u);
  for (std::size_t i = 0; i < j.at("file_frames").size(); ++i) {
    nlohmann::json frame = j.at("file_frames")[i];
    EXPECT_TRUE(frame.at("frame_parent") >= 0 && frame.at("frame_parent") <= static_cast<int>(i));
    check_frame(frame);
    EXPECT_EQ(frame.at("vertices_coords").size(), j.at("vertices_coords").size());
    for (const auto& p : frame.at("vertices_coords")) EXPECT_EQ(p.size(), 3u);
  }
}

TEST(Files, FoldKeepsTheRulesOfItsSpecification) {
  for (const StripMesh& strips : models())
    for (const Face face : {Face::kOutside, Face::kInside}) {
      BlueprintOptions o;
      o.marked_face = face, o.copies = 2;
      const Blueprint b = blueprint_of(strips, o);
      check_fold(to_fold(b));
      check_fold(to_fold(b, static_cast<int>(b.parts.size()) - 1));
    }
}

TEST(Files, BothSidesOfASeamAreEquallyLongInFold) {
  for (const StripMesh& strips : models()) {
    const auto j = nlohmann::json::parse(to_fold(blueprint_of(strips)));
    const auto &edges = j["edges_vertices"], &faces = j["faces_vertices"], &flat = j["vertices_coords"],
               &solid = j["file_frames"][0]["vertices_coords"];
    std::map<int, std::string> part_of;
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (const auto& v : faces[f]) part_of[v] = j["faces_sheetform:part"][f];
    std::map<int, std::map<std::string, std::array<double, 2>>> lengths;  // seam -> part -> flat and folded
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (j["edges_sheetform:seam"][e].is_null()) continue;
      const int p = edges[e][0], q = edges[e][1];
      for (int which = 0; which < 2; ++which) {
        const auto& coords = which == 0 ? flat : solid;
        double sum = 0;
        for (std::size_t k = 0; k < coords[p].size(); ++k)
          sum += std::pow(coords[p][k].get<double>() - coords[q][k].get<double>(), 2);
        lengths[j["edges_sheetform:seam"][e]][part_of.at(p)][which] += std::sqrt(sum);
      }
    }
    EXPECT_FALSE(lengths.empty());
    for (const auto& [seam, sides] : lengths) {
      ASSERT_LE(sides.size(), 2u);
      for (const auto& [part, length] : sides) {
        EXPECT_NEAR(length[0], length[1], 0.01) << "seam " << seam << " on " << part;
        EXPECT_NEAR(length[0], sides.begin()->second[0], 0.01) << "seam " << seam;
      }
    }
  }
}

}  // namespace
}  // namespace sheetform
