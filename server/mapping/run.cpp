#include "server/mapping/run.h"

#include <algorithm>

#include "server/mapping/parameters.h"
#include "sheetform/blueprint/result_writer.h"
#include "sheetform/decompose.h"
#include "sheetform/mesh/mesh_io.h"

namespace sheetform::server {
namespace {

MeshFile read_nonempty_mesh(std::string_view bytes, const std::string& name) {
  MeshFile file = read_mesh(bytes, name);
  if (file.soup.faces.empty())
    throw Error(ErrorCode::kUnsupportedMesh, "the mesh has no faces", {},
                "export the surface as triangles or polygons");
  return file;
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
          {"mean_distance", r.mean_distance},
          {"cut_length", r.cut_length},
          {"border_length", r.border_length},
          {"e_max", d.params.e_max},
          {"e_max_met", r.e_max_met},
          {"isometry_error", r.isometry_error},
          {"worst_place", place_of(r.worst_place)},
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

}  // namespace

api::MeshInfo inspect_mesh(std::string_view bytes, const std::string& name, const api::Json& parameters) {
  const MeshFile file = read_nonempty_mesh(bytes, name);
  Vector3 low = file.soup.points.front(), high = low;
  for (const Vector3& p : file.soup.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  api::MeshInfo info;
  info.name = name;
  info.bytes = static_cast<std::int64_t>(bytes.size());
  info.format = file.format;
  info.vertices = static_cast<std::int64_t>(file.soup.points.size());
  info.faces = static_cast<std::int64_t>(file.soup.faces.size());
  for (int axis = 0; axis < 3; ++axis) {
    info.box_min[static_cast<std::size_t>(axis)] = low[axis];
    info.box_max[static_cast<std::size_t>(axis)] = high[axis];
  }
  info.scale = millimetres_per_unit(to_core(parameters), high - low);
  return info;
}

Outcome run_decomposition(std::string_view bytes, const std::string& name, const api::Json& parameters,
                          RunContext& context) {
  const DecomposeParams params = to_core(parameters);
  context.seed = params.seed;
  context.report(Stage::kRead, 0);
  MeshFile file = read_nonempty_mesh(bytes, name);
  const InputMesh input{std::move(file.soup), file.format, name};
  context.report(Stage::kRead, 1);
  const Decomposition result = decompose(input, params, nullptr, context);
  require_certificate(result);
  context.report(Stage::kWrite, 0);
  Outcome outcome{files_of(result), report_of(result), file.notes};
  outcome.notes.insert(outcome.notes.end(), result.report.notes.begin(), result.report.notes.end());
  context.report(Stage::kWrite, 1);
  return outcome;
}

}  // namespace sheetform::server
