// `sheetform verify MESH DIR`: the certificate of a stored result, recomputed from the files alone.
#include <cmath>
#include <cstdio>
#include <thread>

#include "server/base/file_output.h"
#include "server/cli/commands.h"
#include "server/mapping/errors.h"
#include "sheetform/blueprint/result_reader.h"
#include "sheetform/mesh/mesh_io.h"
#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/strip/certificate.h"

namespace sheetform::server {
namespace {

constexpr std::uint64_t kLargestFile = std::uint64_t{256} << 20;
constexpr int kSamples = 100'000;  // each way; the refinement finds what lies between them
constexpr std::size_t kShownDefects = 20;
constexpr double kRounding = 1e-4;  // of e_max: two ways to measure do not agree to the last digit

StoredResult read_stored(const std::filesystem::path& folder) {
  return read_result(read_input_file(folder / "ruled.obj", kLargestFile),
                     read_input_file(folder / "layout.json", kLargestFile));
}

/// What layout.json says of the mesh must be true of this mesh.
void check_input(const StoredResult& stored, const TriangleSoup& soup, double diagonal,
                 std::vector<Defect>& defects) {
  const auto claim = [&](const std::string& text) {
    defects.push_back({"input", text, -1, Vector3::Zero()});
  };
  if (stored.input_faces != static_cast<int>(soup.faces.size()))
    claim("layout.json speaks of " + std::to_string(stored.input_faces) + " faces, the mesh has " +
          std::to_string(soup.faces.size()));
  if (std::abs(stored.bbox_diagonal - diagonal) > 1e-6 * diagonal)
    claim("the bounding-box diagonal in layout.json is not that of the mesh");
}

void print_defects(const StoredResult& stored, const std::vector<Defect>& defects) {
  for (std::size_t i = 0; i < std::min(defects.size(), kShownDefects); ++i) {
    const Defect& d = defects[i];
    const auto patch = static_cast<std::size_t>(d.patch);
    const std::string part =
        d.patch >= 0 && patch < stored.labels.size() ? " (part " + stored.labels[patch] + ")" : "";
    std::printf("broken  %-6s %s%s\n", d.check.c_str(), d.text.c_str(), part.c_str());
  }
  if (defects.size() > kShownDefects)
    std::printf("broken  ... and %zu more\n", defects.size() - kShownDefects);
}

void print_measures(const StoredResult& stored, const Certificate& certificate, double diagonal, bool met) {
  const DistanceReport& d = certificate.distance;
  std::printf("parts               %zu\n", stored.strips.patches.size());
  std::printf(
      "largest distance    %.6g %% of the diagonal (mesh to sheets %.6g %%, sheets to mesh %.6g %%)\n",
      100 * d.hausdorff() / diagonal, 100 * d.input_to_result / diagonal, 100 * d.result_to_input / diagonal);
  std::printf("proven at most      %.6g %%\n", 100 * d.at_most / diagonal);
  std::printf("mean distance       %.6g %%\n", 100 * d.mean / diagonal);
  std::printf("tolerance           %.6g %%, %s\n", 100 * stored.e_max, met ? "met" : "NOT met");
  if (!met)
    std::printf("farthest at         %.6g %.6g %.6g\n", d.worst_place.x(), d.worst_place.y(),
                d.worst_place.z());
  std::printf("isometry error      %.3g\n", certificate.isometry_error);
}

}  // namespace

CommandSpec verify_spec() {
  CommandSpec spec;
  spec.name = "verify";
  spec.usage = "MESH DIR";
  spec.text =
      "Recomputes every promise of the result in the folder DIR from its files alone, and measures its "
      "distance "
      "to the mesh that it was made from.";
  spec.operands = {"MESH", "DIR"};
  spec.notes =
      "Exit status 0: every promise holds. 65: the result is broken (a line of each defect says where); a "
      "tolerance "
      "that is not met is told, but it is no defect.";
  return spec;
}

int verify_command(const ParsedLine& line) {
  const MeshFile mesh = read_mesh(read_input_file(line.operands[0], kLargestFile), line.operands[0]);
  const StoredResult stored = read_stored(line.operands[1]);
  RunContext context;
  context.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const RepairResult repaired = repair(mesh.soup, context);
  Certificate certificate =
      certify(mesh.soup, &repaired.mesh, stored.strips, stored.max_sides, kSamples, context);
  const double diagonal = bounding_box_diagonal(mesh.soup.points);
  check_input(stored, mesh.soup, diagonal, certificate.defects);
  const bool met = certificate.distance.hausdorff() <= stored.e_max * (1 + kRounding) * diagonal;
  print_defects(stored, certificate.defects);
  print_measures(stored, certificate, diagonal, met);
  std::printf("promises            %s\n", certificate.strict() ? "all hold" : "BROKEN");
  if (certificate.strict()) return kExitOk;
  throw Error(ErrorCode::kUnsupportedMesh,
              "the result breaks " + std::to_string(certificate.defects.size()) + " promises",
              line.operands[1], "decompose the mesh again, and report it if that gives the same");
}

}  // namespace sheetform::server
