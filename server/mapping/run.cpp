#include "server/mapping/run.h"

#include <malloc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "server/base/input_bundle.h"
#include "server/mapping/field_file.h"
#include "server/mapping/guides_file.h"
#include "server/mapping/parameters.h"
#include "sheetform/blueprint/result_writer.h"
#include "sheetform/decompose.h"
#include "sheetform/guided.h"
#include "sheetform/mesh/mesh_io.h"
#include "sheetform/sweep.h"

namespace sheetform::server {
namespace {

// A run frees and takes the same memory again and again. Given back to the system in between, it would have
// to be cleared each time: 1.5 % of the time of small meshes. The process ends soon after the run.
void keep_memory() {
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  mallopt(M_TOP_PAD, 16 << 20);
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
}

MeshFile read_nonempty_mesh(std::string_view bytes, const std::string& name) {
  ReadLimits limits;
  limits.bytes = bytes.size();  // whoever took the bytes has decided that they may be so many
  MeshFile file = read_mesh(bytes, name, limits);
  if (file.soup.faces.empty())
    throw Error(ErrorCode::kUnsupportedMesh, "the mesh has no faces", {},
                "export the surface as triangles or polygons");
  return file;
}

std::optional<UserField> field_of(const InputBundle& input, const TriangleSoup& soup) {
  if (input.field.empty()) return std::nullopt;
  return read_field(input.field, soup.points.size(), soup.faces.size());
}

std::optional<UserGuides> guides_of(const InputBundle& input) {
  if (input.guides.empty()) return std::nullopt;
  return read_guides(input.guides);
}

double millimetres_per_unit(const DecomposeParams& params, const Vector3& size) {
  const double longest = size.maxCoeff();
  return params.target_size && longest > 0 ? *params.target_size / longest : params.scale;
}

api::Json place_of(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

api::Json report_of(const Decomposition& d) {
  const Report& r = d.report;
  return {{"patches", r.patches},
          {"hausdorff", r.hausdorff},
          {"hausdorff_at_most", r.hausdorff_at_most},
          {"mean_distance", r.mean_distance},
          {"cut_length", r.cut_length},
          {"border_length", r.border_length},
          {"e_max", d.params.e_max},
          {"e_max_met", r.e_max_met},
          {"isometry_error", r.isometry_error},
          {"worst_place", place_of(r.worst_place)},
          {"normal_mean_deg", r.normal_mean},
          {"normal_p95_deg", r.normal_deviation},
          {"normal_deviation_met", r.normal_deviation_met},
          {"normal_worst_place", place_of(r.normal_worst_place)},
          {"bend_radius_mm", std::isfinite(r.bending.smallest) ? api::Json(r.bending.smallest) : api::Json()},
          {"bend_place", place_of(r.bending.place)},
          {"bend_reach_mm", r.bending.reach},
          {"min_bend_radius_met", r.min_bend_radius_met},
          {"ruling_spacing_mm", {r.spacing.shortest, r.spacing.longest}},
          {"timings", r.timings},
          {"notes", r.notes}};
}

/// A result that fails its own certificate must not leave the program.
void require_certificate(const Decomposition& d) {
  if (d.certificate.strict()) return;
  const Defect& first = d.certificate.defects.front();
  throw Error(ErrorCode::kInternal, "the result failed its own check " + first.check + ": " + first.text,
              first.patch >= 0 ? "patch " + std::to_string(first.patch) : std::string(),
              "please report this mesh; other parameters may avoid it");
}

std::vector<OutputFile> files_of(const Decomposition& d) {
  std::vector<OutputFile> files;
  for (Artifact& a : write_artifacts(d))
    files.push_back({std::move(a.name), std::move(a.media_type), std::move(a.content)});
  return files;
}

struct ReadInput {
  InputMesh mesh;
  std::optional<UserField> field;
  std::optional<UserGuides> guides;
  std::vector<std::string> notes;
  const UserField* field_or_null() const { return field ? &*field : nullptr; }
  const UserGuides* guides_or_null() const { return guides ? &*guides : nullptr; }
};

ReadInput input_of(std::string_view bytes, const std::string& name, const DecomposeParams& params,
                   RunContext& context) {
  keep_memory();
  context.seed = params.seed;
  context.report(Stage::kRead, 0);
  const InputBundle bundle = split_bundle(bytes);
  MeshFile file = read_nonempty_mesh(bundle.mesh, name);
  std::optional<UserField> field = field_of(bundle, file.soup);
  std::optional<UserGuides> guides = guides_of(bundle);
  context.report(Stage::kRead, 1);
  return {
      {std::move(file.soup), file.format, name}, std::move(field), std::move(guides), std::move(file.notes)};
}

Outcome outcome_of(const Decomposition& d, const std::vector<std::string>& notes) {
  require_certificate(d);
  Outcome outcome{files_of(d), report_of(d), notes};
  outcome.notes.insert(outcome.notes.end(), d.report.notes.begin(), d.report.notes.end());
  return outcome;
}

/// The curve of a sweep as a table and as JSON.
std::vector<OutputFile> files_of(const SweepOutcome& sweep) {
  constexpr std::array<const char*, 7> kColumns{"e_max",     "patches",       "cut_length", "border_length",
                                                "hausdorff", "mean_distance", "e_max_met"};
  std::string csv = "point";
  for (const char* column : kColumns) csv += std::string(",") + column;
  csv += "\r\n";
  api::Json curve = api::Json::array();
  for (const api::Json& report : sweep.curve) {
    api::Json point{{"point", report.at("point")}};
    csv += report.at("point").get<std::string>();
    for (const char* column : kColumns) {
      point[column] = report.at(column);
      csv += "," + point[column].dump();
    }
    csv += "\r\n";
    curve.push_back(std::move(point));
  }
  api::Json json{{"schema", "sheetform-sweep/1"}, {"curve", std::move(curve)}};
  if (!sweep.missing.empty()) json["missing"] = sweep.missing;
  return {{"sweep.csv", "text/csv", csv}, {"sweep.json", "application/json", json.dump(1) + "\n"}};
}

SweepStep step_of(const Decomposition& d, const std::vector<std::string>& notes) {
  return {api::number_text(d.params.e_max), outcome_of(d, notes)};
}

/// The report of a point, kept whole: it becomes that of a job when the point is opened.
api::Json curve_point(const SweepStep& step) {
  api::Json point = step.outcome.report;
  point["point"] = step.point;
  point["notes"] = step.outcome.notes;
  return point;
}

std::string ended_early(const SweepOutcome& outcome, std::size_t all) {
  const std::string done =
      std::to_string(outcome.curve.size()) + " of " + std::to_string(all) + " tolerances";
  if (outcome.stopped) return "stopped after " + done + "; run the missing ones again when they are wanted";
  return "time ran out after " + done + "; run the missing ones again, with less effort or a simpler mesh";
}

}  // namespace

MeshLimits mesh_limits() {
  const ReadLimits limits;
  return {limits.vertices, limits.faces};
}

api::MeshInfo inspect_mesh(std::string_view bytes, const std::string& name, const api::Json& parameters) {
  const InputBundle input = split_bundle(bytes);
  const MeshFile file = read_nonempty_mesh(input.mesh, name);
  (void)field_of(input, file.soup);
  const std::optional<UserGuides> guides = guides_of(input);
  if (guides) check_guides(*guides, file.soup);
  Vector3 low = file.soup.points.front(), high = low;
  for (const Vector3& p : file.soup.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  api::MeshInfo info;
  info.name = name;
  info.bytes = static_cast<std::int64_t>(input.mesh.size());
  info.format = file.format;
  info.vertices = static_cast<std::int64_t>(file.soup.points.size());
  info.faces = static_cast<std::int64_t>(file.soup.faces.size());
  for (int axis = 0; axis < 3; ++axis) {
    info.box_min[static_cast<std::size_t>(axis)] = low[axis];
    info.box_max[static_cast<std::size_t>(axis)] = high[axis];
  }
  info.scale = millimetres_per_unit(to_core(parameters), high - low);
  if (guides) {
    info.seams = static_cast<std::int64_t>(guides->seams.size());
    info.keep_out = static_cast<std::int64_t>(guides->keep_out.size());
  }
  return info;
}

Outcome run_decomposition(std::string_view bytes, const std::string& name, const api::Json& parameters,
                          RunContext& context) {
  const DecomposeParams params = to_core(parameters);
  const ReadInput input = input_of(bytes, name, params, context);
  const Decomposition result =
      decompose(input.mesh, params, input.field_or_null(), context, input.guides_or_null());
  context.report(Stage::kWrite, 0);
  Outcome outcome = outcome_of(result, input.notes);
  context.report(Stage::kWrite, 1);
  return outcome;
}

SweepOutcome run_sweep(std::string_view bytes, const std::string& name, const api::Json& parameters,
                       const std::vector<double>& e_max, RunContext& context,
                       const std::function<void(SweepStep)>& found, const std::atomic<bool>* enough) {
  const DecomposeParams params = to_core(parameters);
  const ReadInput input = input_of(bytes, name, params, context);
  SweepOutcome outcome;
  outcome.curve = api::Json::array();
  outcome.missing = e_max;
  std::sort(outcome.missing.begin(), outcome.missing.end());
  const auto take = [&](const Decomposition& d) {
    SweepStep step = step_of(d, input.notes);
    outcome.curve.push_back(curve_point(step));
    outcome.missing.erase(std::remove(outcome.missing.begin(), outcome.missing.end(), d.params.e_max),
                          outcome.missing.end());
    found(std::move(step));
  };
  try {
    sweep(input.mesh, params, e_max, input.field_or_null(), context, input.guides_or_null(), take);
  } catch (const Error& e) {
    const bool content = e.code() == ErrorCode::kCancelled && enough != nullptr && *enough;
    if (outcome.curve.empty() || !(content || e.code() == ErrorCode::kDeadlineExceeded)) throw;
    outcome.stopped = content && !outcome.missing.empty();
    if (!outcome.missing.empty()) outcome.notes.push_back(ended_early(outcome, e_max.size()));
  }
  outcome.files = files_of(outcome);
  return outcome;
}

}  // namespace sheetform::server
