// One connected surface: from the prepared mesh to strips that keep the tolerance.
#pragma once
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sheetform/mesh/prepare.h"
#include "sheetform/search/layout_search.h"
#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

/// What the search works on; lengths are in bounding-box diagonals of the whole input.
struct ComponentInput {
  PreparedMesh prepared;
  TriangleSoup reference;                        ///< the untouched input surface of this component
  std::shared_ptr<const ClosestPointTree> tree;  ///< of `reference`; null: the run makes its own
  /// Of a half: the untouched input that it and its mirror image stand for, which need not be quite
  /// symmetric; results are measured against it. Empty: the half is exact.
  TriangleSoup whole;
  std::shared_ptr<const ClosestPointTree> whole_tree;  ///< of `whole`
  std::vector<Vector3> guide;  ///< cross directions given by the user, per prepared vertex; empty = none
  bool half = false;           ///< of a symmetric surface: its border on x = 0 stays there, to be mirrored
  std::vector<char>
      drawn_edge;  ///< by edge of the prepared mesh: a seam that the user has drawn; may be empty
  std::vector<char> drawn_plane;  ///< the same of border edges on the plane of symmetry; may be empty
  KeepOut keep_out;               ///< regions of the prepared mesh where the user wants no seam
};

struct ComponentParams {
  EvaluationParams evaluation;  ///< e_max is the promised tolerance here
  /// Interior seeds of candidate paths, for a search each; all but the first only where those before miss the
  /// tolerance by little, or without T-junctions.
  std::vector<int> seeds{200};
  /// Tries of the local search with up to eight parts. 0: no other step either that takes long for a few
  /// parts less.
  int improvements = 20;
  int improvements_of_many = 10;          ///< the same with more parts, where a try wins less
  double fine_spacing = 0.015;            ///< outline samples of the result
  SpacingBounds spacing;                  ///< of the outline points of the result
  double aim = 0.97;                      ///< share of e_max that fits while searching
  double margin = 0.97;                   ///< the last passes aim at this share of e_max
  MorphKind morph = MorphKind::kReduced;  ///< gives the last positions; the search takes the reduced one
  std::uint64_t seed = 0;
};

struct ComponentResult {
  StripMesh strips;
  double distance = 0;  ///< two-sided, as measured
  double miss = 0;      ///< the distance over e_max, or the normal deviation over its limit; above 1: not met
  std::vector<std::string> notes;         ///< for people
  std::map<std::string, double> seconds;  ///< by stage
  EvaluationCounts counts;                ///< of the search and of its final passes
};

/// One result for each tolerance of `e_max`, which ascend (params.evaluation.e_max does not count), handed to
/// `found` with its index as soon as it is there. Field, graph and candidates are shared, and the charts of
/// patches seen before; a coarser tolerance does not take more parts. Throws as decompose_component, and what
/// `found` throws.
void sweep_component(const ComponentInput& input, const ComponentParams& params,
                     const std::vector<double>& e_max, RunContext& context,
                     const std::function<void(std::size_t, ComponentResult)>& found);

/// Always returns valid strips: what cannot be kept is split until it can. Throws as the context does, and
/// Error kInternal where no valid strips are found, or sides thinner than the tolerance stay inside out.
ComponentResult decompose_component(const ComponentInput& input, const ComponentParams& params,
                                    RunContext& context);

}  // namespace sheetform
