#include <gtest/gtest.h>

#include <chrono>

#include "server/mapping/errors.h"
#include "server/mapping/exports.h"
#include "server/mapping/parameters.h"
#include "server/mapping/run.h"

namespace sheetform::server {
namespace {

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 6\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

TEST(Mapping, SchemaDefaultsAreThoseOfCore) {
  EXPECT_EQ(api::complete_parameters(api::Json::object()), to_wire(DecomposeParams{}));
}

TEST(Mapping, EveryParameterReachesCoreAndComesBack) {
  const api::Json values = api::complete_parameters(api::Json::parse(
      R"({"e_max":0.01,"e_max_mm":3,"t_junctions":false,"symmetry":"0,1,0,2.5","max_sides":4,"creases":"off",
          "self_seams":false,"normal_deviation":12.5,"ruling_spacing_min":2,"ruling_spacing_max":8,"min_bend_radius":15,"effort":"thorough","morph":"full","scale":25.4,"target_size":300,
          "seed":7,"material":"plywood","up":"-y"})"));
  EXPECT_EQ(values.size(), api::parameter_definitions().size());
  EXPECT_EQ(to_wire(to_core(values)), values);
}

TEST(Mapping, SymmetryPlaneIsMadeUnit) {
  const DecomposeParams p = to_core(api::complete_parameters(api::Json::parse(R"({"symmetry":"0,0,2,3"})")));
  EXPECT_EQ(p.symmetry, SymmetryMode::kPlane);
  EXPECT_DOUBLE_EQ(p.plane.normal.z(), 1);
  EXPECT_DOUBLE_EQ(p.plane.offset, 1.5);
}

TEST(Mapping, UnknownParametersAreRefusedByName) {
  try {
    (void)understood_parameters(api::Json::parse(R"({"e_maks":1})"));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
    EXPECT_EQ(e.where(), "e_maks");
  }
}

TEST(Mapping, ErrorsBecomeProblems) {
  const api::Problem p = to_problem(Error(ErrorCode::kUnreadableMesh, "broken", "line 3", "mend it"));
  EXPECT_EQ(p.type, api::ProblemType::kUnreadableMesh);
  EXPECT_EQ(p.detail, "broken");
  EXPECT_EQ(p.where, "line 3");
  EXPECT_EQ(p.fix, "mend it");
}

TEST(Mapping, ExitStatusSaysWhoIsAtFault) {
  EXPECT_EQ(exit_status(ErrorCode::kInvalidParameter), 64);
  EXPECT_EQ(exit_status(ErrorCode::kUnreadableMesh), 65);
  EXPECT_EQ(exit_status(ErrorCode::kUnsupportedMesh), 65);
  EXPECT_EQ(exit_status(ErrorCode::kLimitExceeded), 65);
  EXPECT_EQ(exit_status(ErrorCode::kInternal), 70);
}

TEST(Inspect, SaysWhatTheMeshIs) {
  const api::Json parameters = api::complete_parameters(api::Json::parse(R"({"target_size":60})"));
  const api::MeshInfo info = inspect_mesh(kTetrahedron, "t.obj", parameters);
  EXPECT_EQ(info.format, "obj");
  EXPECT_EQ(info.vertices, 4);
  EXPECT_EQ(info.faces, 4);
  EXPECT_EQ(info.box_max, (std::array<double, 3>{2, 3, 6}));
  EXPECT_DOUBLE_EQ(info.scale, 10);
}

TEST(Inspect, RefusesWhatHasNoFaces) {
  const api::Json parameters = api::complete_parameters(api::Json::object());
  EXPECT_THROW((void)inspect_mesh("v 0 0 0\n", "t.obj", parameters), Error);
  EXPECT_THROW((void)inspect_mesh("", "t.obj", parameters), Error);
}

class SweepOfATetrahedron : public ::testing::Test {
 protected:
  SweepOutcome run(const std::function<void(const SweepStep&)>& after,
                   const std::atomic<bool>* enough = nullptr) {
    api::Json parameters = api::complete_parameters(api::Json::parse(R"({"effort":"draft"})"));
    parameters[api::kTolerance] = {0.03, 0.01, 0.05};
    RunContext context;
    const auto take = [&](SweepStep step) {
      found_.push_back(step.point);
      after(step);
    };
    return run_sweep(kTetrahedron, "t.obj", parameters, {0.03, 0.01, 0.05}, context, take, enough);
  }
  std::vector<std::string> found_;
};

const auto out_of_time = [](const SweepStep& step) {
  if (step.point == "0.03") throw Error(ErrorCode::kDeadlineExceeded, "too late");
};

TEST_F(SweepOfATetrahedron, HandsOverEachPointTheFinestFirst) {
  const SweepOutcome outcome = run([](const SweepStep& step) { EXPECT_EQ(step.outcome.files.size(), 3u); });
  EXPECT_EQ(found_, (std::vector<std::string>{"0.01", "0.03", "0.05"}));
  EXPECT_EQ(outcome.curve.size(), 3u);
  EXPECT_TRUE(outcome.missing.empty());
  EXPECT_TRUE(outcome.notes.empty());
  EXPECT_FALSE(api::Json::parse(outcome.files[1].content).contains("missing"));
}

/// The limit on uploads is the server's (--max-upload), not one of the reader's own.
TEST(Inspection, TakesWhatTheServerTook) {
  std::string mesh(std::size_t{257} << 20, '\n');
  mesh += kTetrahedron;
  const api::MeshInfo info = inspect_mesh(mesh, "large.obj", api::complete_parameters(api::Json::object()));
  EXPECT_EQ(info.faces, 4);
}

TEST_F(SweepOfATetrahedron, KeepsWhatIsFoundWhenTheTimeIsUp) {
  const SweepOutcome outcome = run(out_of_time);
  EXPECT_EQ(outcome.curve.size(), 2u);
  EXPECT_EQ(outcome.curve[1].at("point"), "0.03");
  EXPECT_EQ(outcome.missing, std::vector<double>{0.05});
  ASSERT_EQ(outcome.notes.size(), 1u);
  EXPECT_NE(outcome.notes[0].find("2 of 3"), std::string::npos);
  EXPECT_EQ(api::Json::parse(outcome.files[1].content).at("missing"), api::Json({0.05}));
}

TEST_F(SweepOfATetrahedron, KeepsWhatIsFoundWhenThatIsEnough) {
  std::atomic<bool> enough{false};
  const auto cancelled = [&](const SweepStep&) {
    enough = true;
    throw Error(ErrorCode::kCancelled, "enough");
  };
  const SweepOutcome outcome = run(cancelled, &enough);
  EXPECT_TRUE(outcome.stopped);
  EXPECT_EQ(outcome.curve.size(), 1u);
  EXPECT_EQ(outcome.missing, (std::vector<double>{0.03, 0.05}));
  ASSERT_EQ(outcome.notes.size(), 1u);
  EXPECT_NE(outcome.notes[0].find("stopped after 1 of 3"), std::string::npos);
}

TEST_F(SweepOfATetrahedron, IsWholeWhenEnoughComesWithTheLastPoint) {
  const std::atomic<bool> enough{true};
  const auto at_the_end = [](const SweepStep& step) {
    if (step.point == "0.05") throw Error(ErrorCode::kCancelled, "enough");
  };
  const SweepOutcome outcome = run(at_the_end, &enough);
  EXPECT_FALSE(outcome.stopped);
  EXPECT_EQ(outcome.curve.size(), 3u);
  EXPECT_TRUE(outcome.missing.empty());
  EXPECT_TRUE(outcome.notes.empty());
}

TEST_F(SweepOfATetrahedron, FailsWhenNothingIsFoundInTimeOrForAnotherReason) {
  api::Json parameters = api::complete_parameters(api::Json::object());
  parameters[api::kTolerance] = {0.01};
  RunContext late;
  late.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  try {
    run_sweep(kTetrahedron, "t.obj", parameters, {0.01}, late, [](const SweepStep&) { FAIL(); });
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kDeadlineExceeded);
  }
  EXPECT_THROW(run([](const SweepStep&) { throw Error(ErrorCode::kCancelled, "stop"); }), Error);
  EXPECT_THROW(run([](const SweepStep&) { throw Error(ErrorCode::kInternal, "broken"); }), Error);
}

TEST(Exports, AParameterWithoutANameHasAPlaceToo) {
  ExportWish wish;
  wish.format = "pdf";
  wish.query = {{"", "on"}};
  try {
    check_export(wish);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
    EXPECT_EQ(e.where(), "query");
  }
}

}  // namespace
}  // namespace sheetform::server
