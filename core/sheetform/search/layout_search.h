// The search for a small viable layout: insertion, then removal of paths and of arches (paper 3.2 and 3.4).
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "sheetform/search/evaluator.h"
#include "sheetform/search/network_edit.h"
#include "sheetform/tracing/path_smoothing.h"
#include "sheetform/tracing/tracing.h"

namespace sheetform {

struct SearchParams {
  EvaluationParams evaluation;
  int lawson_rounds = 4;         ///< minimax rounds of the global morph while searching
  double min_spacing_edges = 2;  ///< a candidate nearer than this to parallel paths, on average, is dropped
};

/// How a few patches fit, each alone; the worst of them counts.
struct RegionFit {
  int patches = 0;
  double error = 0;  ///< relative to e_max
  int sides = 0;
  double misalignment = 0;
};

/// The state of one search over one component. Steps are public, so that the variants can be composed of
/// them.
class LayoutSearch {
 public:
  /// `surface.mesh` may be moved by smoothing; `graph` and `candidates` refer to its vertices by index.
  LayoutSearch(SearchSurface& surface, PathNetwork start, const TracingGraph& graph,
               std::vector<Path> candidates, const SearchParams& params, RunContext& context);
  /// Starts again from `start` with other parameters and details: the surface is as it was before any
  /// smoothing. Takes the charts of `before` where it has them, so that has to live as long; it must not be
  /// used any more.
  LayoutSearch(LayoutSearch& before, PathNetwork start, DetailPoints details, const SearchParams& params);

  /// Inserts until every patch is a disk with few sides, then until every patch fits within e_max.
  void insert();
  /// Removes whole paths, last first, in passes until none goes.
  void remove_paths();
  /// Removes single arches (T-junctions appear), the most rewarding first, until none goes.
  void remove_arches();
  /// The same, and where an arch may not go with all that hangs on it, it goes alone, or half of it: what
  /// stays is a dart, a seam that ends inside of its patch. Only where darts are allowed: with T-junctions
  /// and seams of a patch with itself.
  void leave_darts();
  /// Shares small patches out among their neighbours, smallest first: each of its faces goes to the nearest
  /// of one, two or all of them, where every patch then fits. Returns how many went.
  int share_out_small();
  /// Patches that are too small to handle (below 0.3 % of the surface, or narrower than 2 % of a diagonal)
  /// grow into their neighbours, or are cut anew together with one, where every patch then fits. Above 40
  /// patches none is tried. slack: multiple of the tolerance that counts as fitting; above 1 the first that
  /// succeeds is the last, may go altogether, and has to be measured. Returns how many changed.
  int grow_slight(double slack = 1);
  /// The areas of the strips of layout(), by patch: small ones are smaller than on the surface.
  void know_strip_areas(const std::vector<double>& areas);
  /// Local search: a stretch of a candidate path goes in, other arches go out; kept when there are fewer
  /// parts, or as many and hardly longer cuts. Ends with the best layout seen. Returns the number of changes
  /// kept.
  int improve(int tries, std::uint64_t seed);
  /// Keeps seams out of the regions of the surface where none is wanted: takes out what runs through, or
  /// cuts around instead, where every patch then fits.
  void clear_regions();
  /// Two neighbours at a time, those with the longest seam first, are cut anew: straight in the chart of both
  /// together, where that is shorter and every patch then fits. Returns how many were.
  int shorten_seams();
  /// Three neighbours at a time, the least curved first, are cut anew as two: straight in the chart of all of
  /// them, where every patch then fits. Returns how many went.
  int make_threes_two();
  /// Number of patches plus a little for the length of the cuts, and much for what lies inside of the regions
  /// where none is wanted.
  double objective();
  /// Smooths all paths, and splits what does not fit any more, until nothing changes.
  void settle();
  /// Smooths the paths as far as every patch stays viable.
  void smooth_what_allows();
  /// The same arch by arch, where a staircase is left because one arch spoils it for all of a patch.
  void smooth_rough_arches();
  /// Arches on the plane of symmetry become straight, longest first, where the patch beside each then fits
  /// together with its mirror image; returns how many.
  int straighten_plane();
  /// Straight arches of these patches (of layout()) take the shape of the surface again; returns how many.
  int release_plane(const std::vector<int>& patches);
  /// These patches (of layout()) failed by a finer measure: they are not formed again.
  void reject(const std::vector<int>& patches);
  /// Smooths all paths on the surface; patches near them are evaluated anew.
  void smooth() { smooth(SmoothParams().cutoff_edges); }
  /// Splits these patches (by id in layout()); returns how many were split. least_share: see split_patch.
  int split(const std::vector<int>& patches, PatchVerdict reason, double least_share = 0);
  /// For patches that cannot be split: each goes to the neighbour beyond its longest arch that may go,
  /// whatever becomes of that; returns how many went.
  int give_away(const std::vector<int>& patches);

  const PatchLayout& layout();
  const LayoutEvaluation& evaluation();
  LayoutEvaluator& evaluator() { return *evaluator_; }
  const EditableNetwork& network() const { return network_; }

 private:
  /// A copy of the layout to try a change on, with what is known of patches shared.
  LayoutSearch(const LayoutSearch& of, RunContext& context);
  /// Edges that could go, with the loose ends that they leave but for darts; none when one of those may not.
  struct Removal {
    std::vector<int> edges;
    bool leaves_dart = false;  ///< a loose end stays
    std::uint64_t key = 0;     ///< of merge_values_
  };
  void changed() { layout_valid_ = evaluation_valid_ = false; }
  std::vector<int> topologically_bad();
  std::vector<int> geometrically_bad();
  std::vector<int> with_corners_to_share(const std::vector<int>& patches);
  /// Paths cross at right angles: no triangles come of them.
  bool paths_share_corners() const { return params_.evaluation.max_sides > 3; }
  int insert_for_geometry();
  bool insert_best(const std::vector<int>& bad);
  double priority(const Path& path, int patch) const;
  bool try_straighten(int edge);
  void set_straight(const std::vector<int>& edges, bool straight);
  bool fits_without(const std::vector<int>& edges, bool leaves_dart);
  bool try_remove(const std::vector<int>& edges);
  std::vector<int> patches_beside(const std::vector<int>& edges);
  std::vector<int> faces_of(const std::vector<int>& patches) const;
  /// hopeless: where the faces of a patch are told that turns out to be far too far off; given, patches that
  /// are too round, or cover what is known to be hopeless, are refused unseen.
  std::optional<RegionFit> viable_region(const PathNetwork& trial, const std::vector<int>& faces,
                                         std::vector<int>* hopeless = nullptr);
  /// Patches and their neighbours, which stay within e_max after a morph with the rest held.
  struct Fitted {
    PatchLayout layout;
    LayoutEvaluation evaluation;
  };
  std::optional<Fitted> fitted(const PathNetwork& network, const std::vector<int>& faces, double slack = 1);
  bool region_fits(const std::vector<int>& faces, double slack = 1);
  /// Edges that can go, and what fits then.
  struct Removed {
    std::vector<int> edges;
    bool joined;  ///< what is left goes on straight as one path
    Fitted fit;
  };
  std::optional<Removed> fitted_without(const std::vector<int>& edges, bool leaves_dart = false);
  void take(const Removed& removed);
  void store(const PatchLayout& layout, const LayoutEvaluation& e);
  void have_places();
  /// Remembers which patches have no strips as they are.
  void know_lost();
  /// Where the vertices are, which version of each that is, and where details lie.
  struct Shape {
    std::vector<Vector3> points;
    std::vector<int> versions;
    DetailPoints details;
  };
  Shape shape() const { return {surface_.mesh.points, surface_.versions, surface_.details}; }
  void give_new_versions(const std::vector<int>& vertices);
  void let_details_follow(const std::vector<char>& moved, const DetailPoints& to = nullptr);
  void take_shape(Shape shape);
  /// All that a change may have to be undone to.
  struct State {
    EditableNetwork network;
    PatchLayout layout;
    ArchPlaces places;
    Shape shape;
  };
  State state() { return {network_, layout(), places_, shape()}; }
  void take(State state);
  void smooth(double cutoff);
  Shape smoothed(double cutoff);
  void move_to(const std::vector<int>& vertices, const Shape& shape);
  SmoothParams smooth_params(double cutoff) const;
  void smooth_arch_of(int edge);
  bool try_smooth_arch(const Arch& arch, double cutoff, double from_ends);
  std::vector<int> stretch_inside(const Path& path, int patch) const;
  /// A stretch of a candidate that could go through a patch.
  struct Proposal {
    int patch;
    const Path* path;
  };
  bool try_improve(const Proposal& proposal);
  void adopt(LayoutSearch& trial);
  double length_inside(const std::vector<int>& edges) const;
  double length_inside();
  bool can_avoid(const Patch& patch) const;
  std::vector<int> split_around(const PatchLayout& before, int patch, const PatchEvaluation& evaluation,
                                double least_share) const;
  Vector3 outside_regions(const Vector3& from, const Vector3& to) const;
  std::vector<std::vector<int>> arches_inside();
  bool recut_around(const std::vector<int>& arch);
  /// A patch that its neighbours take: edges that go, edges that are cut; what becomes of all the faces.
  struct Sharing {
    std::vector<int> gone, cut;
    std::vector<int> faces;  ///< of the patch and those that take it
    int patches = 0;         ///< so many these are now
  };
  struct Taker {
    int patch = -1, arches = 0;  ///< so many lie between
    double seam = 0;             ///< their length
  };
  std::vector<Taker> takers_of(int patch);
  std::vector<int> nearest_of(int patch, const std::vector<int>& takers) const;
  Sharing sharing(int patch, const std::vector<int>& takers) const;
  Sharing handed_over(const std::vector<int>& faces, const std::vector<int>& to,
                      const std::vector<int>& beside) const;
  Sharing handed_over(const std::map<int, int>& to, const std::vector<int>& beside) const;
  std::vector<Sharing> sharings(int patch);
  void add_ways(Sharing s, std::vector<Sharing>& all) const;
  bool try_sharing(const Sharing& s, double slack = 1);
  double least_area() const;
  double lacks(const PatchLayout& layout, const Patch& patch) const;
  double lacks(const PatchLayout& layout) const;
  double area_wanted(const Patch& patch) const;
  std::map<int, int> nearest_around(int patch, const std::vector<int>& from, double area) const;
  std::vector<Sharing> growths(int patch);
  bool grow(int patch, double slack);
  bool helps(const Sharing& way);
  bool try_ways(const std::vector<Sharing>& all, double slack);
  double strip_area(const Patch& patch) const;
  std::vector<Sharing> ways_to_go(int patch);
  std::vector<Sharing> recuts(int patch);
  void add_cut_off(const std::vector<int>& from, std::map<int, int>& to) const;
  std::map<int, double> distances_from(int start, const std::set<int>& inside) const;
  static void apply(const Sharing& s, EditableNetwork& network);
  void smooth_cuts(const std::vector<int>& edges);
  bool is_viable(const Sharing& way, int fewer, std::vector<int>& hopeless);
  using Promising = std::function<bool(const Sharing& way, std::vector<int>& hopeless)>;
  bool try_in_order(const std::vector<Sharing>& ways, const Promising& promising,
                    const std::function<bool(const Sharing&)>& goes);
  bool try_fewer(const std::vector<Sharing>& ways);
  bool share_out(int patch);
  /// Patches that may be cut anew together: a face of each, the sum of their keys when ways were looked for,
  /// and these.
  struct Group {
    std::vector<int> faces;
    std::uint64_t key = 0;
    std::vector<Sharing> ways;
  };
  Group group_of(const std::vector<int>& patches) const;
  std::vector<int> patches_of(const Group& group) const;
  std::uint64_t key_of(const Group& group) const;
  std::vector<Group> pairs_by_seam();
  std::vector<Group> threes_by_curvature();
  using WaysOf = std::function<std::vector<Sharing>(const std::vector<int>& patches)>;
  int recut(std::vector<Group> groups, const WaysOf& ways_of,
            const std::function<bool(const std::vector<Sharing>&)>& goes);
  bool try_shorter(const Sharing& way);
  std::vector<Sharing> straight_ways(const std::vector<int>& patches, const std::vector<int>& seams,
                                     double longest, double least_area) const;
  std::vector<int> seams_between(const std::vector<int>& patches) const;
  double cut_length();
  std::uint64_t neighbourhood_key(const Patch& patch) const;
  std::vector<int> smallest_first(const std::function<bool(const Patch&)>& asked_for);
  bool goes_on_across_plane(const Patch& patch) const;
  std::vector<int> failing_of(const std::vector<int>& faces);
  /// Part of the network, from a node.
  struct Walk {
    std::vector<int> vertices, edges;
  };
  Walk arch_from(const PathNetwork& net, int v, int edge) const;
  Vector3 direction_of(const Walk& arch) const;
  bool join_straight(const std::vector<int>& removed, EditableNetwork& network) const;
  int combinatorial_corners(const Patch& patch) const;
  std::vector<int> with_loose_ends(std::vector<int> edges, int tip = -1) const {
    return with_loose_ends(network_.network(), std::move(edges), tip);
  }
  std::vector<int> with_loose_ends(const PathNetwork& net, std::vector<int> edges, int tip = -1) const;
  struct CornerCount {
    int corners = 0, bends = 0;  ///< bends may be within a side
  };
  CornerCount corners_without(const std::vector<int>& beside, const std::vector<int>& edges) const;
  bool too_many_corners(const std::vector<int>& beside, const std::vector<int>& edges, int most);
  double merge_value(const Removal& removal, std::vector<int>& hopeless);
  bool covers_hopeless(const std::function<bool(int)>& has) const;
  void remember_hopeless(std::vector<std::vector<int>> found);
  double gauss_of(const Patch& patch) const;
  bool too_round(const std::vector<int>& beside, double inner_length) const;
  bool too_round(const PatchLayout& layout, const Patch& patch) const;
  bool too_round(double area, double outline, double gauss) const;
  bool may_go(const Arch& arch) const;
  std::vector<Removal> whole_arches(const PatchLayout& now) const;
  std::vector<Removal> dart_leavers(const PatchLayout& now) const;
  std::uint64_t merge_key(const PatchLayout& now, const Arch& arch) const;
  std::set<int> with_those_around(const std::vector<int>& patches) const;
  std::vector<int> apart(const std::vector<Removal>& all, std::vector<int>& order);
  bool remove_best(const std::vector<Removal>& all);

  SearchSurface& surface_;
  EditableNetwork network_;
  const TracingGraph& graph_;
  std::vector<Path> candidates_;  ///< not yet inserted and still fitting
  std::vector<Path> pool_;        ///< all of them
  int kept_path_ = -1;            ///< not removed for now
  SearchParams params_;
  RunContext& context_;
  NodeDistance distance_;
  std::shared_ptr<LayoutEvaluator> evaluator_;
  LayoutRules rules_;
  double edge_length_;
  int last_version_ = 0;
  Shape rest_;                                             ///< the mesh before any smoothing
  std::shared_ptr<const std::vector<double>> face_gauss_;  ///< per face: its integral of |curvature|
  PatchLayout layout_;
  LayoutEvaluation evaluation_;
  bool layout_valid_ = false, evaluation_valid_ = false;
  std::unordered_map<std::uint64_t, double>
      merge_values_;  ///< by arch and patches beside it; negative = not viable
  using Faces = std::shared_ptr<const std::vector<int>>;
  std::vector<Faces> hopeless_;                  ///< what is far from being one patch; not after smoothing
  std::unordered_set<std::uint64_t> unshared_;   ///< small patches that could not be shared out, by key
  std::unordered_set<std::uint64_t> not_recut_;  ///< groups that were looked at, by the sum of their keys
  std::unordered_set<std::uint64_t> ungrown_;    ///< slight patches that could not grow, by key
  std::unordered_map<std::uint64_t, double> strip_share_;  ///< of a patch's area that its strips have, by key
  ArchPlaces places_;                                      ///< after the last morphs
  std::unordered_set<std::uint64_t>
      lost_;  ///< patches without strips, by key: not for a removal to blame for
};

}  // namespace sheetform
