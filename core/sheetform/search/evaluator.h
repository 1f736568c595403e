// Whether a layout is viable, and how well it fits: topology, charts, rulings, the morph (paper 3.3).
#pragma once
#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/layout/layout.h"
#include "sheetform/mesh/closest_point.h"
#include "sheetform/mesh/keep_out.h"
#include "sheetform/mesh/symmetry.h"
#include "sheetform/morph/morph.h"
#include "sheetform/ruling/rulings.h"
#include "sheetform/search/evaluation_counts.h"
#include "sheetform/search/spacing.h"

namespace sheetform {

/// A point of the input that the working mesh misses by more than a little, and the face of the working mesh
/// below.
struct DetailPoint {
  Vector3 point;
  Vector3 barycentric;
  int face;
};
/// Ascending by face, then by place.
using DetailPoints = std::shared_ptr<const std::vector<DetailPoint>>;

/// The surface as the search sees it; lengths are in bounding-box diagonals of the input.
struct SearchSurface {
  SurfaceMesh mesh;           ///< the working mesh; its points move when paths are smoothed
  std::vector<int> versions;  ///< per vertex, raised when it moves
  SurfaceGuide guide;
  const ClosestPointTree* input = nullptr;    ///< the untouched input
  DetailPoints details;                       ///< null = there are none
  const CurvatureField* curvature = nullptr;  ///< of `mesh`; may be null but for the full morph
  std::vector<int> elimination_rank;          ///< see ruling/chart.h; may be empty
  PlaneBorder plane;                          ///< of a half; empty without symmetry
  std::vector<char> crease;                   ///< by edge; empty = none is
  std::vector<char> drawn_plane;     ///< by edge: on the plane, and drawn as a seam by the user; may be empty
  const KeepOut* regions = nullptr;  ///< where the user wants no seam; null = there are none
  std::vector<char> keep_out;        ///< by edge: in `regions` or next to them; empty = there are none

  std::vector<char> straight;  ///< by edge: its arch on the plane is one segment, a ruling of the patch
                               ///< beside it joined to its image; empty = none is

  bool is_straight(const Arch& arch) const { return !straight.empty() && straight[arch.edges.front()]; }
  bool on_crease(const Arch& arch) const { return !crease.empty() && crease[arch.edges.front()]; }
  bool on_plane(const Arch& arch) const { return !plane.edge.empty() && plane.edge[arch.edges.front()]; }
  bool on_plane(int vertex) const { return !plane.vertex.empty() && plane.vertex[vertex]; }
  bool is_drawn(const PathNetwork& network, const Arch& arch) const {
    return network.kinds[arch.path] == PathKind::kDrawn ||
           (!drawn_plane.empty() &&
            std::any_of(arch.edges.begin(), arch.edges.end(), [&](int e) { return drawn_plane[e] != 0; }));
  }
};

struct EvaluationParams {
  double e_max = 0.02;
  int max_sides = 6;
  bool self_seams = true;
  bool t_junctions = true;
  double spacing = 0.03;  ///< of arch samples
  SpacingBounds bounds;   ///< of the same, asked for by the user
  double sparsest = 1;    ///< share of their density where no rulings end (see outline_samples.h)
  std::vector<std::uint64_t> plain_arches;  ///< keys, ascending: samples of these are even
  double plain_spacing = 0.03;              ///< and so far apart
  double corner_reach = 0.03;               ///< length over which directions at nodes are taken
  double corner_turn = 55;      ///< degrees: a node where a patch turns by more is a corner: those of a
                                ///< regular hexagon (60) are, those of an octagon (45) are rounded
  double normal_deviation = 0;  ///< degrees; 0 = no criterion
  RulingParams ruling;
  MorphParams morph;
  std::size_t remembered = 1500;  ///< evaluations, some hundred kilobytes each; results do not depend on it
};

enum class PatchVerdict : char {
  kViable,
  kNotADisk,
  kTouches,
  kTooManySides,
  kFolded,
  kNoRulings,
  kOverlap,
  kError
};
const char* to_string(PatchVerdict verdict);

/// The largest n of the paper. With it, bends of the border or of the seam with one neighbour count as
/// corners only as far as there is room.
constexpr int kMostSides = 6;

/// How the flat outline of a patch turns at a node.
struct NodeTurn {
  int vertex;     ///< of the mesh
  double angle;   ///< degrees, counter-clockwise positive
  double limit;   ///< beyond it the node is a corner
  bool may_bend;  ///< inside of a side, where a patch would have too many corners: no seam ends there
};

/// All that is known of one patch alone; cached by Patch::key.
struct PatchEvaluation {
  PatchVerdict verdict = PatchVerdict::kNotADisk;
  std::shared_ptr<const PatchChart> chart;
  PatchPolygon polygon;
  std::vector<int> corners;     ///< polygon points
  std::vector<NodeTurn> turns;  ///< of the outline, at its nodes
  RulingSet rulings;
  std::vector<MorphSample> samples;  ///< unknown = polygon point
  double error = 0;                  ///< with its outline free: a lower bound for the patch in any layout
  Vector2 worst = Vector2::Zero();   ///< in the chart: where `error` is attained
  bool viable() const { return verdict == PatchVerdict::kViable; }
  /// It has strips that do not overlap; they may be too far off.
  bool has_valid_strips() const { return viable() || verdict == PatchVerdict::kError; }
};

/// Where the points of each arch are after the last morph, by Arch::key: from node to node.
using ArchPlaces = std::unordered_map<std::uint64_t, std::vector<Vector3>>;

/// A layout, or a part of it, after the morph. Entries of patches that were not asked for are empty.
struct LayoutEvaluation {
  std::vector<std::shared_ptr<const PatchEvaluation>> patches;
  std::vector<double> patch_error;              ///< after the global morph
  std::vector<std::vector<int>> unknowns;       ///< per patch: polygon point -> unknown
  std::vector<std::vector<int>> arch_unknowns;  ///< per arch: its points from node to node
  std::vector<Vector3> position;                ///< per unknown
  std::vector<char> on_plane;                   ///< per unknown: on the plane of symmetry; empty = none is
  double max_error = 0;
  int failing = 0;  ///< patches that are not viable or exceed e_max
};

/// Evaluates layouts of one surface; remembers the patches that it has seen. Thread-safe for patch(),
/// known() and chart().
class LayoutEvaluator {
 public:
  /// `charts`: an evaluator of the same surface whose charts are taken where it has them; may be null.
  /// keep_corners: patches have the corners that they have there; all that are asked for must be held there,
  /// for where one was forgotten its corners may be others.
  LayoutEvaluator(const SearchSurface& surface, const EvaluationParams& params, RunContext& context,
                  LayoutEvaluator* charts = nullptr, bool keep_corners = false)
      : surface_(surface), params_(params), context_(context), charts_(charts), keep_corners_(keep_corners) {}

  const EvaluationParams& params() const { return params_; }
  std::shared_ptr<const PatchEvaluation> patch(const PatchLayout& layout, int p);
  /// The same where it has been evaluated before, or null.
  std::shared_ptr<const PatchEvaluation> known(const Patch& patch) const;
  /// Its chart alone: as it was evaluated before, here or where charts are taken from, or made anew.
  std::shared_ptr<const PatchChart> chart(const PatchLayout& layout, const Patch& patch) const;
  /// A patch that failed by a finer measure: not viable from now on.
  void reject(const Patch& patch);
  /// All patches, on all threads.
  std::vector<std::shared_ptr<const PatchEvaluation>> patches(const PatchLayout& layout);
  /// The patch with other preferences for its rulings, and some chords forbidden (polygon points; may be
  /// null); not cached.
  std::shared_ptr<const PatchEvaluation> patch_with(const PatchLayout& layout, int p,
                                                    const RulingParams& ruling,
                                                    const std::function<bool(int, int)>* forbidden) const {
    return compute(layout, layout.patches[p], ruling, forbidden);
  }
  /// Global morph of the patches that have rulings; per-patch errors. `rounds`: minimax reweightings.
  LayoutEvaluation layout(const PatchLayout& layout, int rounds) {
    return solve(layout, patches(layout), rounds);
  }
  /// `also`: further samples, in terms of the unknowns of an earlier solution of the same layout.
  LayoutEvaluation solve(const PatchLayout& layout,
                         std::vector<std::shared_ptr<const PatchEvaluation>> patches, int rounds,
                         const std::vector<MorphSample>& also = {});
  /// Morph of a part of a layout (extract_region) alone; arches to patches outside of it stay at `places` (on
  /// the surface when unknown).
  LayoutEvaluation solve_region(const PatchLayout& region, const ArchPlaces& places, int rounds);
  /// So far. Not for while others evaluate. May depend on the number of threads once the cache is full.
  const EvaluationCounts& counts() const { return counts_; }

 private:
  LayoutEvaluation morph_patches(const PatchLayout& layout,
                                 std::vector<std::shared_ptr<const PatchEvaluation>> patches,
                                 const ArchPlaces& places, int rounds, const std::vector<MorphSample>& also);
  std::shared_ptr<const PatchEvaluation> compute(const PatchLayout& layout, const Patch& patch,
                                                 RulingParams ruling,
                                                 const std::function<bool(int, int)>* forbidden) const;
  const SearchSurface& surface_;
  EvaluationParams params_;
  RunContext& context_;
  LayoutEvaluator* charts_;
  bool keep_corners_;
  mutable std::mutex mutex_;
  std::unordered_map<std::uint64_t, std::shared_ptr<const PatchEvaluation>> cache_;
  std::unordered_set<std::uint64_t> rejected_;
  mutable EvaluationCounts counts_;
};

/// Largest distance between the strips and the surface at the samples of one patch; `limit`: below it
/// displacement is taken for distance. worst_sample: where.
double patch_error(const std::vector<MorphSample>& samples, const std::vector<std::array<int, 3>>& triangles,
                   const std::vector<Vector3>& position, const ClosestPointTree& input, double limit,
                   const MorphSample** worst_sample);

}  // namespace sheetform
