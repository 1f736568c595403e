#include "sheetform/mesh/mesh_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>

#include "sheetform/base/error.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

using testing::HasSubstr;
using Faces = std::vector<std::array<int, 3>>;

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

template <class T>
void put(std::string& out, T value, bool big = false) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
  out.append(bytes.data(), bytes.size());
}

std::string text_of(double x) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, x).ptr};
}
std::string text_of(const Vector3& p) { return text_of(p.x()) + ' ' + text_of(p.y()) + ' ' + text_of(p.z()); }

std::string as_off(const TriangleSoup& s) {
  std::string t = "OFF\n" + std::to_string(s.points.size()) + ' ' + std::to_string(s.faces.size()) + " 0\n";
  for (const Vector3& p : s.points) t += text_of(p) + '\n';
  for (const auto& f : s.faces)
    t += "3 " + std::to_string(f[0]) + ' ' + std::to_string(f[1]) + ' ' + std::to_string(f[2]) + '\n';
  return t;
}

std::string ply_header(const TriangleSoup& s, const std::string& format) {
  return "ply\nformat " + format + " 1.0\ncomment made by a test\nelement vertex " +
         std::to_string(s.points.size()) +
         "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nelement face " +
         std::to_string(s.faces.size()) +
         "\nproperty int flag\nproperty list uchar int vertex_indices\nelement other 2\nproperty list uint "
         "short data\nend_header\n";
}
std::string as_ply_text(const TriangleSoup& s) {
  std::string t = ply_header(s, "ascii");
  for (const Vector3& p : s.points) t += text_of(p) + " 255\n";
  for (const auto& f : s.faces)
    t += "7 3 " + std::to_string(f[0]) + ' ' + std::to_string(f[1]) + ' ' + std::to_string(f[2]) + '\n';
  return t + "2 1 2\n0\n";
}
std::string as_ply_binary(const TriangleSoup& s, bool big) {
  std::string t = ply_header(s, big ? "binary_big_endian" : "binary_little_endian");
  for (const Vector3& p : s.points) {
    for (int k = 0; k < 3; ++k) put(t, p[k], big);
    t += '\xFF';
  }
  for (const auto& f : s.faces) {
    put(t, std::int32_t{-7}, big);
    t += '\3';
    for (int v : f) put(t, std::int32_t{v}, big);
  }
  put(t, std::uint32_t{2}, big), put(t, std::int16_t{1}, big), put(t, std::int16_t{-1}, big),
      put(t, std::uint32_t{0}, big);
  return t;
}

std::string as_stl_text(const TriangleSoup& s) {
  std::string t = "solid test\r\n";
  for (const auto& f : s.faces) {
    t += "facet normal nan 0 0\r\nouter loop\r\n";
    for (int v : f) t += "vertex " + text_of(s.points[v]) + "\r\n";
    t += "endloop\r\nendfacet\r\n";
  }
  return t + "endsolid test\r\n";
}
std::string as_stl_binary(const TriangleSoup& s, std::string head = "solid, says the head of a binary file") {
  head.resize(80);
  put(head, static_cast<std::uint32_t>(s.faces.size()));
  for (const auto& f : s.faces) {
    for (int k = 0; k < 3; ++k) put(head, 0.0f);
    for (int v : f)
      for (int k = 0; k < 3; ++k) put(head, static_cast<float>(s.points[v][k]));
    put(head, std::uint16_t{0});
  }
  return head;
}

void expect_equal(const TriangleSoup& a, const TriangleSoup& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_EQ(a.points[i], b.points[i]);
  EXPECT_EQ(a.faces, b.faces);
}

// STL numbers its vertices in the order of the facets.
TriangleSoup in_facet_order(const TriangleSoup& s) {
  TriangleSoup t;
  std::vector<int> id(s.points.size(), -1);
  for (auto f : s.faces) {
    for (int& v : f) {
      if (id[v] < 0) id[v] = static_cast<int>(t.points.size()), t.points.push_back(s.points[v]);
      v = id[v];
    }
    t.faces.push_back(f);
  }
  return t;
}

TEST(MeshIo, EveryFormatGivesTheSameDoubles) {
  TriangleSoup s = shapes::torus(8, 6);
  for (Vector3& p : s.points) p = p * 0.123456789012345 + Vector3(0, 0, 1e-7);
  expect_equal(read_mesh(write_obj(s)).soup, s);
  expect_equal(read_mesh(as_off(s)).soup, s);
  expect_equal(read_mesh(as_ply_text(s)).soup, s);
  expect_equal(read_mesh(as_ply_binary(s, false)).soup, s);
  expect_equal(read_mesh(as_ply_binary(s, true)).soup, s);
  expect_equal(read_mesh(as_stl_text(s)).soup, in_facet_order(s));
  for (Vector3& p : s.points)
    for (double& x : p) x = static_cast<float>(x);
  expect_equal(read_mesh(as_stl_binary(s)).soup, in_facet_order(s));
}

TEST(MeshIo, TheContentTellsTheFormatWhateverTheName) {
  const TriangleSoup s = shapes::box(1, {1, 1, 1});
  EXPECT_EQ(read_mesh(write_obj(s), "mesh.stl").format, "obj");
  EXPECT_EQ(read_mesh(as_off(s), "mesh.obj").format, "off");
  EXPECT_EQ(read_mesh(as_ply_binary(s, true), "mesh").format, "ply");
  EXPECT_EQ(read_mesh(as_stl_text(s), "mesh.PLY").format, "stl");
  EXPECT_EQ(read_mesh(as_stl_binary(s), "mesh.off").format, "stl");
  EXPECT_EQ(read_mesh("# a comment first\n\n" + write_obj(s)).format, "obj");
  EXPECT_EQ(read_mesh("\xEF\xBB\xBF" + write_obj(s)).format, "obj");
}

TEST(MeshIo, ObjFormsOfFaces) {
  const Faces triangle{{0, 1, 2}};
  EXPECT_EQ(read_mesh(kTriangle + "f 1 2 3\n").soup.faces, triangle);
  EXPECT_EQ(read_mesh(kTriangle + "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1").soup.faces, triangle);
  EXPECT_EQ(read_mesh(kTriangle + "f 1//7 2//7 3//7\n").soup.faces, triangle);
  EXPECT_EQ(read_mesh(kTriangle + "f 1/ 2/1/ 3/1\n").soup.faces, triangle);
  EXPECT_EQ(read_mesh(kTriangle + "f -3 -2 -1\n").soup.faces, triangle);
  EXPECT_EQ(read_mesh(kTriangle + "v 9 9 9 1 0.5 nan\nf -4 -3 -2 # and a comment\n").soup.faces, triangle);
  EXPECT_EQ(read_mesh(kTriangle + "f 1 \\\n 2\\\n 3\nmtllib ../../../dev/zero\n").soup.faces, triangle);
  EXPECT_EQ(read_mesh("f 1 2 3\n" + kTriangle).soup.faces, triangle)
      << "faces may stand before their vertices";
  EXPECT_EQ(read_mesh("mtllib C:\\models\\\n" + kTriangle + "f 1 2 3\n").soup.points.size(), 3u);
  EXPECT_EQ(read_mesh("# in C:\\models\\\n" + kTriangle + "f 1 2 3\n").soup.points.size(), 3u);
}

TEST(MeshIo, EndsOfLines) {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    std::string text;
    for (const char c : kTriangle + "f 1 2 3\n") text += c == '\n' ? std::string(end) : std::string(1, c);
    EXPECT_EQ(read_mesh(text).soup.faces, (Faces{{0, 1, 2}}));
    std::string ply;
    for (const char c : as_ply_text(shapes::plane(1)))
      ply += c == '\n' ? std::string(end) : std::string(1, c);
    EXPECT_EQ(read_mesh(ply).soup.faces.size(), 2u);
  }
}

TEST(MeshIo, BinaryPlyKeepsAFirstByteThatLooksLikeAnEndOfLine) {
  const std::string head =
      "ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty float x\rproperty float y\rproperty "
      "uchar z\r"
      "element face 1\rproperty list uchar uchar vertex_index\rend_header\r";
  std::string body;
  const std::uint32_t bits = 0x3F80000A;  // its first byte is LF
  for (int k = 0; k < 3; ++k)
    put(body, bits), put(body, static_cast<float>(k * k)), put(body, static_cast<std::uint8_t>(k));
  const MeshFile file = read_mesh(head + body + "\3" + std::string("\0\1\2", 3));
  EXPECT_EQ(file.soup.points[2], Vector3(std::bit_cast<float>(bits), 4, 2));
}

TEST(MeshIo, OffVariants) {
  const std::string body = "0 0 0 9 9 9\n1 0 0 9 9 9\n0 1 0 9 9 9\n3 0 1 2 255 0 0\n";
  EXPECT_EQ(read_mesh("NOFF\n3 1 0\n" + body).soup.faces, (Faces{{0, 1, 2}}));
  EXPECT_EQ(read_mesh("# c\nCOFF # c\n3 1 0\n" + body).soup.faces, (Faces{{0, 1, 2}}));
  EXPECT_EQ(read_mesh("OFF 3 1 0\n" + body).soup.faces, (Faces{{0, 1, 2}}));
  EXPECT_EQ(read_mesh("OFF3 1 0\n\n" + body).soup.faces, (Faces{{0, 1, 2}}));
  EXPECT_EQ(read_mesh("3 1 0\n" + body, "x.off").soup.faces, (Faces{{0, 1, 2}}));
}

TEST(MeshIo, PlyStrips) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 2 3 4\n";
  EXPECT_EQ(read_mesh(text).soup.faces, (Faces{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {2, 3, 4}}));
}

double area(const TriangleSoup& s) {
  double sum = 0;
  for (const auto& f : s.faces)
    sum += (s.points[f[1]] - s.points[f[0]]).cross(s.points[f[2]] - s.points[f[0]]).z() / 2;
  return sum;
}

TEST(MeshIo, ConcavePolygonsAreCutInside) {
  // A comb with five teeth: the fan of any corner would fold over itself; all triangles must be
  // counter-clockwise.
  std::vector<Vector2> comb;
  for (int k = 0; k < 5; ++k)
    comb.insert(comb.end(), {{2.0 * k, 3}, {2.0 * k, 0}, {2.0 * k + 1, 0}, {2.0 * k + 1, 3}});
  comb.insert(comb.end(), {{9, 4}, {0, 4}});
  std::string text, face = "f";
  for (std::size_t i = 0; i < comb.size(); ++i) {
    text += "v " + text_of(Vector3(comb[i].x(), comb[i].y(), 0)) + '\n';
    face += ' ' + std::to_string(i + 1);
  }
  const MeshFile file = read_mesh(text + face + '\n');
  EXPECT_EQ(file.soup.faces.size(), comb.size() - 2);
  EXPECT_NEAR(area(file.soup), 5 * 3 + 9, 1e-12);
  for (const auto& f : file.soup.faces) EXPECT_GT(area({file.soup.points, {f}}), 0);
  EXPECT_THAT(file.notes, testing::ElementsAre(HasSubstr("1 faces with more than three corners")));
}

TEST(MeshIo, TrianglesKnowTheirPolygon) {
  const MeshFile file = read_mesh(kTriangle + "v 1 1 0\nf 1 2\nf 1 2 4 3\nf 1 2 3\n");
  EXPECT_EQ(file.polygon, (std::vector<int>{1, 1, 2}));
  EXPECT_EQ(file.notes.size(), 2u);
}

TEST(MeshIo, TinyAndNegativeZeroBecomeZero) {
  const MeshFile file = read_mesh("v -0 1e-320 1e-400\nv 1 0 +2.5\nv 0 1 0\nf 1 2 3\n");
  for (int k = 0; k < 3; ++k) EXPECT_EQ(std::bit_cast<std::uint64_t>(file.soup.points[0][k]), 0u);
  EXPECT_EQ(file.soup.points[1].z(), 2.5);
}

struct Bad {
  const char* name;
  std::string bytes, hint;
  ErrorCode code;
  const char* text;   // part of the summary
  const char* where;  // part of the place
};
void PrintTo(const Bad& b, std::ostream* out) { *out << b.name; }

class BadMesh : public testing::TestWithParam<Bad> {};

TEST_P(BadMesh, IsRefusedWithPlaceAndReason) {
  const Bad& b = GetParam();
  try {
    read_mesh(b.bytes, b.hint);
    FAIL() << "was read";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), b.code) << e.what();
    EXPECT_THAT(e.summary(), HasSubstr(b.text));
    EXPECT_THAT(e.where(), HasSubstr(b.where));
  }
}

const std::string kPly = "ply\nformat ascii 1.0\n";
const std::string kPlyXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kPlyFace = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kThree = "0 0 0\n1 0 0\n0 1 0\n";
constexpr auto kBad = ErrorCode::kUnreadableMesh;
constexpr auto kLimit = ErrorCode::kLimitExceeded;
std::string cut(std::string text, std::size_t bytes) { return text.substr(0, text.size() - bytes); }

INSTANTIATE_TEST_SUITE_P(
    General, BadMesh,
    testing::Values(Bad{"empty", "", "", kBad, "empty", ""},
                    Bad{"blank", " \n\n", "a.obj", kBad, "empty", ""},
                    Bad{"text", "Dear all,\nhello", "", kBad, "no OBJ, STL, PLY or OFF", "line 1"},
                    Bad{"textAsObj", "# x\nDear all,\n", "a.obj", kBad, "no OBJ", "line 2"},
                    Bad{"zip", "PK\x03\x04 etc", "a.3mf", kBad, "ZIP", ""},
                    Bad{"utf16", "\xFF\xFEv", "a.obj", kBad, "UTF-16", ""},
                    Bad{"html", "<html>", "a.obj", kBad, "HTML", ""}),
    [](const auto& i) { return std::string(i.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Obj, BadMesh,
    testing::Values(
        Bad{"comma", "v 0 0,5 0\n", "", kBad, "0,5", "line 1"},
        Bad{"nan", kTriangle + "v nan 0 0\n", "", kBad, "finite", "line 4"},
        Bad{"inf", "v 0 0 0\r\nv 0 inf 0\r\n", "", kBad, "finite", "line 2"},
        Bad{"overflow", "v 0 1e999 0\n", "", kBad, "finite", "line 1"},
        Bad{"hex", "v 0 0x10 0\n", "", kBad, "no number", "line 1"},
        Bad{"large", "v 0 1e10 0\n", "", kLimit, "1e+10", "line 1"},
        Bad{"short", "v 0 1\n", "", kBad, "three", "line 1"},
        Bad{"zero", kTriangle + "f 0 1 2\n", "", kBad, "vertex 0", "line 4"},
        Bad{"high", kTriangle + "\nf 1 2 4\n", "", kBad, "vertex 4", "line 5"},
        Bad{"negative", kTriangle + "f -4 1 2\n", "", kBad, "vertex -4", "line 4"},
        Bad{"huge", kTriangle + "f 1 2 99999999999999999999\n", "", kBad, "no vertex number", "line 4"},
        Bad{"emptyCorner", kTriangle + "f /1/1 2 3\n", "", kBad, "'/1/1'", "line 4"},
        Bad{"fraction", kTriangle + "f 1 2 2.5\n", "", kBad, "2.5", "line 4"},
        Bad{"slashes", kTriangle + "f 1/1/1/1 2 3\n", "", kBad, "more than three", "line 4"},
        Bad{"continued", kTriangle + "f 1 \\\n2 \\\nx\n", "", kBad, "'x'", "line 6"},
        Bad{"noFaces", kTriangle, "", ErrorCode::kUnsupportedMesh, "3 vertices, but no faces", ""},
        Bad{"onlyComments", "# Blender\n", "a.obj", ErrorCode::kUnsupportedMesh, "neither vertices nor faces",
            ""}),
    [](const auto& i) { return std::string(i.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Off, BadMesh,
    testing::Values(
        Bad{"hugeCount", "OFF\n3 4294967295 0\n" + kThree, "", kBad, "4294967295", "line 2"},
        Bad{"hugeVertices", "OFF\n99999999999999 1 0\n" + kThree, "", kBad, "99999999999999", "line 2"},
        Bad{"negativeCount", "OFF\n-3 1 0\n" + kThree, "", kBad, "number of vertices", "line 2"},
        Bad{"negativeSides", "OFF\n3 1 0\n" + kThree + "-3 0 1 2\n", "", kBad, "corners of a face", "line 6"},
        Bad{"hugeSides", "OFF\n3 1 0\n" + kThree + "2000000000 0 1 2\n", "", kLimit, "corners", "line 6"},
        Bad{"fewVertices", "OFF\n4 1 0\n" + kThree + "3 0 1 2\n", "", kBad, "ends after 0 faces", "line 7"},
        Bad{"fewFaces", "OFF\n3 2 0\n" + kThree + "3 0 1 2\n", "", kBad, "ends after 1 faces", "line 7"},
        Bad{"cutFace", "OFF\n3 1 0\n" + kThree + "3 0 1", "", kBad, "the file ends", "line 6"},
        Bad{"index", "OFF\n3 1 0\n" + kThree + "3 0 1 3\n", "", kBad, "vertex 3", "line 6"},
        Bad{"minus", "OFF\n3 1 0\n" + kThree + "3 0 1 -1\n", "", kBad, "vertex -1", "line 6"},
        Bad{"binary", "OFF BINARY\n\1\2", "", kBad, "binary OFF", "line 1"},
        Bad{"fourDimensions", "4OFF\n1 1 0\n", "", kBad, "dimensions", "line 1"}),
    [](const auto& i) { return std::string(i.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Ply, BadMesh,
    testing::Values(
        Bad{"noEnd", kPly + "element vertex 3\n", "", kBad, "end_header", "line 4"},
        Bad{"noFormat", "ply\nend_header\n", "", kBad, "no format", "line 2"},
        Bad{"format", "ply\nformat binary_pdp 1.0\n", "", kBad, "binary_pdp", "line 2"},
        Bad{"type", kPly + "element vertex 3\nproperty quad x\n", "", kBad, "quad", "line 4"},
        Bad{"early", kPly + "property float x\n", "", kBad, "before any element", "line 3"},
        Bad{"count", kPly + "element vertex -3\n", "", kBad, "no count", "line 3"},
        Bad{"hugeCount", kPly + "element vertex 4294967295\n" + kPlyXyz + kPlyFace + kThree, "", kBad,
            "4294967295", "line 10"},
        Bad{"noZ", kPly + "element vertex 1\nproperty float x\nproperty float y\n" + kPlyFace + "0 0\n", "",
            kBad, "x, y and z", "header"},
        Bad{"noList",
            kPly + "element vertex 1\n" + kPlyXyz + "element face 1\nproperty int a\nend_header\n0 0 0\n3\n",
            "", kBad, "list", "header"},
        Bad{"longList", kPly + "element vertex 3\n" + kPlyXyz + kPlyFace + kThree + "200 0 1 2\n", "", kBad,
            "longer", "line 13"},
        Bad{"minusList", kPly + "element vertex 3\n" + kPlyXyz + kPlyFace + kThree + "-1 0 1 2\n", "", kBad,
            "no count", "line 13"},
        Bad{"nan", kPly + "element vertex 3\n" + kPlyXyz + kPlyFace + "0 nan 0\n1 0 0\n0 1 0\n3 0 1 2\n", "",
            kBad, "finite", "line 10"},
        Bad{"word", kPly + "element vertex 3\n" + kPlyXyz + kPlyFace + "0 x 0\n1 0 0\n0 1 0\n3 0 1 2\n", "",
            kBad, "'x'", "line 10"},
        Bad{"index", kPly + "element vertex 3\n" + kPlyXyz + kPlyFace + kThree + "3 0 1 3\n", "", kBad,
            "vertex 3", "line 13"},
        Bad{"cutBinary", cut(as_ply_binary(shapes::plane(1), false), 2), "", kBad, "early", "byte"},
        Bad{"floatLength", kPly + "element face 1\nproperty list float int vertex_indices\n", "", kBad,
            "float", "line 4"},
        Bad{"notPly", "plyformat", "a.ply", kBad, "begins with", "line 1"}),
    [](const auto& i) { return std::string(i.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Stl, BadMesh,
    testing::Values(
        Bad{"hugeCount", std::string(80, '\0') + "\xFF\xFF\xFF\xFF", "a.stl", kBad, "4294967295 facets",
            "byte 80"},
        Bad{"short", std::string(20, '\0'), "a.stl", kBad, "at least 84", "byte 20"},
        Bad{"cutBinary", cut(as_stl_binary(shapes::plane(2)), 51), "", kBad, "8 facets", "byte 80"},
        Bad{"cutText", cut(as_stl_text(shapes::plane(1)), 34), "", kBad, "inside a facet", "line"},
        Bad{"nan", "solid\nfacet normal 0 0 1\nouter loop\nvertex nan 0 0\n", "", kBad, "finite", "line 4"},
        Bad{"twoCorners",
            "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\n", "",
            kBad, "less than three", "line 7"},
        Bad{"noFacet", "solid\nvertex 0 0 0\n", "", kBad, "outside", "line 2"},
        Bad{"nested", "solid\nfacet normal 0 0 1\nfacet\n", "", kBad, "inside another", "line 3"},
        Bad{"word", "solid\nfacet normal 0 0 1\nouter lop\n", "", kBad, "'lop'", "line 3"},
        Bad{"noNormal", "solid\nfacet\nouter loop\n", "", kBad, "normal", "line 3"}),
    [](const auto& i) { return std::string(i.param.name); });

TEST(MeshIo, BinaryStlRefusesNan) {
  TriangleSoup s = shapes::plane(1);
  s.points[1].y() = std::nan("");
  try {
    read_mesh(as_stl_binary(s));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kUnreadableMesh);
    EXPECT_EQ(e.where(), "byte " + std::to_string(84 + 12 + 12 + 4));
  }
}

ErrorCode code_with(const std::string& bytes, const ReadLimits& limits) {
  try {
    read_mesh(bytes, {}, limits);
  } catch (const Error& e) {
    return e.code();
  }
  return ErrorCode::kInternal;
}

TEST(MeshIo, LimitsAreKeptByEveryReader) {
  const TriangleSoup s = shapes::plane(4);  // 25 vertices, 32 faces
  for (const std::string& bytes :
       {write_obj(s), as_off(s), as_ply_text(s), as_ply_binary(s, false), as_stl_text(s), as_stl_binary(s)}) {
    EXPECT_NO_THROW(read_mesh(bytes, {}, {.bytes = bytes.size(), .vertices = 25, .faces = 32}));
    EXPECT_EQ(code_with(bytes, {.bytes = bytes.size() - 1}), ErrorCode::kLimitExceeded);
    EXPECT_EQ(code_with(bytes, {.vertices = 24}), ErrorCode::kLimitExceeded);
    EXPECT_EQ(code_with(bytes, {.faces = 31}), ErrorCode::kLimitExceeded);
    EXPECT_EQ(code_with(bytes, {.coordinate = 0.5}), ErrorCode::kLimitExceeded);
  }
  EXPECT_EQ(code_with(kTriangle + "f 1 2 3 1 2\n", {.polygon_sides = 4}), ErrorCode::kLimitExceeded);
}

// Cutting a file at every byte: either it is refused with an Error or a mesh comes out; nothing else happens.
TEST(MeshIo, EveryTruncationIsSurvived) {
  const TriangleSoup s = shapes::plane(2);
  for (const std::string& bytes :
       {write_obj(s), as_off(s), as_ply_text(s), as_ply_binary(s, true), as_stl_text(s), as_stl_binary(s)})
    for (std::size_t n = 0; n < bytes.size(); ++n) {
      try {
        const MeshFile file = read_mesh(std::string_view(bytes).substr(0, n), "x.stl");
        for (const auto& f : file.soup.faces)
          for (int v : f) ASSERT_LT(v, static_cast<int>(file.soup.points.size()));
      } catch (const Error& e) {
        ASSERT_TRUE(e.code() == ErrorCode::kUnreadableMesh || e.code() == ErrorCode::kUnsupportedMesh)
            << e.what();
      }
    }
}

TEST(MeshIo, AHeaderCannotMakeItAllocate) {
  // With honest allocation these would need gigabytes; the limits are set out of the way.
  const ReadLimits open{.bytes = ~0ull, .vertices = ~0ull, .faces = ~0ull, .polygon_sides = ~0ull};
  EXPECT_EQ(code_with("OFF\n9000000000 9000000000 0\n" + kThree, open), ErrorCode::kUnreadableMesh);
  EXPECT_EQ(code_with(kPly + "element vertex 9000000000\n" + kPlyXyz + kPlyFace, open),
            ErrorCode::kUnreadableMesh);
  EXPECT_EQ(code_with("OFF\n3 1 0\n" + kThree + "9000000000 0 1 2\n", open), ErrorCode::kUnreadableMesh);
}

TEST(MeshIo, MissingFileAndFolder) {
  EXPECT_THROW(read_mesh_file("no/such/file.obj"), Error);
  EXPECT_THROW(read_mesh_file("."), Error);
}

}  // namespace
}  // namespace sheetform
