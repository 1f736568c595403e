#include "sheetform/morph/morph.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

namespace sheetform {
namespace {

MorphParams params(int rounds, double smooth = 0, double slide = 0) {
  MorphParams p;
  p.rounds = rounds;
  p.smooth = smooth;
  p.slide = slide;
  return p;
}

MorphSample sample(int a, int b, double t, const Vector3& target, const Vector3& normal, double weight) {
  MorphSample s;
  s.unknown = {a, b, a};
  s.coefficient = {1 - t, t, 0};
  s.target = target;
  s.normal = normal;
  s.weight = weight;
  return s;
}

// One ruling over an arc: y = 4 s t (1 - t) over [0, 1], sampled evenly, both ends free.
MorphProblem arc(double sagitta, int n) {
  MorphProblem problem;
  problem.rest = {Vector3::Zero(), Vector3::UnitX()};
  problem.anchor = {1e-9, 1e-9};
  for (int i = 0; i <= n; ++i) {
    const double t = double(i) / n;
    problem.samples.push_back(sample(0, 1, t, {t, 4 * sagitta * t * (1 - t), 0}, Vector3::UnitY(),
                                     (i == 0 || i == n ? 0.5 : 1.0) / n));
  }
  return problem;
}

TEST(Morph, LeastSquaresLineOverAnArcIsOffByTwoThirdsOfTheSagitta) {
  const MorphResult result = morph(arc(0.03, 400), params(0));
  EXPECT_NEAR(result.max_error, 0.03 * 2 / 3, 1e-5);
  for (const Vector3& p : result.position) EXPECT_NEAR(p.y(), 0.02, 1e-5);
}

TEST(Morph, MinimaxLineOverAnArcIsOffByHalfOfTheSagitta) {
  const MorphResult few = morph(arc(0.03, 100), params(4)), many = morph(arc(0.03, 100), params(300));
  EXPECT_LT(few.max_error, 0.03 * 0.6) << "most of the way after the four rounds of the search";
  EXPECT_NEAR(many.max_error, 0.015, 0.015 * 0.02);
  for (const Vector3& p : many.position) EXPECT_NEAR(p.y(), 0.015, 0.0005);
}

TEST(Morph, PointsOfThePlaneOfSymmetryStayThereAndTheOthersMakeUpForIt) {
  // The line wants to be x = 0.1 + 0.8 t; its first end lies on the plane x = 0. Least squares through the
  // origin: slope = sum t x / sum t^2. The other coordinates are those of the free line.
  MorphProblem problem = arc(0.03, 100);
  for (MorphSample& s : problem.samples) s.target.x() = 0.1 + 0.8 * s.coefficient[1], s.target.z() = 0.5;
  double tx = 0, tt = 0;
  for (const MorphSample& s : problem.samples) {
    tx += s.weight * s.coefficient[1] * s.target.x();
    tt += s.weight * s.coefficient[1] * s.coefficient[1];
  }
  const MorphResult free = morph(problem, params(0));
  problem.on_plane = {1, 0};
  const MorphResult held = morph(problem, params(0));
  EXPECT_EQ(held.position[0].x(), 0);
  EXPECT_NEAR(held.position[1].x(), tx / tt, 1e-7);
  EXPECT_NEAR(free.position[0].x(), 0.1, 1e-7);
  for (int i = 0; i < 2; ++i)
    for (int k : {1, 2}) EXPECT_NEAR(held.position[i][k], free.position[i][k], 1e-12);
}

TEST(Morph, ErrorsGrowWithTheArc) {
  for (double s : {1e-4, 1e-2, 1.0})
    EXPECT_NEAR(morph(arc(s, 200), params(0)).max_error, s * 2 / 3, 1e-4 * s);
}

TEST(Morph, MoreRoundsAreNeverWorse) {
  double last = 1e9;
  for (int rounds : {0, 1, 2, 4, 8, 16, 64}) {
    const double e = morph(arc(0.05, 60), params(rounds)).max_error;
    EXPECT_LE(e, last + 1e-15);
    last = e;
  }
}

TEST(Morph, ReportsTheErrorOfThePositionsThatItReturns) {
  const MorphProblem problem = arc(0.05, 60);
  const MorphResult result = morph(problem, params(7));
  double worst = 0;
  for (const MorphSample& s : problem.samples)
    worst = std::max(worst, (s.at(result.position) - s.target).norm());
  EXPECT_NEAR(result.max_error, worst, 1e-12);
}

TEST(Morph, StopsOnceTheErrorIsSmallEnough) {
  MorphParams p = params(50);
  p.stop_below = 0.9;  // already met by least squares: 2/3
  EXPECT_NEAR(morph(arc(1, 100), p).max_error, 2.0 / 3, 1e-3);
}

TEST(Morph, StraightRulingsStay) {
  MorphProblem problem = arc(0, 20);
  problem.rest.push_back({2, 1, 5});
  problem.anchor.push_back(0.02);
  problem.stencils.push_back({0, 1, 2});
  for (int i = 0; i <= 10; ++i)
    problem.samples.push_back(sample(1, 2, i / 10.0,
                                     (1 - i / 10.0) * problem.rest[1] + i / 10.0 * problem.rest[2],
                                     Vector3::UnitY(), 0.1));
  const MorphResult result = morph(problem, params(4, 1));
  EXPECT_LT(result.max_error, 1e-13);
  for (int i = 0; i < 3; ++i) EXPECT_LT((result.position[i] - problem.rest[i]).norm(), 1e-13);
}

TEST(Morph, HeldPointsStayAndTheOthersAdaptToThem) {
  MorphProblem problem = arc(0.03, 200);
  problem.anchor[0] = 1e6;
  const MorphResult result = morph(problem, params(0));
  EXPECT_LT(result.position[0].norm(), 1e-6);
  // Least squares of y = b t to 4 s t (1 - t): b = integral of 4 s t^2 (1 - t) over integral of t^2 = s.
  EXPECT_NEAR(result.position[1].y(), 0.03, 1e-5);
}

TEST(Morph, PointsWithoutDataAreCarriedByTheirAnchor) {
  MorphProblem problem = arc(0.03, 50);
  problem.rest.push_back({7, 8, 9});
  problem.anchor.push_back(0.02);
  EXPECT_LT((morph(problem, params(4)).position[2] - Vector3(7, 8, 9)).norm(), 1e-12);
}

TEST(Morph, SamplesWithoutWeightAreOnlyMeasured) {
  MorphProblem problem = arc(0.03, 50);
  const MorphResult before = morph(problem, params(3));
  problem.samples.push_back(sample(0, 1, 0.5, {0.5, 100, 0}, Vector3::UnitY(), 0));
  const MorphResult after = morph(problem, params(3));
  EXPECT_EQ(after.max_error, before.max_error);
  EXPECT_EQ(after.position[0], before.position[0]);
}

// A zigzag that opposite rulings pull at: points on a line, targets up and down in turn.
MorphProblem zigzag(int n, double amplitude, const Vector3& shift) {
  MorphProblem problem;
  for (int i = 0; i < n; ++i) {
    problem.rest.push_back(Vector3(i, 0, 0));
    problem.anchor.push_back(1e-6);
    if (i > 0 && i + 1 < n) problem.stencils.push_back({i - 1, i, i + 1});
    problem.samples.push_back(sample(i, i, 0,
                                     problem.rest[i] + shift + Vector3(0, i % 2 ? amplitude : -amplitude, 0),
                                     Vector3::UnitY(), 1));
  }
  return problem;
}

double roughness(const std::vector<Vector3>& x) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) sum += (x[i - 1] - 2 * x[i] + x[i + 1]).norm();
  return sum;
}

TEST(Morph, SmoothnessTakesZigzagOut) {
  const double rough = roughness(morph(zigzag(21, 0.1, Vector3::Zero()), params(0, 0)).position);
  const double smooth = roughness(morph(zigzag(21, 0.1, Vector3::Zero()), params(0, 3)).position);
  EXPECT_NEAR(rough, 19 * 0.4, 1e-3);
  EXPECT_LT(smooth, 0.2 * rough);
}

TEST(Morph, SmoothnessActsOnDisplacements) {
  // A strongly bent arch that has to move as a whole: it does, whatever the weight.
  MorphProblem problem;
  for (int i = 0; i < 12; ++i) {
    const double a = i * 0.4;
    problem.rest.push_back(Vector3(std::cos(a), std::sin(a), 0));
    problem.anchor.push_back(1e-9);
    if (i > 1) problem.stencils.push_back({i - 2, i - 1, i});
    problem.samples.push_back(sample(i, i, 0, problem.rest[i] + Vector3(0.1, 0.2, 0.3), Vector3::UnitZ(), 1));
  }
  for (double smooth : {0.1, 1.0, 100.0}) {
    const MorphResult result = morph(problem, params(0, smooth));
    for (int i = 0; i < 12; ++i)
      EXPECT_LT((result.position[i] - problem.rest[i] - Vector3(0.1, 0.2, 0.3)).norm(), 1e-6) << smooth;
  }
}

TEST(Morph, BendActsOnTheArchItself) {
  MorphProblem problem = zigzag(9, 0, Vector3::Zero());
  for (int i = 0; i < 9; ++i) problem.samples[i].target.y() = problem.rest[i].y() = 0.1 * (i % 2);
  for (const auto& t : problem.stencils) problem.bends.push_back(t);
  MorphParams p = params(0, 1);
  const double before = roughness(morph(problem, p).position);
  p.bend = 3;
  EXPECT_LT(roughness(morph(problem, p).position), 0.9 * before);
}

TEST(Morph, TangentialOffsetsAreForgivenAsFarAsAllowed) {
  // Targets of a straight ruling, shifted along it in turn: no position fits, but the surface is met.
  const auto problem = [](double slide_of_samples) {
    MorphProblem p;
    p.rest = {Vector3::Zero(), Vector3::UnitX()};
    p.anchor = {1e-6, 1e-6};
    for (int i = 0; i <= 20; ++i) {
      const double t = i / 20.0;
      p.samples.push_back(sample(0, 1, t, {t + (i % 2 ? 0.05 : -0.05), 0, 0}, Vector3::UnitY(), 1));
      p.samples.back().slide = slide_of_samples;
    }
    return p;
  };
  const double strict = morph(problem(1), params(4, 0, 0)).max_error;
  EXPECT_GT(strict, 0.045);
  EXPECT_LT(morph(problem(1), params(4, 0, 0.8)).max_error, 0.25 * strict);
  EXPECT_NEAR(morph(problem(0), params(4, 0, 0.8)).max_error, strict, 1e-3)
      << "samples that are granted nothing";
}

// ---- against a dense solution
// --------------------------------------------------------------------------------------

MorphProblem random_problem(int unknowns, int samples, std::mt19937& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  const auto point = [&] { return Vector3(u(random), u(random), u(random)); };
  MorphProblem p;
  for (int i = 0; i < unknowns; ++i)
    p.rest.push_back(point()), p.anchor.push_back(0.01 + 0.1 * std::abs(u(random)));
  for (int i = 0; i + 2 < unknowns; ++i) p.stencils.push_back({i, i + 1, i + 2});
  for (int i = 0; i + 4 < unknowns; i += 2) p.bends.push_back({i, i + 2, i + 4});
  for (int s = 0; s < samples; ++s) {
    MorphSample m;
    double sum = 0;
    for (int k = 0; k < 3; ++k) m.unknown[k] = static_cast<int>(random() % unknowns);
    for (double& c : m.coefficient) sum += c = std::abs(u(random));
    for (double& c : m.coefficient) c /= sum;
    m.target = point(), m.normal = point().normalized();
    m.weight = 0.1 + std::abs(u(random));
    p.samples.push_back(m);
  }
  return p;
}

// The least-squares problem as morph.h states it, row by row.
std::vector<Vector3> dense_solution(const MorphProblem& p, const MorphParams& params) {
  const int n = static_cast<int>(p.rest.size());
  double total = 0;
  for (const MorphSample& s : p.samples) total += s.weight;
  const double unit = total / n;  // the mean data weight of an unknown
  std::vector<Eigen::RowVectorXd> rows;
  std::vector<Vector3> right;
  const auto add = [&](double weight, const std::vector<std::pair<int, double>>& row, const Vector3& value) {
    rows.emplace_back(Eigen::RowVectorXd::Zero(n));
    for (const auto& [i, c] : row) rows.back()[i] += std::sqrt(weight) * c;
    right.push_back(std::sqrt(weight) * value);
  };
  for (const MorphSample& s : p.samples)
    add(s.weight,
        {{s.unknown[0], s.coefficient[0]},
         {s.unknown[1], s.coefficient[1]},
         {s.unknown[2], s.coefficient[2]}},
        s.target);
  // The middle one against the point of the line between its neighbours that divides it as they are apart;
  // the same bend costs the same however far apart they are.
  const auto add_bend = [&](const std::array<int, 3>& t, double weight, bool relative) {
    const double before = (p.rest[t[1]] - p.rest[t[0]]).norm(), after = (p.rest[t[2]] - p.rest[t[1]]).norm();
    const double first = after / (before + after), last = 1 - first;
    if (params.spacing > 0)
      weight /= std::max(1.0, std::pow(before * after / (params.spacing * params.spacing), 2));
    add(weight, {{t[0], first}, {t[1], -1}, {t[2], last}},
        relative ? Vector3(first * p.rest[t[0]] - p.rest[t[1]] + last * p.rest[t[2]]) : Vector3::Zero());
  };
  for (const auto& t : p.stencils) add_bend(t, params.smooth * unit, true);
  if (params.bend > 0)
    for (const auto& t : p.bends) add_bend(t, params.bend * unit, false);
  for (int i = 0; i < n; ++i) add(p.anchor[i] * unit, {{i, 1}}, p.rest[i]);
  Eigen::MatrixXd a(rows.size(), n);
  Eigen::MatrixX3d b(rows.size(), 3);
  for (std::size_t r = 0; r < rows.size(); ++r) a.row(r) = rows[r], b.row(r) = right[r];
  const Eigen::MatrixX3d x = a.colPivHouseholderQr().solve(b);
  std::vector<Vector3> out(n);
  for (int i = 0; i < n; ++i) out[i] = x.row(i);
  return out;
}

TEST(Morph, AgreesWithADenseSolve) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const MorphProblem problem = random_problem(5 + trial, 20 + 3 * trial, random);
    MorphParams p = params(0, 0.7);
    if (trial % 2) p.bend = 0.3;
    if (trial % 3) p.spacing = 0.2;
    const std::vector<Vector3> wanted = dense_solution(problem, p), got = morph(problem, p).position;
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_LT((wanted[i] - got[i]).norm(), 1e-9) << trial;
  }
}

TEST(Morph, FollowsRotationShiftAndScale) {
  std::mt19937 random(9);
  const MorphProblem problem = random_problem(12, 40, random);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.9, Vector3(1, -2, 0.5).normalized()).toRotationMatrix();
  const auto move = [&](const Vector3& p) { return Vector3(50 * (turn * p) + Vector3(3, 4, 5)); };
  MorphProblem moved = problem;
  for (Vector3& p : moved.rest) p = move(p);
  for (MorphSample& s : moved.samples) s.target = move(s.target), s.normal = turn * s.normal;
  const MorphParams p = params(4, 0.5, 0.7);
  const MorphResult a = morph(problem, p), b = morph(moved, p);
  EXPECT_NEAR(50 * a.max_error, b.max_error, 1e-8);
  for (std::size_t i = 0; i < a.position.size(); ++i)
    EXPECT_LT((move(a.position[i]) - b.position[i]).norm(), 1e-8);
}

TEST(Morph, SolutionOfOnePartDoesNotDependOnAnother) {
  // Two rulings without a common unknown: the second one only changes the common weight unit.
  MorphProblem one = arc(0.03, 40), both = one;
  one.anchor = both.anchor = {1e-12, 1e-12};
  both.rest.push_back({5, 0, 0}), both.rest.push_back({6, 0, 0});
  both.anchor.push_back(1e-12), both.anchor.push_back(1e-12);
  for (int i = 0; i <= 40; ++i)
    both.samples.push_back(
        sample(2, 3, i / 40.0, {5 + i / 40.0, 0.5 * i / 40.0, 0}, Vector3::UnitY(), 1.0 / 40));
  const MorphResult a = morph(one, params(0)), b = morph(both, params(0));
  for (int i = 0; i < 2; ++i) EXPECT_LT((a.position[i] - b.position[i]).norm(), 1e-9);
}

TEST(Morph, SharedUnknownsShareTheError) {
  // Two arcs of opposite bulge that share an end: the common end stays in the middle.
  MorphProblem problem;
  problem.rest = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}};
  problem.anchor = {1e-9, 1e-9, 1e-9};
  for (int i = 0; i <= 100; ++i) {
    const double t = i / 100.0, y = 0.04 * 4 * t * (1 - t);
    problem.samples.push_back(sample(0, 1, t, {t - 1, y, 0}, Vector3::UnitY(), 0.01));
    problem.samples.push_back(sample(1, 2, t, {t, -y, 0}, Vector3::UnitY(), 0.01));
  }
  const MorphResult result = morph(problem, params(0));
  EXPECT_NEAR(result.position[1].y(), 0, 1e-12);
  EXPECT_NEAR(result.position[0].y(), -result.position[2].y(), 1e-12);
  EXPECT_GT(result.position[0].y(), 0);
}

}  // namespace
}  // namespace sheetform
