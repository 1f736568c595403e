// One decomposition from bytes to files, and a look at a mesh without decomposing it. The only place where
// the facade of core meets the messages; the command line and the job's child process both go through it.
#pragma once
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
  std::string folder;  ///< named by the tolerance: "0.02"
  Outcome outcome;
};

struct SweepOutcome {
  std::vector<SweepStep> steps;   ///< in the order of the tolerances given
  std::vector<OutputFile> files;  ///< sweep.csv and sweep.json: parts and cut length against error
};

/// The same for several tolerances (fractions of the diagonal) in one run. Throws Error.
SweepOutcome run_sweep(std::string_view bytes, const std::string& name, const api::Json& parameters,
                       const std::vector<double>& e_max, RunContext& context);

}  // namespace sheetform::server
