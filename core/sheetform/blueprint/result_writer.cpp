#include "sheetform/blueprint/result_writer.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "sheetform/blueprint/layout_svg.h"
#include "sheetform/blueprint/page_layout.h"
#include "sheetform/blueprint/text.h"
#include "sheetform/decompose.h"
#include "sheetform/strip/patch_shape.h"

namespace sheetform {
namespace {

using Json = nlohmann::ordered_json;

Json triple(const Vector3& v) { return Json::array({v.x(), v.y(), v.z()}); }

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json finite_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

// All uvs in millimetres, each patch moved to its place on the page.
struct FlatLayout {
  std::vector<Vector2> vt;
  PageLayout page;
};

std::vector<Polygon> scaled_outlines(const StripMesh& strips, double scale) {
  std::vector<Polygon> outlines;
  for (const StripMesh::Patch& patch : strips.patches) {
    Polygon outline;
    for (int t : patch.boundary_vt) outline.push_back(scale * strips.uvs.at(t));
    if (outline.size() < 3) throw Error(ErrorCode::kInternal, "a patch without outline cannot be written");
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

// Room for a cutter between the parts: 4 mm, less where the whole model is small.
double page_gap(const std::vector<Polygon>& outlines) {
  double largest = 0;
  for (const Polygon& p : outlines)
    for (const Vector2& q : p) largest = std::max(largest, (q - p.front()).norm());
  return std::min(4.0, std::max(0.04 * largest, 1e-6));
}

FlatLayout lay_out(const StripMesh& strips, double scale) {
  FlatLayout flat;
  const std::vector<Polygon> outlines = scaled_outlines(strips, scale);
  flat.page = arrange_on_one_page(outlines, page_gap(outlines));
  for (const Vector2& uv : strips.uvs) flat.vt.push_back(scale * uv);
  std::vector<char> moved(strips.uvs.size(), 0);
  for (std::size_t p = 0; p < strips.patches.size(); ++p)
    for (const StripMesh::Triangle& t : strips.patches[p].triangles)
      for (int i : t.vt)
        if (!std::exchange(moved.at(i), 1)) flat.vt[i] = flat.page.placements[p](flat.vt[i]);
  return flat;
}

std::string write_obj(const StripMesh& strips, const FlatLayout& flat) {
  std::string out =
      "# sheetform: discretized ruled surfaces; v in units of the uploaded mesh, vt in millimetres\n";
  for (const Vector3& p : strips.points) {
    out += 'v';
    for (int k = 0; k < 3; ++k) out += ' ', append_exact(out, p[k]);
    out += '\n';
  }
  for (const Vector2& q : flat.vt) {
    out += "vt ";
    append_exact(out, q.x());
    out += ' ';
    append_exact(out, q.y());
    out += '\n';
  }
  for (std::size_t p = 0; p < strips.patches.size(); ++p) {
    out += "g patch_" + std::to_string(p) + '\n';
    for (const StripMesh::Triangle& t : strips.patches[p].triangles) {
      out += 'f';
      for (int k = 0; k < 3; ++k) out += ' ' + std::to_string(t.v[k] + 1) + '/' + std::to_string(t.vt[k] + 1);
      out += '\n';
    }
  }
  return out;
}

const char* name_of(SymmetryMode mode) {
  switch (mode) {
    case SymmetryMode::kAuto:
      return "auto";
    case SymmetryMode::kPlane:
      return "plane";
    case SymmetryMode::kOff:
      break;
  }
  return "off";
}

const char* name_of(Effort effort) {
  switch (effort) {
    case Effort::kDraft:
      return "draft";
    case Effort::kThorough:
      return "thorough";
    case Effort::kNormal:
      break;
  }
  return "normal";
}

Json parameters_of(const DecomposeParams& p) {
  return {{"e_max", p.e_max},
          {"e_max_mm", or_null(p.e_max_mm)},
          {"t_junctions", p.t_junctions},
          {"symmetry", name_of(p.symmetry)},
          {"plane", {{"normal", triple(p.plane.normal)}, {"offset", p.plane.offset}}},
          {"max_sides", p.max_sides},
          {"crease_angle", or_null(p.crease_angle)},
          {"self_seams", p.self_seams},
          {"normal_deviation", or_null(p.normal_deviation)},
          {"ruling_spacing_min", or_null(p.ruling_spacing_min)},
          {"ruling_spacing_max", or_null(p.ruling_spacing_max)},
          {"min_bend_radius", or_null(p.min_bend_radius)},
          {"effort", name_of(p.effort)},
          {"morph", p.morph == MorphKind::kFull ? "full" : "reduced"},
          {"scale", p.scale},
          {"target_size", or_null(p.target_size)},
          {"seed", p.seed},
          {"material", or_null(p.material)},
          {"up", or_null(p.up)}};
}

// The strokes as they were given, so that the run can be made again.
Json guides_of(const UserGuides& guides) {
  if (guides.empty()) return nullptr;
  Json seams = Json::array(), keep_out = Json::array();
  const auto list = [](const std::vector<Vector3>& points) {
    Json out = Json::array();
    for (const Vector3& p : points) out.push_back(triple(p));
    return out;
  };
  for (const SeamStroke& s : guides.seams)
    seams.push_back({{"points", list(s.points)}, {"closed", s.closed}});
  for (const BrushStroke& b : guides.keep_out)
    keep_out.push_back({{"points", list(b.points)}, {"radius", b.radius}});
  return {{"seams", std::move(seams)}, {"keep_out", std::move(keep_out)}};
}

Json plane_of(const Decomposition& d) {
  if (!d.mirror_plane) return nullptr;
  return {{"normal", triple(d.mirror_plane->normal)}, {"offset", d.mirror_plane->offset}};
}

Json audit_of(const MeshAudit& audit) {
  Json findings = Json::array();
  for (const AuditFinding& f : audit.findings) {
    Json places = Json::array();
    for (const Vector3& p : f.places) places.push_back(triple(p));
    findings.push_back(
        {{"kind", f.kind}, {"count", f.count}, {"text", f.text}, {"places", std::move(places)}});
  }
  return {{"vertices", audit.vertices},         {"faces", audit.faces}, {"components", audit.components},
          {"border_loops", audit.border_loops}, {"euler", audit.euler}, {"uniform", audit.uniform},
          {"findings", std::move(findings)}};
}

Json report_of(const Decomposition& d) {
  Json timings = Json::object(), defects = Json::array();
  for (const auto& [stage, seconds] : d.report.timings) timings[stage] = seconds;
  for (const Defect& x : d.certificate.defects)
    defects.push_back({{"check", x.check}, {"text", x.text}, {"patch", x.patch}, {"place", triple(x.place)}});
  const double unit = d.bbox_diagonal > 0 ? d.bbox_diagonal : 1;
  return {{"patches", d.report.patches},
          {"hausdorff", d.report.hausdorff},
          {"hausdorff_at_most", d.report.hausdorff_at_most},
          {"mean_distance", d.report.mean_distance},
          {"e_max_met", d.report.e_max_met},
          {"isometry_error", d.report.isometry_error},
          {"cut_length", d.report.cut_length},
          {"border_length", d.report.border_length},
          {"input_to_result", d.certificate.distance.input_to_result / unit},
          {"result_to_input", d.certificate.distance.result_to_input / unit},
          {"worst_place", triple(d.report.worst_place)},
          {"normal_mean_deg", d.report.normal_mean},
          {"normal_p95_deg", d.report.normal_deviation},
          {"normal_deviation_met", d.report.normal_deviation_met},
          {"normal_worst_place", triple(d.report.normal_worst_place)},
          {"bend_radius_mm", finite_or_null(d.report.bending.smallest)},
          {"bend_patch", d.report.bending.patch < 0 ? Json(nullptr) : Json(d.report.bending.patch)},
          {"bend_place", triple(d.report.bending.place)},
          {"bend_reach_mm", d.report.bending.reach},
          {"min_bend_radius_met", d.report.min_bend_radius_met},
          {"ruling_spacing_mm", {d.report.spacing.shortest, d.report.spacing.longest}},
          {"strict", d.certificate.strict()},
          {"defects", std::move(defects)},
          {"notes", d.report.notes},
          {"timings", std::move(timings)}};
}

Json patch_of(const Decomposition& d, int id, const std::string& label) {
  const StripMesh::Patch& patch = d.strips.patches[id];
  Json out = {{"id", id},
              {"label", label},
              {"boundary", patch.boundary},
              {"corners", patch.corners},
              {"arches", patch.arches},
              {"rulings", patch.rulings},
              {"sheet", 0},
              {"mirror_of", patch.mirror_of < 0 ? Json(nullptr) : Json(patch.mirror_of)},
              {"component", patch.component},
              {"area_mm2", d.params.scale * d.params.scale * patch_area(d.strips, patch)}};
  const std::vector<double>& errors = d.certificate.distance.patch_error;
  if (static_cast<std::size_t>(id) < errors.size() && d.bbox_diagonal > 0)
    out["error"] = errors[id] / d.bbox_diagonal;
  const std::vector<double>& tilt = d.certificate.normals.patch_quantile;
  if (static_cast<std::size_t>(id) < tilt.size()) out["normal_p95_deg"] = tilt[id];
  const std::vector<double>& radius = d.report.bending.patch_radius;
  if (static_cast<std::size_t>(id) < radius.size()) out["bend_radius_mm"] = finite_or_null(radius[id]);
  return out;
}

Json arch_of(const StripMesh::Arch& arch, int id) {
  const Json other = arch.patches[1] < 0 ? Json(nullptr) : Json(arch.patches[1]);
  return {{"id", id},
          {"vertices", arch.vertices},
          {"patches", Json::array({Json(arch.patches[0]), other})},
          {"crease", arch.crease},
          {"on_plane", arch.on_plane},
          {"drawn", arch.drawn}};
}

// Compact text of one value; texts of users with broken UTF-8 are mended, not refused.
std::string dump(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

// A list with one element a line: readable, and small enough for a diff.
std::string dump_lines(const std::vector<Json>& list) {
  std::string out = "[";
  for (std::size_t i = 0; i < list.size(); ++i) out += (i ? ",\n  " : "\n  ") + dump(list[i]);
  return out + "\n ]";
}

std::string write_json(const Decomposition& d, const std::vector<std::string>& labels,
                       const PageLayout& page) {
  std::vector<Json> patches, arches;
  for (std::size_t p = 0; p < d.strips.patches.size(); ++p)
    patches.push_back(patch_of(d, static_cast<int>(p), labels[p]));
  for (std::size_t a = 0; a < d.strips.arches.size(); ++a)
    arches.push_back(arch_of(d.strips.arches[a], static_cast<int>(a)));
  const Json input = {
      {"vertices", d.input_vertices}, {"faces", d.input_faces}, {"bbox_diagonal", d.bbox_diagonal}};
  const Json sheet = {{"width", page.width}, {"height", page.height}};
  std::string out = "{\n \"schema\": \"sheetform-layout/1\",\n \"scale\": " + exact(d.params.scale);
  out += ",\n \"input\": " + dump(input) + ",\n \"parameters\": " + dump(parameters_of(d.params));
  out += ",\n \"symmetry_plane\": " + dump(plane_of(d));
  out += ",\n \"guides\": " + dump(guides_of(d.guides));
  out += ",\n \"page_mm\": " + dump(sheet);
  out += ",\n \"patches\": " + dump_lines(patches) + ",\n \"arches\": " + dump_lines(arches);
  out += ",\n \"audit\": " + dump(audit_of(d.audit)) + ",\n \"report\": " + dump(report_of(d)) + "\n}\n";
  return out;
}

// "A" .. "Z", "AA", "AB", ...
std::string letters(int index) {
  std::string out;
  for (int i = index; i >= 0; i = i / 26 - 1) out.insert(out.begin(), static_cast<char>('A' + i % 26));
  return out;
}

LayoutDrawing drawing_of(const StripMesh& strips, const FlatLayout& flat,
                         const std::vector<std::string>& labels) {
  LayoutDrawing drawing{flat.page.width, flat.page.height, {}};
  for (std::size_t p = 0; p < strips.patches.size(); ++p) {
    const StripMesh::Patch& patch = strips.patches[p];
    DrawnPart part;
    part.patch = static_cast<int>(p), part.label = labels[p];
    for (int t : patch.boundary_vt) part.outline.push_back(flat.vt[t]);
    std::map<std::array<int, 2>, std::array<int, 2>>
        edges;  // by v, its vt; the last wins, as inner edges agree
    for (const StripMesh::Triangle& t : patch.triangles)
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        edges[{t.v[k], t.v[l]}] = {t.vt[k], t.vt[l]};
      }
    for (const auto& [a, b] : patch.rulings) {
      const auto it = edges.find({a, b});
      if (it == edges.end())
        throw Error(ErrorCode::kInternal, "a ruling is no edge of its patch", "patch " + std::to_string(p));
      part.rulings.push_back({flat.vt[it->second[0]], flat.vt[it->second[1]]});
    }
    drawing.parts.push_back(std::move(part));
  }
  return drawing;
}

}  // namespace

std::vector<std::string> part_labels(const StripMesh& strips) {
  std::map<int, int> count;
  std::vector<std::string> labels;
  for (const StripMesh::Patch& patch : strips.patches)
    labels.push_back(letters(std::max(0, patch.component)) +
                     std::to_string(++count[std::max(0, patch.component)]));
  return labels;
}

std::vector<Artifact> write_artifacts(const Decomposition& result) {
  const FlatLayout flat = lay_out(result.strips, result.params.scale);
  const std::vector<std::string> labels = part_labels(result.strips);
  return {{"ruled.obj", "model/obj", write_obj(result.strips, flat)},
          {"layout.json", "application/json", write_json(result, labels, flat.page)},
          {"layout.svg", "image/svg+xml", write_layout_svg(drawing_of(result.strips, flat, labels))}};
}

}  // namespace sheetform
