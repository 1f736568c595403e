// A stored result read back from its files: what `verify` and every re-export start from.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

/// The content of ruled.obj and layout.json. Patches and arches are in the order of layout.json, whatever
/// their ids.
struct StoredResult {
  StripMesh strips;  ///< uvs in units of the uploaded mesh again; boundary_vt empty where `boundary` is wrong
  double scale = 1;  ///< millimetres for one unit of the uploaded mesh
  double bbox_diagonal = 0;  ///< of the input as claimed, units of the mesh
  int input_vertices = 0, input_faces = 0;
  double e_max = 0;  ///< fraction of the diagonal
  int max_sides = 6;
  std::vector<std::string> labels;  ///< one a patch
  std::vector<int> patch_ids, arch_ids;
  std::vector<int> sheets;
  std::string parameters;  ///< the object "parameters" as JSON text
  std::string report;      ///< the object "report" as JSON text
};

struct ResultLimits {
  std::size_t max_bytes = std::size_t{256} << 20;  ///< of each file
};

/// Reads any result that keeps to the contract, not only our own. Throws Error kUnreadableMesh (where: file
/// and line or field) when a file is malformed, an index is out of range or a number not finite,
/// kLimitExceeded when a file is larger than allowed. What it returns may still break the structural
/// promises: check_structure tells. Cost O(n log n).
StoredResult read_result(std::string_view ruled_obj, std::string_view layout_json,
                         const ResultLimits& limits = {});

}  // namespace sheetform
