#include "sheetform/search/layout_search.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <set>

namespace sheetform {
namespace {

// Of a diagonal inside of a region where no seam is wanted: it may cost that many parts.
constexpr double kInsideCost = 100;

// Per face: the integral of the absolute Gaussian curvature.
std::vector<double> face_gauss(const SearchSurface& surface) {
  std::vector<double> gauss(surface.mesh.faces.size(), 0);
  if (surface.curvature == nullptr) return gauss;
  for (int f = 0; f < surface.mesh.face_count(); ++f) {
    for (int v : surface.mesh.faces[f])
      gauss[f] += std::abs(surface.curvature->k_max[v] * surface.curvature->k_min[v]) / 3;
    gauss[f] *= surface.mesh.face_normal_raw(f).norm() / 2;
  }
  return gauss;
}

// Multiple of the tolerance from which what is to be one patch is taken for hopeless, and with it all that it
// is part of later: right in half of the merges that fail, wrong in 2 % of those that would do.
constexpr double kHopeless = 1.1;

LayoutRules layout_rules(const EvaluationParams& params) {
  return {params.self_seams, params.self_seams && params.t_junctions};
}

}  // namespace

LayoutSearch::LayoutSearch(SearchSurface& surface, PathNetwork start, const TracingGraph& graph,
                           std::vector<Path> candidates, const SearchParams& params, RunContext& context)
    : surface_(surface),
      network_(surface.mesh, std::move(start)),
      graph_(graph),
      candidates_(candidates),
      pool_(std::move(candidates)),
      params_(params),
      context_(context),
      distance_(graph, 1.0),
      evaluator_(std::make_shared<LayoutEvaluator>(surface_, params_.evaluation, context)),
      rules_(layout_rules(params.evaluation)),
      edge_length_(mean_edge_length(surface.mesh)),
      rest_(shape()),
      face_gauss_(std::make_shared<const std::vector<double>>(face_gauss(surface))) {}

LayoutSearch::LayoutSearch(LayoutSearch& before, PathNetwork start, DetailPoints details,
                           const SearchParams& params)
    : surface_(before.surface_),
      network_(surface_.mesh, std::move(start)),
      graph_(before.graph_),
      candidates_(before.pool_),
      pool_(before.pool_),
      params_(params),
      context_(before.context_),
      distance_(graph_, 1.0),
      evaluator_(
          std::make_shared<LayoutEvaluator>(surface_, params_.evaluation, context_, before.evaluator_.get())),
      rules_(layout_rules(params.evaluation)),
      edge_length_(before.edge_length_),
      last_version_(before.last_version_),
      rest_(before.rest_),
      face_gauss_(before.face_gauss_) {
  rest_.details = std::move(details);
  take_shape(rest_);
  surface_.straight.clear();
}

const PatchLayout& LayoutSearch::layout() {
  if (layout_valid_) return layout_;  // nothing is written then: several threads may ask
  layout_ = extract_layout(surface_.mesh, network_.network(), surface_.versions, rules_, std::move(layout_));
  layout_valid_ = true;
  return layout_;
}

const LayoutEvaluation& LayoutSearch::evaluation() {
  if (evaluation_valid_) return evaluation_;
  evaluation_ = evaluator_->layout(layout(), params_.lawson_rounds);
  evaluation_valid_ = true;
  return evaluation_;
}

// Corners by the paths that meet, without a chart.
int LayoutSearch::combinatorial_corners(const Patch& patch) const {
  int corners = 0;
  const std::size_t n = patch.boundary.size();
  for (std::size_t i = 0; i < n; ++i) {
    const int a = layout_.arches[patch.boundary[i].arch].path,
              b = layout_.arches[patch.boundary[(i + 1) % n].arch].path;
    corners += a != b;
  }
  return corners;
}

std::vector<int> LayoutSearch::topologically_bad() {
  std::vector<int> bad;
  for (int p = 0; p < static_cast<int>(layout().patches.size()); ++p) {
    const Patch& patch = layout_.patches[p];
    if (patch.defect != TopologyDefect::kNone ||
        (paths_share_corners() && combinatorial_corners(patch) > params_.evaluation.max_sides))
      bad.push_back(p);
  }
  return bad;
}

// How much the path is worth to the patch: its distance to parallel paths inside of it, weighted by how
// squarely it crosses the direction of least curvature (method.md 13.4). 0 when it does not run through the
// patch.
double LayoutSearch::priority(const Path& path, int patch) const {
  double sum = 0;
  int count = 0;
  const std::size_t n = path.vertices.size();
  for (std::size_t i = 0; i + 1 < n + (path.loop ? 1 : 0); ++i) {
    const int v = path.vertices[i], w = path.vertices[(i + 1) % n];
    const int e = surface_.mesh.find_edge(v, w);
    const auto& edge = surface_.mesh.edges[e];
    if (edge.border() || layout_.face_patch[edge.f0] != patch || layout_.face_patch[edge.f1] != patch)
      continue;
    const Vector3 direction = (surface_.mesh.points[w] - surface_.mesh.points[v]).normalized();
    const double along = surface_.guide.ruling_direction[edge.f0].dot(direction);
    const double crossing = 1 - surface_.guide.strength[edge.f0] * along * along;
    sum += std::min(distance_.at(TracingGraph::node(v, path.dirs[i])), 1.0) * (0.4 + 0.6 * crossing);
    ++count;
  }
  return count == 0 ? 0 : sum / count;
}

// Inserts the best fitting candidate for each bad patch that has not been cut in this round; false if none
// was found.
bool LayoutSearch::insert_best(const std::vector<int>& bad) {
  // Candidates that touch what is there are dropped for good; those too near to a parallel one as well.
  std::vector<Path> kept;
  for (Path& c : candidates_)
    if (network_.fits(c) && distance_.mean(c) > params_.min_spacing_edges * edge_length_)
      kept.push_back(std::move(c));
  candidates_ = std::move(kept);
  layout();
  struct Choice {
    double value;
    std::size_t candidate;
  };
  std::vector<Choice> choices;
  for (int p : bad) {
    Choice best{0, 0};
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      const double value = priority(candidates_[c], p);
      if (value > best.value) best = {value, c};
    }
    if (best.value > 0) choices.push_back(best);
  }
  if (choices.empty()) return false;
  std::sort(choices.begin(), choices.end(), [](const Choice& a, const Choice& b) {
    return a.value != b.value ? a.value > b.value : a.candidate < b.candidate;
  });
  std::vector<Path> round;
  std::set<std::size_t> seen;
  for (const Choice& c : choices)
    if (seen.insert(c.candidate).second) round.push_back(candidates_[c.candidate]);
  for (const Path& path : round) {
    if (!network_.fits(path) || distance_.mean(path) <= params_.min_spacing_edges * edge_length_) continue;
    network_.insert(path, PathKind::kTraced);
    distance_.add(path);
  }
  changed();
  return true;
}

int LayoutSearch::split(const std::vector<int>& patches, PatchVerdict reason, double least_share) {
  int done = 0;
  const PatchLayout before = layout();
  for (int p : patches) {
    const auto known = evaluator_->patch(before, p);
    PatchEvaluation asked = *known;
    if (known->viable() || known->verdict == PatchVerdict::kError) asked.verdict = reason;
    const std::vector<int> edges = split_around(before, p, asked, least_share);
    if (edges.empty()) continue;
    network_.insert_edges(edges, PathKind::kCut);
    ++done;
  }
  if (done > 0) changed();
  return done;
}

int LayoutSearch::give_away(const std::vector<int>& patches) {
  int done = 0;
  const PatchLayout before = layout();
  for (int p : patches) {
    std::vector<int> longest;
    double length = 0;
    for (const ArchUse& use : before.patches[p].boundary) {
      const Arch& arch = before.arches[use.arch];
      if (arch.left < 0 || arch.right < 0 || arch.length <= length ||
          !network_.network().used(arch.edges[0]) || is_held(network_.network().kinds[arch.path]))
        continue;
      const std::vector<int> edges = with_loose_ends(arch.edges);
      if (!edges.empty()) longest = edges, length = arch.length;
    }
    if (longest.empty()) continue;
    network_.remove_edges(longest);
    ++done;
  }
  if (done > 0) changed(), places_.clear();
  return done;
}

void LayoutSearch::insert() {
  for (int round = 0; round < 200; ++round) {
    context_.report(Stage::kInsert, 0.3 * round / (round + 10.0));
    const std::vector<int> bad = topologically_bad();
    if (bad.empty()) break;
    if (!insert_best(bad) && split(bad, PatchVerdict::kTooManySides) == 0) break;
  }
  settle();
}

// Smoothing shifts the outlines a little, so what fitted before is looked at again.
void LayoutSearch::settle() {
  for (int pass = 0; pass < 4; ++pass) {
    smooth();
    if (insert_for_geometry() == 0) break;
  }
}

void LayoutSearch::reject(const std::vector<int>& patches) {
  for (int p : patches) evaluator_->reject(layout().patches[p]);
}

// Those of these patches whose only fault are their corners.
std::vector<int> LayoutSearch::with_corners_to_share(const std::vector<int>& patches) {
  std::vector<int> some;
  for (int p : patches)
    if (evaluator_->patch(layout(), p)->verdict == PatchVerdict::kTooManySides) some.push_back(p);
  return some;
}

// Patches that break a rule alone, or, when none does, in the global morph.
std::vector<int> LayoutSearch::geometrically_bad() {
  std::vector<int> bad;
  const auto evaluations = evaluator_->patches(layout());
  for (int p = 0; p < static_cast<int>(evaluations.size()); ++p)
    if (!evaluations[p]->viable()) bad.push_back(p);
  if (!bad.empty()) return bad;
  const LayoutEvaluation& e = evaluation();
  for (int p = 0; p < static_cast<int>(e.patch_error.size()); ++p)
    if (e.patch_error[p] > params_.evaluation.e_max) bad.push_back(p);
  return bad;
}

// Returns the number of rounds in which something was inserted.
int LayoutSearch::insert_for_geometry() {
  int last_failing = 1 << 30, stuck = 0;
  for (int round = 0; round < 60; ++round) {
    context_.report(Stage::kInsert, 0.3 + 0.7 * round / (round + 6.0));
    const std::vector<int> bad = geometrically_bad();
    if (bad.empty()) return round;
    stuck = static_cast<int>(bad.size()) < last_failing ? 0 : stuck + 1;
    last_failing = static_cast<int>(bad.size());
    if (!paths_share_corners() && split(with_corners_to_share(bad), PatchVerdict::kTooManySides) > 0)
      continue;
    if (stuck < 8 && insert_best(bad)) continue;
    if (split(bad, PatchVerdict::kError) == 0) return round;
  }
  return 60;
}

// The patches on either side of these edges.
std::vector<int> LayoutSearch::patches_beside(const std::vector<int>& edges) {
  std::set<int> beside;
  for (int e : edges)
    for (int f : {surface_.mesh.edges[e].f0, surface_.mesh.edges[e].f1})
      if (f >= 0) beside.insert(layout().face_patch[f]);
  return {beside.begin(), beside.end()};
}

std::vector<int> LayoutSearch::faces_of(const std::vector<int>& patches) const {
  std::vector<int> faces;
  for (int p : patches) {
    const auto middle = static_cast<std::ptrdiff_t>(faces.size());
    faces.insert(faces.end(), layout_.patches[p].faces.begin(), layout_.patches[p].faces.end());
    std::inplace_merge(faces.begin(), faces.begin() + middle, faces.end());
  }
  return faces;
}

// Its integral of |Gaussian curvature|.
double LayoutSearch::gauss_of(const Patch& patch) const {
  double gauss = 0;
  for (int f : patch.faces) gauss += (*face_gauss_)[f];
  return gauss;
}

bool LayoutSearch::too_round(const PatchLayout& layout, const Patch& patch) const {
  double outline = 0;
  for (const ArchUse& use : patch.boundary) outline += layout.arches[use.arch].length;
  return too_round(patch.area, outline, gauss_of(patch));
}

// What the region becomes under another network, when all of its patches are viable alone. The largest is
// looked at first: it is the one that fails.
std::optional<RegionFit> LayoutSearch::viable_region(const PathNetwork& trial, const std::vector<int>& faces,
                                                     std::vector<int>* hopeless) {
  const PatchLayout region = extract_region(surface_.mesh, trial, surface_.versions, rules_, faces);
  RegionFit fit;
  fit.patches = static_cast<int>(region.patches.size());
  if (fit.patches == 0) return fit;  // of no faces
  int largest = 0;
  for (int p = 0; p < fit.patches; ++p) {
    const Patch& patch = region.patches[p];
    if (patch.defect != TopologyDefect::kNone) return std::nullopt;
    if (hopeless != nullptr &&
        (too_round(region, patch) || covers_hopeless([&](int face) { return region.face_patch[face] == p; })))
      return std::nullopt;
    if (patch.area > region.patches[largest].area) largest = p;
  }
  std::vector<std::shared_ptr<const PatchEvaluation>> patches(region.patches.size());
  std::atomic<bool> viable{true};
  std::vector<int> open;
  for (int p = 0; p < fit.patches; ++p) {
    if (!(patches[p] = evaluator_->known(region.patches[p])))
      open.push_back(p);
    else if (!patches[p]->viable())
      viable = false;
  }
  std::stable_partition(open.begin(), open.end(), [&](int p) { return p == largest; });
  parallel_for(context_, static_cast<int>(open.size()), [&](int i) {
    const int p = open[i];
    if (p != largest && !viable) return;  // the largest is looked at in any case, so that it is told the same
    patches[p] = evaluator_->patch(region, p);
    if (!patches[p]->viable()) viable = false;
  });
  if (const PatchEvaluation& e = *patches[largest]; hopeless != nullptr &&
                                                    e.verdict == PatchVerdict::kError &&
                                                    e.error > kHopeless * params_.evaluation.e_max)
    *hopeless = region.patches[largest].faces;
  if (!viable) return std::nullopt;
  for (const auto& e : patches) {
    fit.error = std::max(fit.error, e->error / params_.evaluation.e_max);
    fit.sides = std::max(fit.sides, static_cast<int>(e->corners.size()));
    fit.misalignment = std::max(fit.misalignment, e->rulings.misalignment);
  }
  return fit;
}

// Whether something that was far from being one patch lies inside of these faces.
bool LayoutSearch::covers_hopeless(const std::function<bool(int)>& has) const {
  return std::any_of(hopeless_.begin(), hopeless_.end(), [&](const Faces& faces) {
    return has(faces->front()) && has(faces->back()) && std::all_of(faces->begin(), faces->end(), has);
  });
}

void LayoutSearch::remember_hopeless(std::vector<std::vector<int>> found) {
  for (std::vector<int>& faces : found)
    if (!faces.empty()) hopeless_.push_back(std::make_shared<const std::vector<int>>(std::move(faces)));
}

// Where a network is another one over these faces: morphs the new patches with their neighbours, the rest
// held; nothing where one of them has no strips that stay within e_max, but for those that had none before.
// Thread-safe.
std::optional<LayoutSearch::Fitted> LayoutSearch::fitted(const PathNetwork& network,
                                                         const std::vector<int>& faces, double slack) {
  Fitted fit;
  fit.layout = extract_region(surface_.mesh, network, surface_.versions, rules_,
                              with_neighbours(surface_.mesh, network, faces));
  fit.evaluation = evaluator_->solve_region(fit.layout, places_, params_.lawson_rounds);
  const LayoutEvaluation& e = fit.evaluation;
  if (e.max_error > slack * params_.evaluation.e_max) return std::nullopt;
  for (std::size_t p = 0; p < e.patches.size(); ++p)
    if (!e.patches[p]->has_valid_strips() && lost_.count(fit.layout.patches[p].key) == 0) return std::nullopt;
  return fit;
}

// The same of the network as it is now; the places are stored.
bool LayoutSearch::region_fits(const std::vector<int>& faces, double slack) {
  const std::optional<Fitted> fit = fitted(network_.network(), faces, slack);
  if (fit) store(fit->layout, fit->evaluation);
  return fit.has_value();
}

void LayoutSearch::store(const PatchLayout& layout, const LayoutEvaluation& e) {
  for (std::size_t a = 0; a < e.arch_unknowns.size(); ++a) {
    if (e.arch_unknowns[a].empty()) continue;
    auto& places = places_[layout.arches[a].key];
    places.clear();
    for (int u : e.arch_unknowns[a]) places.push_back(e.position[u]);
  }
}

void LayoutSearch::have_places() {
  if (!places_.empty()) return;
  const LayoutEvaluation& e = evaluation();
  store(layout_, e);
}

double LayoutSearch::cut_length() {
  double length = 0;
  for (const Arch& a : layout().arches)
    if (a.left >= 0 && a.right >= 0) length += a.length;
  return length;
}

// Parts first, then the length of the cuts.
double LayoutSearch::objective() {
  return static_cast<double>(layout().patches.size()) + 0.08 * cut_length() + kInsideCost * length_inside();
}

}  // namespace sheetform
