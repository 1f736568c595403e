// What both benchmark programs do with their arguments: read meshes, run them, measure the machine.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "csv_table.h"
#include "sheetform/decompose.h"

namespace sheetform::bench {

struct Options {
  std::vector<double> e_max{0.02};
  DecomposeParams params;  ///< e_max apart
  int threads = 2;
  int repeat = 1;
  int coarse = 0;                  ///< faces to which files are remeshed first; 0: as they are
  int refine = 0;                  ///< how many finer copies of each file follow, with four times the faces
  std::filesystem::path csv;       ///< where the table goes; empty: nowhere
  std::filesystem::path against;   ///< an earlier table to compare with; empty: none
  std::vector<std::string> files;  ///< none: meshes of the program's own
};

/// Options that both programs know. Throws std::invalid_argument with a text for people.
///   --e-max 0.05,0.02  --threads n  --repeat n  --effort draft|normal|thorough  --t-junctions off
///   --self-seams off  --coarse FACES  --refine TIMES
///   --csv FILE  --against FILE
Options parse_options(int argc, char** argv);
extern const char* const kOptionsHelp;

/// Meshes of the program's own, for runs without files: shapes whose decomposition is known or much used.
std::vector<InputMesh> own_shapes();
/// Three shapes (a torus, a bumpy ball, a closed cylinder with its creases) with about 2 k, 8 k, 32 k, 128 k
/// and 512 k faces each: how cost grows.
std::vector<InputMesh> own_scaling();

/// Seconds of this thread for one sparse LDL' of the mesh's cotangent Laplacian with three right-hand sides,
/// best of seven, or of as many as two seconds hold: a measure of the machine, at the size of the mesh. Zero
/// faces or less than three points: 0.
double yardstick(const TriangleSoup& soup);

/// Processor seconds of the process.
double processor_seconds();
/// Forgets the peak, where the system can (Linux): the next peak is that of what comes.
void reset_peak_memory();
double peak_memory_mb();

using Row = void (*)(const InputMesh& input, const DecomposeParams& params, const Options& options,
                     CsvTable& table);
/// Runs `row` for every file, or without files for every mesh of `own`, at every tolerance, keeps the table
/// on disk after every row, compares in the end. A mesh that fails is named on the error stream and makes the
/// result 1.
int run_all(const Options& options, const std::vector<InputMesh>& own, Row row);

}  // namespace sheetform::bench
