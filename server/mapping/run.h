// One decomposition from bytes to files, and a look at a mesh without decomposing it. The only place where
// the facade of core meets the messages; the command line and the job's child process both go through it.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/file_output.h"
#include "sheetform/base/run_context.h"
#include "sheetform_api/job.h"

namespace sheetform::server {

struct Outcome {
  std::vector<OutputFile> files;
  api::Json report;                ///< object: patches, hausdorff, e_max_met, ...
  std::vector<std::string> notes;  ///< for people
};

/// What a mesh may hold at most; of its bytes, whoever takes them decides.
struct MeshLimits {
  std::uint64_t vertices, faces;  ///< triangles, after polygons were split
};
MeshLimits mesh_limits();

/// Both take an input as it is stored (server/base/input_bundle.h): a mesh, and the field and strokes given
/// with it.
///
/// Reads the mesh and says what it is; reads field and strokes too. sha256 stays empty. parameters: complete.
/// Throws Error as read_mesh does, and kUnsupportedMesh for a mesh without faces.
api::MeshInfo inspect_mesh(std::string_view bytes, const std::string& name, const api::Json& parameters);

/// Reads, decomposes, writes. parameters: complete (understood_parameters). Throws Error.
Outcome run_decomposition(std::string_view bytes, const std::string& name, const api::Json& parameters,
                          RunContext& context);

struct SweepStep {
  std::string point;  ///< the tolerance as it is named: "0.02"
  Outcome outcome;
};

struct SweepOutcome {
  api::Json curve;              ///< the report of each point, named by `point`, by ascending tolerance
  std::vector<double> missing;  ///< tolerances that were not looked at
  bool stopped = false;         ///< whether they are missing because `enough` was set, not for lack of time
  std::vector<std::string> notes;  ///< for people, of the sweep as a whole
  std::vector<OutputFile> files;   ///< sweep.csv and sweep.json: parts and cut length against error
};

/// The same for several tolerances (fractions of the diagonal) in one run. Each point goes to `found` as soon
/// as it is certified, the finest first. When the context's deadline, or a cancellation while `enough` is
/// set, comes after the first of them, the outcome tells what is missing; before it, and for every other
/// reason, throws Error.
SweepOutcome run_sweep(std::string_view bytes, const std::string& name, const api::Json& parameters,
                       const std::vector<double>& e_max, RunContext& context,
                       const std::function<void(SweepStep)>& found,
                       const std::atomic<bool>* enough = nullptr);

}  // namespace sheetform::server
