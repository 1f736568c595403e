#include "sheetform/search/component.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "sheetform/base/error.h"
#include "sheetform/ruling/follow_crosses.h"
#include "sheetform/search/detail_points.h"
#include "sheetform/search/fair_outlines.h"
#include "sheetform/search/full_shape.h"
#include "sheetform/search/laps.h"
#include "sheetform/search/measure_attempt.h"
#include "sheetform/search/stroke_ends.h"
#include "sheetform/strip/close_points.h"

namespace sheetform {
namespace {

// Steps of one final pass; an excess over the tolerance has to shrink to this share at each.
constexpr int kMostSteps = 12;
constexpr double kProgress = 0.85;
// Multiples of the tolerance beyond which a pass that stays there for so many steps is given up (of 60 none
// kept the tolerance later), and a whole result, which another search would not better; and of another pass's
// excess beyond which a pass is given up.
constexpr double kLost = 1.1, kHopeless = 1.5, kBehind = 1.5;
constexpr int kStale = 2;
// So many parts at most grow after the last pass, where the search sees no more than this error, in
// tolerances.
constexpr int kMostEnlarged = 6;
constexpr double kRoomAtEnd = 1.12;
// Smoothing of the seams in the end: a point may go so far, in tolerances, or so far, in diagonals, as the
// zigzag of the mesh is high; measured so often at most.
constexpr double kFarthest = 0.5, kZigzag = 0.01;
constexpr int kMostFairings = 16;
constexpr double kOnPlane = 1e-9;   // of the diagonal
constexpr double kSparsest = 0.12;  // of the outline points of the result where no rulings end
constexpr double kBeside = 0.75;  // edges: so near to a region where no seam is wanted, none is traced or cut
constexpr int kEvener = 4;        // further morphs for outline points at the distances asked for
// Coarser outlines may spare a split or two; with many parts that is not worth it in every round.
constexpr std::size_t kFewOf = 100, kManyParts = 60;
constexpr int kOutlineRounds = 2, kFewParts = 8;
constexpr int kSpacingRounds = 15;  // of splitting; after these, valid strips go before the distances
constexpr double kFineSpacing = ComponentParams().fine_spacing;
// What is split in the end: of a part's area, either side should have so much; after so many rounds all that
// is too far, not only the farthest.
constexpr double kLeastSplit = 0.05;
constexpr int kRoundsOfFarthest = 15;
constexpr double kFacing = 0.01;  // mean cosine to the input below which strips are inside out, or may be
// Of the tolerance, where sides have changed places: with half of it at once wires took 5 to 19 parts, not 2.
constexpr std::array<double, 6> kFiner{0.9, 0.75, 0.6, 0.4, 0.25, 0.125};
constexpr const char* kKeptApart = "a part thinner than the tolerance was kept by working to a finer one";

// Creases and drawn seams: the field follows them and paths end there.
std::vector<char> lines_of(const ComponentInput& input) {
  std::vector<char> lines = input.prepared.crease_edge;
  for (std::size_t e = 0; e < input.drawn_edge.size(); ++e) lines[e] |= input.drawn_edge[e];
  return lines;
}

class ComponentRun {
 public:
  ComponentRun(const ComponentInput& input, const ComponentParams& params, RunContext& context)
      : input_(input),
        params_(params),
        context_(context),
        own_tree_(input.tree ? input.tree
                             : std::make_shared<ClosestPointTree>(input.reference.points,
                                                                  input.reference.faces, context)),
        tree_(*own_tree_) {}

  using Found = std::function<void(std::size_t, const ComponentResult&)>;
  const ClosestPointTree& tree() const { return tree_; }  // of the input
  void run(const std::vector<double>& tolerances, const Found& found) {
    params_.evaluation.e_max = tolerances.front();
    const SurfaceMesh& mesh = input_.prepared.mesh;
    const auto& crease = input_.prepared.crease_edge;
    const std::vector<char> lines = lines_of(input_);
    context_.report(Stage::kField, 0);
    curvature_ = principal_curvature(mesh, crease, {}, context_);
    parallel_for(context_, 3, [&](int i) {  // none needs another
      if (i == 1) return set_up_surface();
      if (i == 2) return set_up_measure();
      field_ =
          cross_field(mesh, lines, curvature_, input_.guide.empty() ? nullptr : &input_.guide, {}, context_);
    });
    laps_.lap(Stage::kField);
    context_.report(Stage::kTrace, 0);
    graph_ = without_edges(mesh, tracing_graph(mesh, lines, field_, {}, context_), surface_.keep_out);
    start_ = start_network();
    laps_.lap(Stage::kTrace);
    ComponentResult finer;
    for (std::size_t k = 0; k < tolerances.size(); ++k) {
      params_.evaluation.e_max = tolerances[k];
      ComponentResult result = solve();
      if (k > 0 && result.strips.patches.size() > finer.strips.patches.size())
        result = as_coarser(finer, tolerances[k], std::move(result));
      found(k, result);
      finer = std::move(result);
    }
  }

 private:
  // Searches from so many candidates, one a tolerance, with charts of those before; the surface is theirs to
  // move.
  struct Lane {
    SearchSurface surface;
    std::vector<std::unique_ptr<LayoutSearch>> searches;
  };

  // How outlines get their points in the last passes: fine ones bend more smoothly, with few points where no
  // rulings end; even and coarser ones, as the search had them, may leave less to mend.
  struct Outlines {
    int coarser = 0;                   // 0: the finest, uneven; then even ones, the first as fine
    std::vector<std::uint64_t> plain;  // keys of arches with even points whatever the others have
    bool plain_as_searched = false;    // these as the search had them; else as fine as the others
  };

  // A search for the tolerance as it is now.
  LayoutSearch& begin(std::size_t k) {
    if (k == lanes_.size()) {
      TraceParams trace;
      trace.seeds = params_.seeds[k];
      lane_ = &lanes_.emplace_back();
      lane_->surface = surface_;
      lane_->searches.push_back(std::make_unique<LayoutSearch>(
          lane_->surface, start_, graph_,
          trace_candidates(input_.prepared.mesh, graph_, field_, trace, context_), search_params(),
          context_));
      laps_.lap(Stage::kTrace);
    } else {
      lane_ = &lanes_[k];
      lane_->searches.push_back(
          std::make_unique<LayoutSearch>(*lane_->searches.back(), start_, details(), search_params()));
    }
    return *lane_->searches.back();
  }

  DetailPoints details() const {
    return detail_points(input_, tree_, surface_, params_.evaluation.e_max, context_);
  }

  void set_up_surface() {
    surface_.mesh = input_.prepared.mesh;
    surface_.versions.assign(surface_.mesh.points.size(), 0);
    surface_.guide = surface_guide(surface_.mesh, curvature_);
    if (!input_.guide.empty()) follow_crosses(surface_.mesh, input_.guide, surface_.guide);
    surface_.curvature = &curvature_;
    surface_.input = &tree_;
    surface_.elimination_rank = elimination_rank(surface_.mesh);
    surface_.crease = input_.prepared.crease_edge;
    if (input_.half) surface_.plane = plane_border(surface_.mesh, kOnPlane);
    surface_.details = details();
    surface_.drawn_plane = input_.drawn_plane;
    if (!input_.keep_out.empty()) surface_.regions = &input_.keep_out;
    surface_.keep_out =
        edges_inside(surface_.mesh, input_.keep_out, kBeside * mean_edge_length(surface_.mesh));
    set_up_spacing();
  }

  void set_up_measure() {
    measure_ = std::make_unique<const AttemptMeasure>(input_, tree_, params_, context_);
  }

  // The search keeps to the lower bound; finer than the result usually is it need not be.
  void set_up_spacing() {
    if (!params_.spacing.any()) return;
    double &fine = params_.fine_spacing, &search = params_.evaluation.spacing;
    const double usual = fine;
    fine = std::max(std::min(fine, params_.spacing.most), params_.spacing.least);
    search = std::max(std::min(search, std::max(usual, params_.spacing.most)), params_.spacing.least);
    params_.evaluation.bounds = {params_.spacing.least, std::max(usual, params_.spacing.most)};
  }

  // The strips of a finer tolerance where those of a coarser one are no fewer.
  static ComponentResult as_coarser(const ComponentResult& finer, double e_max, ComponentResult own) {
    own.strips = finer.strips;
    own.distance = finer.distance;
    own.miss = finer.distance / e_max;
    own.notes = finer.notes;
    return own;
  }

  PathNetwork start_network() const {
    PathNetwork network = bare_network(surface_.mesh);
    if (input_.half) add_symmetry(surface_.plane.edge, network);
    add_creases(surface_.mesh, input_.prepared.crease_edge, network);
    if (input_.drawn_edge.empty()) return network;
    add_creases(surface_.mesh, input_.drawn_edge, network, PathKind::kDrawn);
    extend_drawn_ends(surface_.mesh, graph_, field_, network, context_);
    return network;
  }

  SearchParams search_params() const {
    SearchParams search;
    search.evaluation = params_.evaluation;
    search.evaluation.e_max *= params_.aim;
    search.evaluation.normal_deviation *= params_.margin;
    return search;
  }

  // From the bare network to the strips; what is shared counts for the first tolerance. Where the patches
  // that a normal deviation asks for cannot keep the tolerance, that comes first.
  ComponentResult solve() {
    ComponentResult best = search_all();
    double& limit = params_.evaluation.normal_deviation;
    if (limit > 0 && best.distance > params_.evaluation.e_max) {
      const double asked = std::exchange(limit, 0);
      ComponentResult other = search_all();
      limit = asked;
      if (!other.strips.patches.empty() && other.distance < best.distance) std::swap(best, other);
      best.counts += other.counts;
    }
    if (best.strips.patches.empty())
      throw Error(ErrorCode::kInternal, "no valid strips were found for a component");
    best.seconds = laps_.take();
    return best;
  }

  // Chance decides what greedy steps end in: where a search misses the tolerance by little, or has no valid
  // strips, the next may do. Without T-junctions few steps can make good what chance did: all are run.
  ComponentResult search_all() {
    ComponentResult best;
    for (std::size_t k = 0; k < params_.seeds.size(); ++k) {
      LayoutSearch& search = begin(k);
      search.insert();
      laps_.lap(Stage::kInsert);
      reduce(search);
      complete(search);
      if (best.strips.patches.empty() || rank_of(result_) < rank_of(best)) std::swap(best, result_);
      best.counts += std::exchange(result_, {}).counts;
      best.counts += search.evaluator().counts();
      const bool met = params_.evaluation.t_junctions && best.miss <= 1;
      if (!best.strips.patches.empty() && (met || best.miss > kHopeless)) break;
    }
    return best;
  }

  // The tolerance first, then parts; a result without strips last.
  static std::tuple<bool, double, std::size_t> rank_of(const ComponentResult& r) {
    return {r.strips.patches.empty(), std::max(r.miss - 1, 0.0), r.strips.patches.size()};
  }

  // Fills result_ from what a search has found; without strips when none are valid.
  void complete(LayoutSearch& search) {
    improve(search);
    if (input_.half) search.straighten_plane();
    laps_.lap(Stage::kRemove);
    finish(search);
    part_close_points(result_.strips, 1);
    const bool asked_for = params_.spacing.any() || !input_.guide.empty();
    if (!asked_for) drop_flat_rulings(result_.strips);
    laps_.lap(Stage::kFinal);
  }

  void reduce(LayoutSearch& search) const {
    search.clear_regions();
    search.remove_paths();
    if (!params_.evaluation.t_junctions) return;
    search.smooth_what_allows();
    search.remove_arches();
    if (quick()) return;
    search.smooth_what_allows();
    search.remove_arches();
  }

  void improve(LayoutSearch& search) const {
    if (!params_.evaluation.t_junctions) return;
    if (!quick()) {
      search.share_out_small();
      search.shorten_seams();
      search.make_threes_two();
      search.leave_darts();
      search.improve(tries(search), params_.seed);
    }
    search.clear_regions();
    if (quick()) return search.smooth_what_allows();
    search.share_out_small();
    search.smooth_what_allows();
    search.smooth_rough_arches();
    search.shorten_seams();
    search.leave_darts();
    search.grow_slight();
  }

  bool quick() const { return params_.improvements == 0; }

  // Few parts are soon tried out, and one cannot become fewer.
  int tries(LayoutSearch& search) const {
    const int parts = static_cast<int>(search.layout().patches.size());
    const int wanted = parts > kFewParts ? params_.improvements_of_many : params_.improvements;
    return std::min(wanted, 6 * (parts - 1));
  }

  static std::vector<std::uint64_t> keys_of(const PatchLayout& layout, const std::vector<int>& patches) {
    std::vector<std::uint64_t> keys;
    for (int p : patches) keys.push_back(layout.patches[p].key);
    return keys;
  }

  static std::vector<int> patches_with(const PatchLayout& layout, const std::vector<std::uint64_t>& keys) {
    std::vector<int> patches;
    for (int p = 0; p < static_cast<int>(layout.patches.size()); ++p)
      if (std::find(keys.begin(), keys.end(), layout.patches[p].key) != keys.end()) patches.push_back(p);
    return patches;
  }

  // By the distance alone, as far as it is not met, then by all: a normal deviation that cannot be met does
  // not cost the tolerance.
  using Miss = std::pair<double, double>;
  Miss miss_of(const Attempt& a) const {
    return {std::max(a.distance / params_.evaluation.e_max, 1.0), a.miss};
  }

  // Final strips of the present layout; what breaks a promise is split, until nothing does.
  void finish(LayoutSearch& search) {
    bool have_best = false;
    Miss best;
    Outlines outlines;
    for (int round = 0; round < 80; ++round) {
      context_.report(Stage::kFinal, round / (round + 4.0));
      const Attempt attempt = build_best(search, round, outlines);
      const bool valid = attempt.invalid.empty();
      if (search.release_plane(valid ? attempt.too_far : attempt.invalid) > 0) continue;
      if (attempt.invalid.empty()) {
        // More parts must buy less error.
        if (!have_best || miss_of(attempt) < best) take(attempt, search.layout());
        best = have_best ? std::min(best, miss_of(attempt)) : miss_of(attempt);
        have_best = true;
        if (attempt.too_far.empty()) {
          refine(search, round, outlines);
          return enlarge(search, round, outlines);
        }
        if (round >= 30) return;
        if (!split_far(search, attempt, round)) return;
      } else {
        search.reject(attempt.invalid);
        const std::vector<int> too_far = far_to_split(attempt, round);
        search.reject(too_far);
        const std::vector<std::uint64_t> far = keys_of(search.layout(), too_far);
        if (search.split(attempt.invalid, PatchVerdict::kOverlap, kLeastSplit) == 0 &&
            search.give_away(attempt.invalid) == 0)
          break;
        search.split(patches_with(search.layout(), far), PatchVerdict::kError, kLeastSplit);
      }
      if (round < 6 && params_.evaluation.t_junctions) {
        search.leave_darts();
        search.share_out_small();
        if (!quick()) search.make_threes_two(), search.grow_slight();
      }
    }
  }

  static std::vector<int> far_to_split(const Attempt& attempt, int round) {
    return round < kRoundsOfFarthest ? attempt.farthest() : attempt.too_far;
  }

  // Whether any part of what is too far could be split.
  static bool split_far(LayoutSearch& search, const Attempt& attempt, int round) {
    for (const std::vector<int>& patches : {far_to_split(attempt, round), attempt.too_far}) {
      search.reject(patches);
      if (search.split(patches, PatchVerdict::kError, kLeastSplit) > 0) return true;
    }
    return false;
  }

  // Splits may have left parts that keep finer outlines now. Distances that were asked for are kept as they
  // are.
  void refine(LayoutSearch& search, int round, Outlines& outlines) {
    if (quick() || outlines.coarser == 0 || params_.spacing.any()) return;
    Outlines fine;
    const Attempt attempt = build_mixed(search, round, fine, build(search, round, fine));
    if (!attempt.good()) return;
    take(attempt, search.layout());
    outlines = fine;
  }

  // The last passes keep the tolerance a little better than the search can tell: what is slight still grows
  // or goes where that is enough.
  void enlarge(LayoutSearch& search, int round, Outlines outlines) {
    const int most = quick() || !params_.evaluation.t_junctions ? 0 : kMostEnlarged;
    for (int k = 0; k < most && result_.strips.patches.size() == search.layout().patches.size(); ++k) {
      search.know_strip_areas(strip_areas(result_.strips));
      if (search.grow_slight(kRoomAtEnd) == 0) return;
      const Attempt attempt = build_best(search, round, outlines);
      if (!attempt.good()) return;
      take(attempt, search.layout());
    }
  }

  // After kSpacingRounds the distances asked for are not held any more.
  static bool holds_spacing(int round) { return round < kSpacingRounds; }

  // nullopt: coarser than the search had them.
  std::optional<EvaluationParams> evaluation_of(const Outlines& outlines, int round) const {
    EvaluationParams e = params_.evaluation;
    e.e_max *= params_.margin;
    e.normal_deviation *= params_.margin;
    e.bounds = holds_spacing(round) ? params_.spacing : SpacingBounds{0, params_.spacing.most};
    e.spacing = holds_spacing(round) ? params_.fine_spacing : std::min(params_.fine_spacing, kFineSpacing);
    for (int k = 1; k < outlines.coarser; ++k) e.spacing *= 1.4;
    e.sparsest = outlines.coarser == 0 ? kSparsest : 1;
    e.plain_arches = outlines.plain;
    e.plain_spacing = outlines.plain_as_searched ? params_.evaluation.spacing : e.spacing;
    if (outlines.coarser > 0 && e.spacing > params_.evaluation.spacing) return std::nullopt;
    return e;
  }

  // outlines: which were the best, where the next round begins.
  Attempt build_best(LayoutSearch& search, int round, Outlines& outlines) {
    while (!evaluation_of(outlines, round)) --outlines.coarser;
    Attempt best = build(search, round, outlines);
    const std::size_t parts = search.layout().patches.size();
    if (best.has_gaps() || best.invalid.size() > std::max<std::size_t>(1, parts / kFewOf) ||
        (parts > kManyParts && round >= kOutlineRounds))
      return best;
    if (outlines.coarser == 0) best = build_mixed(search, round, outlines, std::move(best));
    Outlines next{outlines.coarser + 1, {}};
    for (; !best.good() && evaluation_of(next, round); ++next.coarser) {
      Attempt other = build(search, *evaluation_of(next, round), &best);
      if (!other.has_gaps() && rank(other) < rank(best)) best = std::move(other), outlines = next;
    }
    EvaluationParams narrow = best.evaluation;
    for (int k = 0; k < kEvener && holds_spacing(round) && best.invalid.empty() && best.uneven.any(); ++k) {
      narrow.bounds = tightened(narrow.bounds, best.uneven);
      Attempt other = build(search, narrow);
      const bool as_good = other.invalid.empty() && other.too_far.size() <= best.too_far.size();
      if (as_good && other.uneven.worst() < best.uneven.worst()) best = std::move(other);
    }
    return best;
  }

  // From `best`, which has these outlines: plain ones around the parts that fail.
  Attempt build_mixed(LayoutSearch& search, int round, Outlines& outlines, Attempt best) {
    for (const bool as_searched : {false, true}) {
      if (best.good()) break;
      Outlines next = with_plain(outlines, search.layout(), {best.invalid, best.too_far});
      next.plain_as_searched |= as_searched;
      if (next.plain == outlines.plain && next.plain_as_searched == outlines.plain_as_searched) continue;
      Attempt other = build(search, round, next);
      if (!other.has_gaps() && rank(other) < rank(best)) best = std::move(other), outlines = std::move(next);
    }
    return best;
  }

  static Outlines with_plain(Outlines outlines, const PatchLayout& layout,
                             const std::vector<std::vector<int>>& patches) {
    std::vector<std::uint64_t>& plain = outlines.plain;
    for (const std::vector<int>& some : patches)
      for (int p : some)
        for (const ArchUse& use : layout.patches[p].boundary) plain.push_back(layout.arches[use.arch].key);
    std::sort(plain.begin(), plain.end());
    plain.erase(std::unique(plain.begin(), plain.end()), plain.end());
    return outlines;
  }

  Attempt build(LayoutSearch& search, int round, const Outlines& outlines) {
    return build(search, *evaluation_of(outlines, round));
  }

  // Given up where it will not be better than `to_beat`.
  Attempt build(LayoutSearch& search, const EvaluationParams& evaluation, const Attempt* to_beat = nullptr) {
    FinalPass pass(lane_->surface, search.network().network(), search.layout(), evaluation,
                   search.evaluator(), context_);
    Attempt best = best_of(pass, evaluation, to_beat);
    result_.counts += pass.counts();
    return best;
  }

  Attempt best_of(FinalPass& pass, const EvaluationParams& evaluation, const Attempt* to_beat) {
    Attempt best;
    for (int step = 0, stale = 0; step < kMostSteps; ++step) {
      context_.checkpoint();
      FinishedLayout finished = pass.solve(10);
      context_.checkpoint();
      Attempt attempt = measure_->measured(std::move(finished), evaluation);
      if (attempt.good()) return attempt;
      if (attempt.has_gaps()) return step == 0 ? attempt : best;
      const bool better = step == 0 || clearly_better(attempt, best);
      stale = better ? 0 : stale + 1;
      pass.draw_to(attempt.far);
      bool eased = pass.plainer(attempt.hard);
      const bool mended = pass.plainer(attempt.invalid);
      const bool stuck = to_beat != nullptr && attempt.invalid.size() >= to_beat->bad() && !mended;
      eased |= mended;
      const std::vector<int> too_far = attempt.too_far;
      if (step == 0 || rank(attempt) < rank(best)) best = std::move(attempt);
      const int patience = std::max(kStale, static_cast<int>(best.bad() / 2));
      if (best.invalid.empty() && best.miss > kLost && stale >= patience) break;
      if (stuck || (step > 0 && to_beat != nullptr && far_behind(best, *to_beat))) break;
      if (eased) continue;
      if (too_far.empty()) break;
      if (stale >= patience) {
        if (!pass.plainer(too_far)) break;
        stale = 0;
      }
    }
    return best;
  }

  static bool far_behind(const Attempt& now, const Attempt& other) {
    return now.bad() > other.bad() && now.miss - 1 > kBehind * (other.miss - 1);
  }

  // Small steps towards a tolerance that is far off lead nowhere.
  static bool clearly_better(const Attempt& now, const Attempt& best) {
    if (now.bad() != best.bad()) return now.bad() < best.bad();
    if (now.invalid.size() != best.invalid.size()) return now.invalid.size() < best.invalid.size();
    return now.miss - 1 < kProgress * (best.miss - 1);
  }

  static std::tuple<std::size_t, std::size_t, double> rank(const Attempt& a) {
    return {a.bad(), a.invalid.size(), a.miss};
  }

  // Not far, not beyond the plane of symmetry, not into a region where no seam is wanted.
  bool may_be_faired(const Vector3& from, const Vector3& to) const {
    if ((to - from).norm() > std::max(kFarthest * params_.evaluation.e_max, kZigzag)) return false;
    if (input_.half && from.x() > 0 && to.x() <= 0) return false;
    return input_.keep_out.empty() || input_.keep_out.depth(to, 0) <= input_.keep_out.depth(from, 0);
  }

  // Seams as smooth as the promises allow; as they were where that is not found.
  Attempt with_fair_outlines(const Attempt& rough) {
    std::vector<char> may_move;
    for (const StripSource::Arch& a : rough.finished.source.arches)
      may_move.push_back(a.patches[0] >= 0 && a.patches[1] >= 0 && !a.crease && !a.on_plane && !a.drawn);
    OutlineFairing fairing(rough.finished.source, may_move, [this](const Vector3& from, const Vector3& to) {
      return may_be_faired(from, to);
    });
    for (int step = 0; step < kMostFairings; ++step) {
      FinishedLayout moved = rough.finished;
      moved.source.points = moved.evaluation.position = fairing.places();
      Attempt fair = measure_->measured(std::move(moved), rough.evaluation);
      if (fair.good() && fair.uneven.worst() <= std::max(rough.uneven.worst(), 1.0)) return fair;
      const bool mended = fairing.hold_outlines(fair.invalid);
      if (!fairing.hold(measure_->points_beyond(fair)) && !fairing.hold_outlines(fair.too_far) && !mended)
        break;
    }
    return rough;
  }

  void take(const Attempt& found, const PatchLayout& layout) {
    const Attempt attempt = found.good() && !quick() ? with_fair_outlines(found) : found;
    result_.strips = attempt.strips, result_.distance = attempt.distance, result_.miss = attempt.miss;
    result_.notes.clear();
    if (params_.morph == MorphKind::kFull) take_full_morph(attempt, layout);
  }

  // The paper's morph instead of the reduced one; not for patches that it would spoil, which are found by
  // trying. Each try leaves more patches as they are, so the tries end.
  void take_full_morph(const Attempt& reduced, const PatchLayout& layout) {
    const auto n = static_cast<std::ptrdiff_t>(layout.patches.size());
    std::vector<char> keep(layout.patches.size(), 0);
    std::ptrdiff_t kept = 0;
    while (kept < n) {
      FinishedLayout moved = reduced.finished;
      moved.source.points =
          full_morph_places(lane_->surface, layout, moved.evaluation, reduced.evaluation, keep, context_);
      Attempt full = measure_->measured(std::move(moved), reduced.evaluation);
      const std::vector<char> spoilt = spoilt_patches(full, reduced);
      if (std::count(spoilt.begin(), spoilt.end(), 1) == 0) {
        result_.strips = std::move(full.strips), result_.distance = full.distance, result_.miss = full.miss;
        break;
      }
      for (std::size_t p = 0; p < keep.size(); ++p) keep[p] |= spoilt[p];
      const std::ptrdiff_t now = std::count(keep.begin(), keep.end(), 1);
      kept = now > kept ? now : n;  // what stays as it was is spoilt by its neighbours
    }
    if (kept == 0) return;
    result_.notes.push_back("the full morph shapes " + std::to_string(n - kept) + " of " + std::to_string(n) +
                            " parts; the others have the shape of the reduced morph, because the full one "
                            "breaks the tolerance or the flat layout there");
  }

  // Per patch: it breaks a promise in one attempt and not in the other.
  std::vector<char> spoilt_patches(const Attempt& now, const Attempt& before) const {
    std::vector<char> spoilt(now.strips.patches.size(), 0);
    for (int p : now.invalid) spoilt[p] = 1;
    for (int p : now.too_far)
      if (!std::binary_search(before.too_far.begin(), before.too_far.end(), p)) spoilt[p] = 1;
    if (!now.invalid.empty()) return spoilt;
    for (const Defect& d : check_structure(now.strips, nullptr, params_.evaluation.max_sides, 1.0)) {
      if (d.patch < 0) return std::vector<char>(spoilt.size(), 1);
      spoilt[d.patch] = 1;
    }
    return spoilt;
  }

  const ComponentInput& input_;
  ComponentParams params_;
  RunContext& context_;
  std::shared_ptr<const ClosestPointTree> own_tree_;
  const ClosestPointTree& tree_;
  std::unique_ptr<const AttemptMeasure> measure_;
  CurvatureField curvature_;
  CrossField field_;
  TracingGraph graph_;
  SearchSurface surface_;  // as the lanes start from it
  PathNetwork start_;
  std::deque<Lane> lanes_;
  Lane* lane_ = nullptr;  // the present one
  ComponentResult result_;
  Laps laps_;
};

// Sides of a plate thinner than the tolerance may have become one or changed places: finer parts part them.
ComponentResult kept_apart(ComponentResult result, const ComponentInput& input, const ClosestPointTree& tree,
                           ComponentParams params, RunContext& context) {
  const auto apart = [&](double least) {
    return (facing(result.strips, input.reference, tree) > least || !has_thickness(input.reference)) &&
           check_structure(result.strips, &input.prepared.mesh, params.evaluation.max_sides, 1.0, nullptr,
                           context)
               .empty();
  };
  for (std::size_t k = 0; !apart(kFacing); ++k) {
    if (k == kFiner.size()) {
      if (apart(0)) break;
      throw Error(ErrorCode::kInternal, "no strips keep the sides of a component apart");
    }
    const EvaluationCounts before = result.counts;
    ComponentRun(input, params, context)
        .run({kFiner[k] * params.evaluation.e_max},
             [&](std::size_t, const ComponentResult& r) { result = r; });
    result.counts += before;
    result.notes.push_back(kKeptApart);
  }
  return result;
}

}  // namespace

ComponentResult decompose_component(const ComponentInput& input, const ComponentParams& params,
                                    RunContext& context) {
  ComponentResult result;
  sweep_component(input, params, {params.evaluation.e_max}, context,
                  [&](std::size_t, ComponentResult r) { result = std::move(r); });
  return result;
}

void sweep_component(const ComponentInput& input, const ComponentParams& params,
                     const std::vector<double>& e_max, RunContext& context,
                     const std::function<void(std::size_t, ComponentResult)>& found) {
  ComponentParams own = params;
  ComponentRun run(input, params, context);
  run.run(e_max, [&](std::size_t k, const ComponentResult& result) {
    own.evaluation.e_max = e_max[k];
    found(k, kept_apart(result, input, run.tree(), own, context));
  });
}

}  // namespace sheetform
