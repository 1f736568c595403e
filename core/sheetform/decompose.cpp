#include "sheetform/decompose.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <tuple>

#include "sheetform/guided.h"
#include "sheetform/mesh/embed_strokes.h"
#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/mesh/place_text.h"
#include "sheetform/mesh/working_mesh.h"
#include "sheetform/progress.h"
#include "sheetform/search/component.h"
#include "sheetform/strip/assemble.h"
#include "sheetform/strip/close_points.h"
#include "sheetform/strip/mirror.h"
#include "sheetform/sweep.h"

namespace sheetform {
namespace {

// The similarity that puts the input's bounding box to diagonal 1 around the origin.
struct Normalisation {
  Vector3 centre = Vector3::Zero();
  double diagonal = 1, longest = 1;
  Vector3 in(const Vector3& p) const { return (p - centre) / diagonal; }
  Vector3 out(const Vector3& p) const { return p * diagonal + centre; }
};

Normalisation normalisation(const std::vector<Vector3>& points) {
  Normalisation n;
  Vector3 lo = points.front(), hi = lo;
  for (const Vector3& p : points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  n.centre = (lo + hi) / 2;
  n.diagonal = (hi - lo).norm();
  n.longest = (hi - lo).maxCoeff();
  return n;
}

[[noreturn]] void refuse(const std::string& what, const std::string& where, const std::string& fix) {
  throw Error(ErrorCode::kInvalidParameter, what, where, fix);
}

void require(bool ok, const std::string& name, const std::string& range) {
  if (!ok) refuse(name + " must be " + range, name, "choose a value in this range");
}

// The faces of one component.
TriangleSoup component_soup(const SurfaceMesh& mesh, const std::vector<int>& component, int id,
                            const RunContext& context) {
  context.checkpoint();
  std::vector<int> local(mesh.points.size(), -1);
  TriangleSoup soup;
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (component[f] != id) continue;
    std::array<int, 3> t{};
    for (int k = 0; k < 3; ++k) {
      int& v = local[mesh.faces[f][k]];
      if (v < 0)
        v = static_cast<int>(soup.points.size()), soup.points.push_back(mesh.points[mesh.faces[f][k]]);
      t[k] = v;
    }
    soup.faces.push_back(t);
  }
  context.checkpoint();
  return soup;
}

constexpr double kFinestSpacing = 0.002;    // of the diagonal: finer outlines would take too long
constexpr double kSpacingSlack = 1 + 1e-9;  // rounding of the units
// Of the tolerance: so far a mesh may be from its likeness in a given plane. Sheets between one side and the
// image of the other are near enough to both up to twice the tolerance, but something has to be left to them.
constexpr double kAsymmetry = 1.6;
// Lengths that do not follow the tolerance, as that between outline points, are meant for objects of about
// the input's size. A component smaller than kLeastSize (in diagonals of the input) has shorter ones, and may
// be off by no more than kMostReach of its own diagonal: beyond that it would keep neither shape nor outside.
constexpr double kLeastSize = 0.2, kMostReach = 0.1;
// How far seams may end up from where they were drawn, besides the tolerance, in diagonals.
constexpr double kDrawnSlack = 0.005;

// The user's directions, carried to the prepared mesh by closest points.
std::vector<Vector3> carry_guide(const UserField& field, const TriangleSoup& soup,
                                 const ClosestPointTree& tree, const SurfaceMesh& mesh) {
  std::vector<Vector3> guide(mesh.points.size(), Vector3::Zero());
  for (std::size_t v = 0; v < guide.size(); ++v) {
    const ClosestPoint hit = tree.closest(mesh.points[v]);
    if (!field.per_face.empty()) {
      guide[v] = field.per_face[hit.face];
      continue;
    }
    // Crosses must not be averaged: the nearest corner's direction is taken.
    int k = 0;
    hit.barycentric.maxCoeff(&k);
    guide[v] = field.per_vertex[soup.faces[hit.face][k]];
  }
  return guide;
}

// One way of running the search. `mesh`: whose working mesh it takes.
struct Variant {
  Effort mesh;
  std::vector<int> seeds;
  int improvements, improvements_of_many;
  std::uint64_t seed_offset;
  double aim = ComponentParams().aim;
};

// What the others of thorough take for fitting: the last passes keep most of it, and split the rest. 28
// meshes take 213 parts at 1 % and 136 at 2 % instead of 232 and 138, in as much time; 1.08 brings no more.
constexpr double kBeyond = 1.04;

const Variant kNormalVariant{Effort::kNormal, {60, 200}, 8, 0, 0};

// The first variant of thorough is normal itself, so that thorough is never worse.
std::vector<Variant> variants(Effort effort) {
  switch (effort) {
    case Effort::kDraft:
      return {{Effort::kDraft, {60}, 0, 0, 0}};
    case Effort::kNormal:
      return {kNormalVariant};
    case Effort::kThorough:
      break;
  }
  return {kNormalVariant,
          {Effort::kDraft, {60}, 300, 150, 1, kBeyond},
          {Effort::kNormal, {200}, 300, 150, 2, kBeyond},
          {Effort::kNormal, {400}, 300, 150, 3, kBeyond}};
}

// size: of the component, in diagonals of the input.
ComponentParams component_params(const DecomposeParams& params, double e_max, const SpacingBounds& spacing,
                                 const Variant& variant, double size) {
  ComponentParams c;
  const double shorter = std::min(1.0, size / kLeastSize);
  c.evaluation.spacing *= shorter;
  c.fine_spacing *= shorter;
  c.evaluation.e_max = e_max;
  c.evaluation.max_sides = params.max_sides;
  c.evaluation.self_seams = params.self_seams;
  c.evaluation.t_junctions = params.t_junctions;
  c.evaluation.normal_deviation = params.normal_deviation.value_or(0);
  c.spacing = spacing;
  c.morph = params.morph;
  c.seeds = variant.seeds;
  c.improvements = variant.improvements;
  c.improvements_of_many = variant.improvements_of_many;
  c.aim = variant.aim;
  c.seed = params.seed + variant.seed_offset;
  return c;
}

double cut_length(const StripMesh& strips, const Normalisation& norm, bool border) {
  double sum = 0;
  for (const StripMesh::Arch& a : strips.arches) {
    if ((a.patches[1] < 0) != border) continue;
    for (std::size_t i = 0; i + 1 < a.vertices.size(); ++i)
      sum += (strips.points[a.vertices[i + 1]] - strips.points[a.vertices[i]]).norm();
  }
  return sum / norm.diagonal;
}

// What makes one result better than another: the tolerance met (or missed by less), fewer parts, shorter
// cuts.
std::tuple<double, std::size_t, double> rank(const ComponentResult& r) {
  return {std::max(r.miss - 1, 0.0), r.strips.patches.size(), cut_length(r.strips, {}, false)};
}

std::string percent(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f %%", 100 * x);
  return text;
}

void fill_report(Decomposition& d, const Normalisation& norm, double e_max) {
  Report& r = d.report;
  const DistanceReport& distance = d.certificate.distance;
  r.patches = static_cast<int>(d.strips.patches.size());
  r.hausdorff = distance.hausdorff() / norm.diagonal;
  r.hausdorff_at_most = distance.at_most / norm.diagonal;
  r.mean_distance = distance.mean / norm.diagonal;
  r.e_max_met = r.hausdorff <= e_max;
  r.isometry_error = d.certificate.isometry_error;
  r.worst_place = distance.worst_place;
  r.cut_length = cut_length(d.strips, norm, false);
  r.border_length = cut_length(d.strips, norm, true);
  for (const AuditFinding& f : d.audit.findings) r.notes.push_back(f.text);
  if (!r.e_max_met)
    r.notes.push_back("the tolerance of " + percent(e_max) + " is not met: the distance is " +
                      percent(r.hausdorff) + " at " + text_of(r.worst_place));
}

void report_normals(Decomposition& d) {
  Report& r = d.report;
  const NormalReport& normals = d.certificate.normals;
  r.normal_mean = normals.mean;
  r.normal_deviation = normals.quantile;
  r.normal_worst_place = normals.worst_place;
  r.normal_deviation_met = !d.params.normal_deviation || normals.quantile <= *d.params.normal_deviation;
  if (r.normal_deviation_met) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "the normal deviation of %g degrees is not met: 95 %% of the area keep to %.1f degrees; the "
                "worst part deviates by %.1f degrees at ",
                *d.params.normal_deviation, normals.quantile, normals.worst);
  r.notes.push_back(text + text_of(normals.worst_place));
}

void report_bending(Decomposition& d) {
  Report& r = d.report;
  r.bending = measure_bending(d.strips, d.params.scale, d.params.min_bend_radius);
  r.min_bend_radius_met = !d.params.min_bend_radius || r.bending.smallest >= *d.params.min_bend_radius;
  if (!r.min_bend_radius_met)
    r.notes.push_back(too_sharp(r.bending, d.strips, *d.params.min_bend_radius) +
                      "; the sharpest bend is at " + text_of(r.bending.place));
}

// The bounds of the rulings' distances, in diagonals.
SpacingBounds spacing_bounds(const DecomposeParams& params, const Normalisation& norm) {
  const double unit = params.scale * norm.diagonal;
  SpacingBounds bounds;
  if (params.ruling_spacing_min) bounds.least = *params.ruling_spacing_min / unit;
  if (params.ruling_spacing_max) bounds.most = *params.ruling_spacing_max / unit;
  return bounds;
}

void report_spacing(Decomposition& d, const Normalisation& norm) {
  d.report.spacing = measure_spacing(d.strips, d.params.scale);
  const double unit = d.params.scale * norm.diagonal;
  SpacingBounds bounds = spacing_bounds(d.params, norm);
  bounds.least *= norm.diagonal, bounds.most *= norm.diagonal;
  const SpacingMiss miss = spacing_miss(d.strips, bounds);
  const auto tell = [&](const char* which, double wanted, double found, const Vector3& place) {
    char text[160];
    std::snprintf(text, sizeof text, "%s of %g mm is not kept: ends of rulings are %.4g mm apart at ", which,
                  wanted, found);
    d.report.notes.push_back(text + text_of(place));
  };
  if (miss.over > kSpacingSlack)
    tell("the largest ruling spacing", *d.params.ruling_spacing_max,
         miss.over * bounds.most / norm.diagonal * unit, miss.over_place);
  if (miss.under > kSpacingSlack)
    tell("the smallest ruling spacing", *d.params.ruling_spacing_min,
         bounds.least / miss.under / norm.diagonal * unit, miss.under_place);
}

// Lengths resolved: scale and e_max as they are in force.
DecomposeParams resolved(DecomposeParams params, const Normalisation& norm) {
  if (params.target_size) params.scale = *params.target_size / norm.longest;
  if (params.e_max_mm) params.e_max = *params.e_max_mm / (params.scale * norm.diagonal);
  require(params.e_max > 0 && params.e_max <= 0.5, params.e_max_mm ? "e_max_mm" : "e_max",
          "above 0 and at most half of the bounding-box diagonal");
  const SpacingBounds spacing = spacing_bounds(params, norm);
  if (spacing.most < kFinestSpacing) {
    char text[80];
    std::snprintf(text, sizeof text, "at least 0.2 %% of the bounding-box diagonal: %.3g mm here",
                  kFinestSpacing * params.scale * norm.diagonal);
    require(false, "ruling_spacing_max", text);
  }
  return params;
}

// The half to be solved when symmetry is asked for and there is one; notes in the report say what was found.
std::optional<SymmetricHalf> half_to_solve(const SurfaceMesh& mesh, const Normalisation& norm,
                                           Decomposition& d, RunContext& context) {
  if (d.params.symmetry == SymmetryMode::kOff) return std::nullopt;
  std::optional<SymmetricHalf> half;
  if (d.params.symmetry == SymmetryMode::kAuto) {
    half = find_symmetric_half(mesh, d.params.e_max, context);
    if (!half)
      d.report.notes.push_back("no plane of symmetry was found, so the mesh was decomposed as a whole");
  } else {
    const Plane& given = d.params.plane;
    const Plane plane{given.normal, (given.offset - given.normal.dot(norm.centre)) / norm.diagonal};
    Asymmetry why;
    half = symmetric_half(mesh, plane, kAsymmetry * d.params.e_max, 0.05 * d.params.e_max, why);
    if (!half)
      throw Error(
          ErrorCode::kUnsupportedMesh, "the mesh is not symmetric in the given plane: " + why.text,
          why.place ? "symmetry, at " + text_of(norm.centre + norm.diagonal * *why.place) : "symmetry",
          "give another plane, a larger e_max, or use auto");
  }
  if (!half) return half;
  const Plane& plane = half->plane;
  d.params.plane = {plane.normal, plane.offset * norm.diagonal + plane.normal.dot(norm.centre)};
  d.mirror_plane = d.params.plane;
  if (half->deviation > 0.01 * d.params.e_max)
    d.report.notes.push_back("the input deviates from a symmetric one by " + percent(half->deviation) +
                             " of the diagonal; the result is exactly symmetric" +
                             (half->deviation > d.params.e_max
                                  ? ", between the two sides, and without symmetry fewer parts may do"
                                  : ""));
  return half;
}

// The run over one input for several tolerances.
class Sweep {
 public:
  Sweep(const InputMesh& input, const DecomposeParams& params, const UserField* field,
        const UserGuides* guides, RunContext& context, std::function<void(const Decomposition&)> found = {})
      : input_(input),
        params_(params),
        field_(field),
        guides_(guides),
        context_(context),
        found_(std::move(found)) {
    keep_threads(context_);
  }

  // e_max: ascending; empty = the one of the parameters.
  std::vector<Decomposition> run(std::vector<double> e_max) {
    const auto start = Clock::now();
    prepare();
    common_.report.timings["prepare"] = seconds_since(start);
    if (e_max.empty()) e_max = {common_.params.e_max};
    std::vector<Decomposition> results;
    for (double e : e_max) {
      results.push_back(common_);
      results.back().params.e_max = e;
      if (results.size() > 1) results.back().report.timings["prepare"] = 0;
    }
    decompose_components(results);
    return results;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds_since(Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  }

  // One component of the mesh and what has been found for it.
  struct Piece {
    int index;
    SurfaceMesh mesh;
    const ComponentGuides& guides;
    double size;  // its own diagonal
    std::shared_ptr<const ClosestPointTree> tree;
    TriangleSoup whole;  // of a half: see ComponentInput
    std::shared_ptr<const ClosestPointTree> whole_tree;
    struct Found {  // by tolerance
      ComponentResult best;
      std::map<std::string, double> seconds;  // by stage, of all tries
      EvaluationCounts counts;
    };
    std::vector<Found> found;
    bool streams = false;      // every tolerance is finished as soon as it can be: all others are there
    std::size_t finished = 0;  // so many tolerances have their strips
    bool finishing = false;    // what is thrown now is no matter of the search
  };

  // What all tolerances share; the parameters' own is the finest.
  void prepare() {
    common_.input_vertices = static_cast<int>(input_.soup.points.size());
    common_.input_faces = static_cast<int>(input_.soup.faces.size());
    context_.report(Stage::kPrepare, 0);
    repaired_ = repair(input_.soup, context_);
    common_.audit = std::move(repaired_.audit);
    norm_ = normalisation(repaired_.mesh.points);
    common_.params = resolved(params_, norm_);
    common_.bbox_diagonal = norm_.diagonal;
    context_.checkpoint();
    mesh_ = repaired_.mesh;
    for (Vector3& p : mesh_.points) p = norm_.in(p);
    half_ = half_to_solve(mesh_, norm_, common_, context_);
    if (half_) take_half();
    if (guides_ != nullptr && !guides_->empty()) prepare_guides();
    if (field_ != nullptr) prepare_field();
  }

  void take_half() {
    whole_ = std::move(mesh_);
    for (Vector3& p : whole_.points) p = half_->frame.in(p);
    mesh_ = half_->mesh;
  }

  // Strokes in the coordinates of mesh_.
  void prepare_guides() {
    check_guides(*guides_, {repaired_.mesh.points, repaired_.mesh.faces}, context_);
    common_.guides = *guides_;
    UserGuides placed = *guides_;
    const auto place = [&](std::vector<Vector3>& points) {
      for (Vector3& p : points) p = half_ ? half_->frame.in(norm_.in(p)) : norm_.in(p);
    };
    for (SeamStroke& s : placed.seams) place(s.points);
    for (BrushStroke& b : placed.keep_out) place(b.points), b.radius /= norm_.diagonal;
    strokes_ = half_ ? folded(placed) : unfolded(placed);
    followed_.assign(placed.seams.size(), 0);
    common_.report.notes.push_back("the user's guides are followed: " + std::to_string(placed.seams.size()) +
                                   " seams, " + std::to_string(placed.keep_out.size()) +
                                   " regions to keep free" +
                                   (half_ ? "; each is mirrored in the plane of symmetry as well" : ""));
  }

  void prepare_field() {
    require(field_->per_face.empty() ? field_->per_vertex.size() == input_.soup.points.size()
                                     : field_->per_face.size() == input_.soup.faces.size(),
            "field", "one direction for each vertex or face of the mesh");
    common_.report.notes.push_back("the user's field replaces the computed one: a direction for each " +
                                   std::string(field_->per_face.empty() ? "vertex" : "face"));
    user_soup_ = input_.soup;
    for (Vector3& p : user_soup_.points) p = half_ ? half_->frame.in(norm_.in(p)) : norm_.in(p);
    user_tree_ = ClosestPointTree(user_soup_.points, user_soup_.faces, context_);
  }

  static double small_enough(double e_max, const Piece& piece) {
    return piece.size < kLeastSize ? std::min(e_max, kMostReach * piece.size) : e_max;
  }

  ComponentInput component_input(const Piece& piece, const Variant& variant, const RunContext& context) {
    ComponentInput input;
    input.prepared = working_mesh(piece.mesh, *piece.tree,
                                  {small_enough(common_.params.e_max, piece), common_.params.crease_angle,
                                   variant.mesh == Effort::kDraft},
                                  context);
    take_guides(piece.guides, input, context);
    input.reference = {piece.mesh.points, piece.mesh.faces};
    input.tree = piece.tree;
    input.half = half_.has_value();
    input.whole = piece.whole, input.whole_tree = piece.whole_tree;
    if (field_ == nullptr) return input;
    input.guide = carry_guide(*field_, user_soup_, user_tree_, input.prepared.mesh);
    if (half_)
      for (Vector3& direction : input.guide) direction = half_->frame.axes * direction;
    return input;
  }

  void take_guides(const ComponentGuides& drawn, ComponentInput& input, const RunContext& context) {
    if (!drawn.guides.seams.empty()) {
      EmbeddedStrokes embedded = embed_strokes(input.prepared, drawn.guides.seams, context);
      input.prepared = std::move(embedded.prepared);
      input.drawn_edge = std::move(embedded.drawn_edge);
      if (half_) input.drawn_plane = drawn_on_plane(input.prepared.mesh, drawn.guides.seams);
      const std::vector<int>& out = embedded.left_out;
      const std::lock_guard lock(followed_mutex_);
      for (int i = 0; i < static_cast<int>(drawn.seam.size()); ++i)
        if (!std::binary_search(out.begin(), out.end(), i)) followed_[drawn.seam[i]] = 1;
    }
    const SurfaceMesh& mesh = input.prepared.mesh;
    input.keep_out = KeepOut(mesh, drawn.guides.keep_out, mean_edge_length(mesh), context);
  }

  // All components side by side. Of a sweep all but the last: it then takes the tolerances to their ends, one
  // by one.
  void decompose_components(std::vector<Decomposition>& results) {
    const auto [component, number] = face_components(mesh_);
    const int count = number;
    const std::vector<ComponentGuides> guides = guides_by_component(strokes_, mesh_, component, count);
    std::vector<int> half_of;  // by face of the whole
    if (half_) half_of = halves_of_whole(whole_, mesh_, component, count);
    const auto piece_of = [&, &component = component](int c, const RunContext& context) {
      TriangleSoup soup = component_soup(mesh_, component, c, context);
      SurfaceMesh mesh = build_surface_mesh(std::move(soup.points), std::move(soup.faces));
      const double size = bounding_box_diagonal(mesh.points);
      Piece piece{c, std::move(mesh), guides[c], size, {}, {}, {}, {}};
      piece.tree = std::make_shared<const ClosestPointTree>(piece.mesh.points, piece.mesh.faces, context);
      if (half_) {
        piece.whole = component_soup(whole_, half_of, c, context);
        piece.whole_tree =
            std::make_shared<const ClosestPointTree>(piece.whole.points, piece.whole.faces, context);
      }
      return piece;
    };
    const int together = results.size() > 1 ? count - 1 : count;
    std::vector<int> faces(count, 0), order(together);
    for (int c : component) ++faces[c];
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return faces[a] > faces[b]; });
    std::vector<std::vector<Piece::Found>> found(together);
    const double share = 0.9 / count;
    SharedProgress progress(context_, together, 0.05, 0.05 + together * share);
    parallel_for(context_, together, [&](int i) {
      const RunContext context = progress.part(order[i]);
      Piece piece = piece_of(order[i], context);
      search(piece, results, context);
      found[order[i]] = std::move(piece.found);
    });
    for (int c = 0; c < together; ++c)
      for (std::size_t k = 0; k < results.size(); ++k) append(found[c][k], c, results[k]);
    if (together == count) return complete_and_tell(results.front(), context_);
    const RunContext context = part_of(context_, 0.05 + together * share, 0.95);
    Piece last = piece_of(together, context);
    last.streams = true;
    search(last, results, context);
    while (last.finished < results.size()) finish(last, results, context_);
  }

  // Fills what is found for every tolerance.
  void search(Piece& piece, std::vector<Decomposition>& results, const RunContext& whole) {
    const std::vector<Variant> tries = variants(params_.effort);
    const auto runs = static_cast<double>(tries.size());
    for (std::size_t t = 0; t < tries.size(); ++t) {
      const auto done = static_cast<double>(t);
      const RunContext part = part_of(whole, done / runs, (done + 1) / runs);
      try {
        run(piece, tries[t], t + 1 == tries.size(), part, results);
      } catch (const Error& e) {
        if (e.code() != ErrorCode::kInternal || piece.finishing) throw;
      }
    }
    // A way that ends without valid strips is not the only one.
    if (piece.found.size() < results.size())
      run(piece, {Effort::kDraft, {60}, 0, 0, 11}, false, part_of(whole, 1, 1), results);
  }

  // One variant for all tolerances; by the last one a piece that streams finishes every tolerance.
  void run(Piece& piece, const Variant& variant, bool last, const RunContext& whole,
           std::vector<Decomposition>& results) {
    const auto start = Clock::now();
    std::vector<double> tolerances;
    for (const Decomposition& d : results) tolerances.push_back(small_enough(d.params.e_max, piece));
    std::size_t at = 0;
    RunContext part = by_tolerance(whole, tolerances, at);
    part.report(Stage::kPrepare, 0);
    const ComponentInput input = component_input(piece, variant, part);
    double preparing = seconds_since(start);
    const ComponentParams params = component_params(
        common_.params, tolerances[0], spacing_bounds(common_.params, norm_), variant, piece.size);
    sweep_component(input, params, tolerances, part, [&](std::size_t k, ComponentResult fresh) {
      fresh.seconds["prepare"] += std::exchange(preparing, 0);
      take(std::move(fresh), k, piece.found);
      if (last && piece.streams) finish(piece, results, part);
      at = k + 1;
    });
  }

  // Counts the time and keeps what is better than the best so far.
  static void take(ComponentResult fresh, std::size_t k, std::vector<Piece::Found>& found) {
    const bool first = k >= found.size();
    if (first) found.emplace_back();
    Piece::Found& all = found[k];
    for (const auto& [name, s] : fresh.seconds) all.seconds[name] += s;
    all.counts += fresh.counts;
    if (first || rank(fresh) < rank(all.best)) all.best = std::move(fresh);
  }

  // The strips of the next component.
  static void append(const Piece::Found& piece, int index, Decomposition& result) {
    for (const auto& [name, s] : piece.seconds) result.report.timings[name] += s;
    result.report.counts += piece.counts;
    sheetform::append(result.strips, piece.best.strips, index);
    std::vector<std::string>& notes = result.report.notes;
    notes.insert(notes.end(), piece.best.notes.begin(), piece.best.notes.end());
  }

  // The next tolerance gets the strips of the last piece: it is complete.
  void finish(Piece& last, std::vector<Decomposition>& results, RunContext& context) const {
    const std::size_t k = last.finished++;
    last.finishing = true;
    append(last.found[k], last.index, results[k]);
    complete_and_tell(results[k], context);
    last.finishing = false;
  }

  void complete_and_tell(Decomposition& d, RunContext& context) const {
    complete(d, context);
    if (found_) found_(d);
  }

  // From the strips of all components to the certified result in the units of the input.
  void complete(Decomposition& d, RunContext& context) const {
    if (half_)
      d.strips = join_images(with_mirror_image(d.strips),
                             {params_.max_sides, !params_.t_junctions, params_.self_seams});
    else
      part_close_points(d.strips, 1);
    for (Vector3& p : d.strips.points) p = norm_.out(half_ ? half_->frame.out(p) : p);
    for (Vector2& u : d.strips.uvs) u *= norm_.diagonal;
    const auto start = Clock::now();
    context.report(Stage::kFinal, 1, kCertifying);
    d.certificate = certify(input_.soup, &repaired_.mesh, d.strips, params_.max_sides, kCertificateSamples,
                            context, d.params.e_max * norm_.diagonal);
    d.report.timings["certify"] += seconds_since(start);
    if (half_ && !d.certificate.strict()) {
      d = without_symmetry(d, context);
      return;
    }
    fill_report(d, norm_, d.params.e_max);
    report_normals(d);
    report_bending(d);
    report_spacing(d, norm_);
    report_guides(d);
    if (d.certificate.strict()) return;
    const Defect& defect = d.certificate.defects.front();
    throw Error(ErrorCode::kInternal,
                "the result broke its own certificate: " + defect.check + " " + defect.text);
  }

  void report_guides(Decomposition& d) const {
    std::vector<std::string>& notes = d.report.notes;
    for (std::size_t i = 0; i < followed_.size(); ++i)
      if (!followed_[i])
        notes.push_back("seams[" + std::to_string(i) +
                        "] was left out: it is shorter than two edges of the "
                        "working mesh, or a loop too small for it");
    const double reach = (d.params.e_max + kDrawnSlack) * norm_.diagonal;
    const auto unmet = unmet_guides(d.guides, repaired_.mesh, d.strips, reach, context_);
    notes.insert(notes.end(), unmet.begin(), unmet.end());
  }

  Decomposition without_symmetry(const Decomposition& d, RunContext& context) const {
    DecomposeParams plain = params_;
    plain.symmetry = SymmetryMode::kOff;
    plain.e_max = d.params.e_max;
    Decomposition whole = decompose(input_, plain, field_, context, guides_);
    whole.report.notes.push_back("the symmetric result broke a promise (" + d.certificate.defects[0].text +
                                 "), so the mesh was decomposed as a whole");
    return whole;
  }

  const InputMesh& input_;
  const DecomposeParams& params_;
  const UserField* field_;
  const UserGuides* guides_;
  RunContext context_;
  std::function<void(const Decomposition&)> found_;  // told of every complete result
  Decomposition common_;                             // what all results have in common
  RepairResult repaired_;
  Normalisation norm_;
  SurfaceMesh mesh_;   // in diagonals around the origin, the half of a symmetric one
  SurfaceMesh whole_;  // of a half: the input that it and its image stand for, in the same coordinates
  std::optional<SymmetricHalf> half_;
  std::vector<ComponentGuides> strokes_;  // in the coordinates of mesh_
  std::mutex followed_mutex_;             // of components side by side
  std::vector<char> followed_;            // by drawn seam: it is in the mesh
  TriangleSoup user_soup_;
  ClosestPointTree user_tree_;
};

}  // namespace

void validate(const DecomposeParams& params) {
  require(params.e_max > 0 && params.e_max <= 0.5, "e_max", "above 0 and at most 0.5");
  if (params.e_max_mm)
    require(*params.e_max_mm > 0 && std::isfinite(*params.e_max_mm), "e_max_mm", "above 0");
  require(params.max_sides >= 3 && params.max_sides <= 6, "max_sides", "3 to 6");
  if (params.crease_angle)
    require(*params.crease_angle > 0 && *params.crease_angle < 180, "creases",
            "between 0 and 180 degrees, or off");
  require(params.scale > 0 && std::isfinite(params.scale), "scale", "above 0");
  if (params.target_size)
    require(*params.target_size > 0 && std::isfinite(*params.target_size), "target_size", "above 0");
  if (params.normal_deviation)
    require(*params.normal_deviation > 0 && *params.normal_deviation <= 90, "normal_deviation",
            "above 0 and at most 90 degrees, or off");
  for (const auto& [name, value] : {std::pair("ruling_spacing_min", params.ruling_spacing_min),
                                    std::pair("ruling_spacing_max", params.ruling_spacing_max),
                                    std::pair("min_bend_radius", params.min_bend_radius)})
    if (value) require(*value > 0 && std::isfinite(*value), name, "above 0");
  if (params.ruling_spacing_min && params.ruling_spacing_max)
    require(2 * *params.ruling_spacing_min <= *params.ruling_spacing_max, "ruling_spacing_min",
            "at most half of ruling_spacing_max, so that seams of all lengths can be divided");
}

Decomposition decompose(const InputMesh& input, const DecomposeParams& params, const UserField* field,
                        RunContext& context, const UserGuides* guides) {
  validate(params);
  return Sweep(input, params, field, guides, context).run({}).front();
}

std::vector<Decomposition> sweep(const InputMesh& input, const DecomposeParams& params,
                                 const std::vector<double>& e_max, const UserField* field,
                                 RunContext& context, const UserGuides* guides,
                                 const std::function<void(const Decomposition&)>& found) {
  require(!e_max.empty(), "e_max", "at least one tolerance");
  if (params.e_max_mm) refuse("a sweep takes fractions of the diagonal", "e_max_mm", "use e_max");
  DecomposeParams each = params;
  for (double e : e_max) each.e_max = e, validate(each);
  std::vector<double> ascending = e_max;
  std::sort(ascending.begin(), ascending.end());
  ascending.erase(std::unique(ascending.begin(), ascending.end()), ascending.end());
  each.e_max = ascending.front();
  const std::vector<Decomposition> all = Sweep(input, each, field, guides, context, found).run(ascending);
  std::vector<Decomposition> results;
  for (double e : e_max)
    results.push_back(all[std::lower_bound(ascending.begin(), ascending.end(), e) - ascending.begin()]);
  return results;
}

}  // namespace sheetform
