// Readers of the user's cross field, and the bundle that carries it with the mesh.
#include "server/mapping/field_file.h"

#include <gtest/gtest.h>

#include <random>

#include "server/base/input_bundle.h"
#include "server/mapping/run.h"
#include "sheetform_api/parameter_schema.h"

namespace sheetform::server {
namespace {

constexpr std::size_t kVertices = 3, kFaces = 2;

UserField read(const std::string& text) { return read_field(text, kVertices, kFaces); }

/// The error of a text that must be refused.
Error refused(const std::string& text) {
  try {
    (void)read(text);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
    EXPECT_FALSE(e.fix().empty());
    return e;
  }
  ADD_FAILURE() << "accepted: " << text;
  return {ErrorCode::kInternal, "accepted"};
}

TEST(FieldFile, RosyOnFaces) {
  const UserField f = read("2\n4\n 0 0 2\n-3e0 0 +0.0\r\n");
  ASSERT_EQ(f.per_face.size(), 2u);
  EXPECT_TRUE(f.per_vertex.empty());
  EXPECT_EQ(f.per_face[0], Vector3(0, 0, 1));
  EXPECT_EQ(f.per_face[1], Vector3(-1, 0, 0));
}

TEST(FieldFile, RosyOnVerticesWithAFreePlace) {
  const UserField f = read("3 4 0 0 0 1 0 0 0 5 0");
  ASSERT_EQ(f.per_vertex.size(), 3u);
  EXPECT_EQ(f.per_vertex[0], Vector3(0, 0, 0));
  EXPECT_EQ(f.per_vertex[2], Vector3(0, 1, 0));
}

TEST(FieldFile, JsonInItsForms) {
  EXPECT_EQ(read("[[1,0,0],null]").per_face[1], Vector3(0, 0, 0));
  EXPECT_EQ(read(" {\"directions\": [[1,0,0],[0,2,0],[0,0,1]]}").per_vertex[1], Vector3(0, 1, 0));
  EXPECT_EQ(read(R"({"per":"vertex","directions":[[1,0,0],[0,2,0],[0,0,1]]})").per_vertex.size(), 3u);
  // Where both counts fit, faces; unless it is said.
  EXPECT_EQ(read_field("[[1,0,0]]", 1, 1).per_face.size(), 1u);
  EXPECT_EQ(read_field(R"({"per":"vertex","directions":[[1,0,0]]})", 1, 1).per_vertex.size(), 1u);
}

TEST(FieldFile, ExtremeLengthsAreDirectionsToo) {
  EXPECT_EQ(read("2 4 1e-300 0 0 0 1e300 0").per_face[0], Vector3(1, 0, 0));
  EXPECT_EQ(read("2 4 1e-300 0 0 0 1e300 0").per_face[1], Vector3(0, 1, 0));
}

TEST(FieldFile, AWrongCountIsRefusedWithBothNumbers) {
  for (const char* text : {"4\n4\n1 0 0\n1 0 0\n1 0 0\n1 0 0\n", "[[1,0,0],[1,0,0],[1,0,0],[1,0,0]]"}) {
    const Error e = refused(text);
    EXPECT_NE(e.summary().find("4 directions"), std::string::npos);
    EXPECT_NE(e.summary().find("3 vertices and 2 triangles"), std::string::npos);
    EXPECT_NE(e.where().find("field"), std::string::npos);
  }
  (void)refused(R"({"per":"face","directions":[[1,0,0],[0,2,0],[0,0,1]]})");
}

TEST(FieldFile, ErrorsSayWhere) {
  EXPECT_EQ(refused("2\n4\n1 0 0\n1 0 x\n").where(), "field, line 4");
  EXPECT_EQ(refused("2\n4\n1 0 0\n1 0 nan\n").where(), "field, line 4");
  EXPECT_EQ(refused("2\n4\n1 0 0\n1 0").where(), "field, line 4");
  EXPECT_EQ(refused("2\n4\n1 0 0\n1 0 0\n7").where(), "field, line 5");
  EXPECT_EQ(refused("2\n2\n1 0 0\n1 0 0\n").where(), "field, line 2");
  EXPECT_EQ(refused("[[1,0,0],[1,0]]").where(), "field, direction 1");
  EXPECT_EQ(refused("[[1,0,\"0\"],[1,0,0]]").where(), "field, direction 0");
}

TEST(FieldFile, GarbageIsRefused) {
  for (const char* text : {"",
                           " \n",
                           "x",
                           "-2 4",
                           "2",
                           "2 4",
                           "99999999999999999999999 4",
                           "2 4 1e999 0 0 0 0 0",
                           "2,4,1,0,0",
                           "{",
                           "{}",
                           "[",
                           "[[1,0,0],[1,0,0]",
                           "[1,2]",
                           "[[1,0,0],[1,0,0]]x",
                           "{\"directions\":3}",
                           "[[1,0,0],{}]",
                           R"({"directions":[[1,0,0],[1,0,0]],"per":"edge"})",
                           R"({"directions":[[1,0,0],[1,0,0]],"more":1})",
                           "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["})
    (void)refused(text);
}

// Cut short and changed anywhere: an error or a field of the right size, never anything else.
TEST(FieldFile, DamagedFilesNeverGetThrough) {
  std::mt19937 random(7);
  for (const std::string& whole : {std::string("2\n4\n0.5 -0.25 1e-3\n-1 0 0\n"),
                                   std::string(R"({"per":"face","directions":[[1,0,0],[0,-2.5e1,0]]})")}) {
    std::vector<std::string> texts;
    for (std::size_t n = 0; n < whole.size(); ++n) texts.push_back(whole.substr(0, n));
    for (int i = 0; i < 4000; ++i) {
      std::string text = whole;
      for (std::uint32_t k = random() % 3 + 1; k > 0; --k)
        text[random() % text.size()] = static_cast<char>(random());
      texts.push_back(text);
    }
    for (const std::string& text : texts) try {
        const UserField f = read(text);
        EXPECT_TRUE(f.per_face.size() == kFaces || f.per_vertex.size() == kVertices);
        for (const auto& list : {f.per_face, f.per_vertex})
          for (const Vector3& d : list) EXPECT_TRUE(d.isZero(0) || std::abs(d.norm() - 1) < 1e-12);
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
      }
  }
}

TEST(InputBundle, ComesApartAsItWasPutTogether) {
  for (const std::string& field : {std::string("2 4"), std::string("x"), std::string(1000, '\n')})
    for (const std::string& mesh : {std::string(), std::string("v 0 0 0\n"), std::string(100, '\0')}) {
      const std::string whole = mesh + after_mesh(mesh.size(), field);
      EXPECT_EQ(split_bundle(whole).mesh, mesh);
      EXPECT_EQ(split_bundle(whole).field, field);
      EXPECT_EQ(mesh_bytes_of(whole.size(), whole.substr(whole.size() - kTailBytes)), mesh.size());
    }
  EXPECT_EQ(after_mesh(5, ""), "");
}

TEST(InputBundle, AnythingElseIsAMesh) {
  const std::string good = "mesh" + after_mesh(4, "field");
  for (std::string other : {std::string(), std::string("v 0 0 0\n"), good + " ", good.substr(1),
                            good.substr(0, good.size() - 1)}) {
    if (other.size() > 4 && other == good.substr(1))
      continue;  // a mesh that is a byte shorter is cut elsewhere
    EXPECT_EQ(split_bundle(other).mesh, other);
  }
  std::string lie = good;
  lie[lie.size() - 21] = '9';  // longer than the whole
  EXPECT_EQ(split_bundle(lie).mesh, lie);
}

TEST(Inspect, ReadsTheFieldToo) {
  const std::string mesh = "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 6\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  const api::Json parameters = api::complete_parameters(api::Json::object());
  const api::MeshInfo info =
      inspect_mesh(mesh + after_mesh(mesh.size(), "4 4 1 0 0 1 0 0 1 0 0 1 0 0"), "t.obj", parameters);
  EXPECT_EQ(info.bytes, static_cast<std::int64_t>(mesh.size()));
  EXPECT_EQ(info.faces, 4);
  EXPECT_THROW((void)inspect_mesh(mesh + after_mesh(mesh.size(), "1 4 1 0 0"), "t.obj", parameters), Error);
}

}  // namespace
}  // namespace sheetform::server
