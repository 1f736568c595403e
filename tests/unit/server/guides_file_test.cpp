// Readers of the user's strokes, and the bundle that carries them with the mesh.
#include "server/mapping/guides_file.h"

#include <gtest/gtest.h>

#include "server/base/input_bundle.h"
#include "server/mapping/run.h"
#include "sheetform/base/error.h"
#include "sheetform_api/parameter_schema.h"

namespace sheetform::server {
namespace {

TEST(GuidesFile, BothKinds) {
  const UserGuides g = read_guides(R"({"seams":[{"points":[[0,0,0],[1,2.5,-3e1]],"closed":false},
      {"points":[[0,0,0],[1,0,0],[0,1,0]],"closed":true}, {"points":[[0,0,0],[1,0,0]]}],
      "keep_out":[{"points":[[4,5,6]],"radius":0.5}]})");
  ASSERT_EQ(g.seams.size(), 3u);
  EXPECT_EQ(g.seams[0].points[1], Vector3(1, 2.5, -30));
  EXPECT_FALSE(g.seams[0].closed);
  EXPECT_TRUE(g.seams[1].closed);
  EXPECT_FALSE(g.seams[2].closed);
  ASSERT_EQ(g.keep_out.size(), 1u);
  EXPECT_EQ(g.keep_out[0].points[0], Vector3(4, 5, 6));
  EXPECT_EQ(g.keep_out[0].radius, 0.5);
}

TEST(GuidesFile, OneKindIsEnough) {
  EXPECT_EQ(read_guides(R"({"seams":[{"points":[[0,0,0],[1,0,0]]}]})").keep_out.size(), 0u);
  EXPECT_EQ(read_guides(R"({"seams":[],"keep_out":[{"points":[[0,0,0]],"radius":1}]})").seams.size(), 0u);
}

struct Refused {
  const char* text;
  const char* where;
};
void PrintTo(const Refused& r, std::ostream* out) { *out << r.text; }

class RefusedGuides : public ::testing::TestWithParam<Refused> {};
TEST_P(RefusedGuides, SayWhere) {
  try {
    (void)read_guides(GetParam().text);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
    EXPECT_EQ(e.where(), GetParam().where);
    EXPECT_FALSE(e.summary().empty());
    EXPECT_FALSE(e.fix().empty());
  }
}
INSTANTIATE_TEST_SUITE_P(
    All, RefusedGuides,
    ::testing::Values(
        Refused{"", "guides"}, Refused{"nonsense", "guides"}, Refused{"{", "guides"}, Refused{"[]", "guides"},
        Refused{"3", "guides"}, Refused{"{}", "guides"}, Refused{R"({"seams":[]})", "guides"},
        Refused{R"({"lines":[]})", "guides"}, Refused{R"({"seams":{}})", "guides, seams"},
        Refused{R"({"seams":[3]})", "guides, seams[0]"}, Refused{R"({"seams":[{}]})", "guides, seams[0]"},
        Refused{R"({"seams":[{"points":7}]})", "guides, seams[0]"},
        Refused{R"({"seams":[{"points":[]}]})", "guides, seams[0]"},
        Refused{R"({"seams":[{"points":[[0,0,0]]}]})", "guides, seams[0]"},
        Refused{R"({"seams":[{"points":[[0,0,0],[1,0,0]],"closed":true}]})", "guides, seams[0]"},
        Refused{R"({"seams":[{"points":[[0,0,0],[1,0,0]],"closed":1}]})", "guides, seams[0]"},
        Refused{R"({"seams":[{"points":[[0,0,0],[1,0,0]],"radius":1}]})", "guides, seams[0]"},
        Refused{R"({"seams":[{"points":[[0,0,0],[1,0]]}]})", "guides, seams[0], point 1"},
        Refused{R"({"seams":[{"points":[[0,0,0],[1,0,"0"]]}]})", "guides, seams[0], point 1"},
        Refused{R"({"seams":[{"points":[[0,0,0],[1,0,null]]}]})", "guides, seams[0], point 1"},
        Refused{R"({"seams":[{"points":[[0,0,0],[1,0,NaN]]}]})", "guides"},
        Refused{R"({"seams":[{"points":[[0,0,0],[1,0,1e999]]}]})", "guides"},
        Refused{R"({"keep_out":[{"points":[[0,0,0]]}]})", "guides, keep_out[0]"},
        Refused{R"({"keep_out":[{"points":[],"radius":1}]})", "guides, keep_out[0]"},
        Refused{R"({"keep_out":[{"points":[[0,0,0]],"radius":0}]})", "guides, keep_out[0]"},
        Refused{R"({"keep_out":[{"points":[[0,0,0]],"radius":-2}]})", "guides, keep_out[0]"},
        Refused{R"({"keep_out":[{"points":[[0,0,0]],"radius":"1"}]})", "guides, keep_out[0]"},
        Refused{R"({"keep_out":[{"points":[[0,0,0]],"radius":1},{"points":[[0,0]],"radius":1}]})",
                "guides, keep_out[1], point 0"}));

TEST(GuidesFile, TooManyAreRefused) {
  std::string strokes, points = "[0,0,0]";
  for (std::size_t i = 0; i <= kMostStrokes; ++i)
    strokes += std::string(i ? "," : "") + R"({"points":[[0,0,0]],"radius":1})";
  EXPECT_THROW((void)read_guides(R"({"keep_out":[)" + strokes + "]}"), Error);
  for (std::size_t i = 0; i < kMostStrokePoints; ++i) points += ",[0,0,0]";
  EXPECT_THROW((void)read_guides(R"({"keep_out":[{"points":[)" + points + R"(],"radius":1}]})"), Error);
}

TEST(InputBundle, CarriesGuidesWithAndWithoutAField) {
  for (const std::string& mesh : {std::string("v 0 0 0"), std::string(1000, 'x')})
    for (const std::string& field : {std::string(), std::string("1 4 1 0 0"), std::string(500, '7')})
      for (const std::string& guides : {std::string("{}"), std::string(300, '9')}) {
        const std::string whole = mesh + after_mesh(mesh.size(), field, guides);
        EXPECT_EQ(split_bundle(whole).mesh, mesh);
        EXPECT_EQ(split_bundle(whole).field, field);
        EXPECT_EQ(split_bundle(whole).guides, guides);
        EXPECT_EQ(mesh_bytes_of(whole.size(), whole.substr(whole.size() - kTailBytes)), mesh.size());
      }
  EXPECT_EQ(after_mesh(5, "field"), after_mesh(5, "field", ""));
}

TEST(InputBundle, BytesThatOnlyLookLikeGuidesStayAMesh) {
  const std::string good = "mesh" + after_mesh(4, "", "guides");
  for (std::size_t k = 0; k < kTailBytes; ++k) {
    std::string other = good;
    other[other.size() - 1 - k] = '?';
    EXPECT_EQ(split_bundle(other).mesh, other) << k;
  }
  std::string lie = good;  // a field longer than all there is
  lie[lie.size() - kTailBytes - 1] = '9';
  EXPECT_EQ(split_bundle(lie).mesh, lie);
}

TEST(Inspect, ReadsGuidesAndLooksWhereTheyLie) {
  const api::Json parameters = api::complete_parameters(api::Json::object());
  const std::string mesh = "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 6\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  const auto inspect = [&](const std::string& guides) {
    return inspect_mesh(mesh + after_mesh(mesh.size(), "", guides), "t.obj", parameters);
  };
  EXPECT_EQ(inspect(R"({"seams":[{"points":[[0,0,0],[1,0.2,0]]}]})").bytes,
            static_cast<std::int64_t>(mesh.size()));
  try {
    (void)inspect(R"({"seams":[{"points":[[0,0,0],[1,0,0]]},{"points":[[0,0,0],[9,9,9]]}]})");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), "guides, seams[1], point 1");
  }
}

}  // namespace
}  // namespace sheetform::server
