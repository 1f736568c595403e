// The files that a finished decomposition hands over: ruled.obj, layout.json, layout.svg (contract.md).
#pragma once
#include <string>
#include <vector>

#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

struct Decomposition;

struct Artifact {
  std::string name;  ///< file name, without folder
  std::string media_type;
  std::string content;  ///< bytes
};

/// ruled.obj (positions in units of the uploaded mesh, vt in millimetres, exact decimals), layout.json and
/// layout.svg. The parts are turned and placed side by side on one page; vt and the drawing show the same
/// places. Needs a well-formed result (boundary_vt filled, indices in range), else Error kInternal. Cost
/// O(size of the result).
std::vector<Artifact> write_artifacts(const Decomposition& result);

/// What is printed on each part: the component's letter and a number, "A1", "A2", "B1"; unique.
std::vector<std::string> part_labels(const StripMesh& strips);

}  // namespace sheetform
