// The local search: one more stretch in, other arches out.
#include <array>
#include <memory>
#include <optional>

#include "sheetform/search/layout_search.h"

namespace sheetform {
namespace {

// A change of the local search that keeps the number of parts may lengthen the cuts by this much (see
// objective()), so that the search can walk on.
constexpr double kPlateau = 0.03;

}  // namespace

LayoutSearch::LayoutSearch(const LayoutSearch& of, RunContext& context)
    : surface_(of.surface_),
      network_(of.network_),
      graph_(of.graph_),
      params_(of.params_),
      context_(context),
      distance_(graph_, 1.0),
      evaluator_(of.evaluator_),
      rules_(of.rules_),
      edge_length_(of.edge_length_),
      face_gauss_(of.face_gauss_),
      layout_(of.layout_),
      layout_valid_(of.layout_valid_),
      merge_values_(of.merge_values_),
      hopeless_(of.hopeless_),
      places_(of.places_),
      lost_(of.lost_) {}

// The stretch of a path inside one patch, from outline to outline; empty when the path does not cross it.
std::vector<int> LayoutSearch::stretch_inside(const Path& path, int patch) const {
  const std::vector<int> edges = network_.path_edges(path);
  const int n = static_cast<int>(edges.size()), m = static_cast<int>(path.vertices.size());
  auto inside = [&](int i) {
    const auto& edge = surface_.mesh.edges[edges[i]];
    return layout_.edge_arch[edges[i]] < 0 && layout_.face_patch[edge.f0] == patch;
  };
  auto on_network = [&](int i) {
    return network_degree(surface_.mesh, network_.network(), path.vertices[i % m]) > 0;
  };
  for (int start = 0; start < n; ++start) {
    if (!inside(start) || !on_network(start)) continue;
    std::vector<int> run;
    for (int i = start; i < start + n; ++i) {
      if (!path.loop && i >= n) return {};
      if (!inside(i % n)) return {};
      run.push_back(edges[i % n]);
      if (on_network(path.loop ? (i + 1) % m : i + 1)) return run;
    }
  }
  return {};
}

bool LayoutSearch::try_improve(const Proposal& proposal) {
  const std::vector<int> run = stretch_inside(*proposal.path, proposal.patch);
  const double before = objective();
  const std::size_t parts_before = layout_.patches.size();
  const std::vector<int> faces = layout_.patches[proposal.patch].faces;
  kept_path_ = network_.insert_edges(run, PathKind::kCut);
  changed();
  if (!viable_region(network_.network(), faces) || !region_fits(faces)) return false;
  // To look for darts also where there is a part too many brings none less (58 meshes of up to 13 parts, at 5
  // and 2 %) and takes 6 and 2 % more time.
  remove_arches();
  if (layout().patches.size() > parts_before) return false;
  leave_darts();
  const std::size_t parts = layout().patches.size();
  return parts < parts_before || (parts == parts_before && objective() < before + kPlateau);
}

// The layout of a trial becomes this one.
void LayoutSearch::adopt(LayoutSearch& trial) {
  network_ = std::move(trial.network_), places_ = std::move(trial.places_);
  layout_ = std::move(trial.layout_), layout_valid_ = trial.layout_valid_;
  evaluation_valid_ = false;
}

int LayoutSearch::improve(int tries, std::uint64_t seed) {
  int improved = 0;
  std::uint64_t state = seed * 6364136223846793005ull + 1442695040888963407ull;
  auto random = [&](std::size_t n) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<std::size_t>((state >> 33) % n);
  };
  // The smaller of two: small patches are the ones that their neighbours can take over.
  const auto propose = [&]() -> std::optional<Proposal> {
    const std::size_t n = layout().patches.size(), one = random(n), other = random(n);
    const int patch = static_cast<int>(layout_.patches[other].area < layout_.patches[one].area ? other : one);
    const std::size_t first = random(pool_.size());
    for (std::size_t k = 0; k < pool_.size(); ++k) {
      const Path& path = pool_[(first + k) % pool_.size()];
      if (stretch_inside(path, patch).size() >= 3) return Proposal{patch, &path};
    }
    return std::nullopt;
  };
  if (pool_.empty()) return 0;
  EditableNetwork best_network = network_;
  ArchPlaces best_places = places_;
  double best = objective();
  RunContext quiet = context_;
  quiet.progress = nullptr;
  // So many at once from the same layout, whatever the number of threads; the first that is good counts, and
  // those after it were never drawn.
  constexpr int kAtOnce = 8;
  for (int t = 0; t < tries;) {
    context_.report(Stage::kRemove, 0.7 + 0.3 * t / tries);
    const int n = std::min(kAtOnce, tries - t);
    std::array<std::optional<Proposal>, kAtOnce> proposals;
    std::array<std::uint64_t, kAtOnce> states{};
    for (int i = 0; i < n; ++i) proposals[i] = propose(), states[i] = state;
    std::array<std::unique_ptr<LayoutSearch>, kAtOnce> trials;
    const int good = first_of(context_, n, [&](int i) {
      if (!proposals[i]) return false;
      trials[i].reset(new LayoutSearch(*this, quiet));
      return trials[i]->try_improve(*proposals[i]);
    });
    for (const auto& trial : trials)
      if (trial) merge_values_.merge(trial->merge_values_);
    t += std::min(good + 1, n);
    if (good < n) adopt(*trials[good]), state = states[good];
    if (objective() < best - 1e-9) {
      best = objective(), best_network = network_, best_places = places_;
      ++improved;
    }
  }
  if (objective() > best) {
    network_ = std::move(best_network), places_ = std::move(best_places);
    changed();
  }
  return improved;
}

}  // namespace sheetform
