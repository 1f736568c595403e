#include "server/http/multipart.h"

#include <gtest/gtest.h>

namespace sheetform::server {
namespace {

struct Part {
  PartHead head;
  std::string data;
};

/// Reads a body that comes in pieces of the given size; the parts, or what is wrong.
struct Reading {
  std::vector<Part> parts;
  std::string error;
  int open = 0;  ///< parts begun and not ended
};
Reading read(const std::string& body, std::size_t piece, const std::string& boundary = "bd") {
  Reading r;
  MultipartReader reader(boundary,
                         {[&](const PartHead& h) {
                            r.parts.push_back({h, ""}), ++r.open;
                          },
                          [&](std::string_view d) { r.parts.back().data += d; }, [&] { --r.open; }});
  bool good = true;
  for (std::size_t at = 0; good && at < body.size(); at += piece)
    good = reader.add(std::string_view(body).substr(at, piece));
  if (!good || !reader.complete()) r.error = reader.error();
  return r;
}

std::string part(const std::string& disposition, const std::string& data) {
  return "--bd\r\nContent-Disposition: form-data; " + disposition + "\r\n\r\n" + data + "\r\n";
}

TEST(Multipart, GivesTheSameHoweverItIsCut) {
  // The data holds all beginnings of a delimiter.
  const std::string data = "a\r\n--b\r\n--bx\r\n-\r\n\r\n--";
  const std::string body = "preamble\r\n" + part("name=\"mesh\"; filename=\"a b.obj\"", data) +
                           part("name=e_max", "") + "--bd--\r\nepilogue\r\n--bd\r\n";
  for (std::size_t piece = 1; piece <= body.size(); ++piece) {
    const Reading r = read(body, piece);
    ASSERT_EQ(r.error, "") << piece;
    ASSERT_EQ(r.parts.size(), 2u) << piece;
    EXPECT_EQ(r.parts[0].data, data);
    EXPECT_EQ(r.parts[0].head.filename, "a b.obj");
    EXPECT_TRUE(r.parts[0].head.is_file);
    EXPECT_EQ(r.parts[1].head.name, "e_max");
    EXPECT_EQ(r.parts[1].data, "");
    EXPECT_EQ(r.open, 0);
  }
}

TEST(Multipart, EveryTruncationIsBroken) {
  const std::string body = part("name=\"a\"", "data") + "--bd--";
  for (std::size_t cut = 0; cut < body.size(); ++cut)
    EXPECT_NE(read(body.substr(0, cut), 1).error, "") << cut;
  EXPECT_EQ(read(body, 1).error, "");
}

TEST(Multipart, WrongHeadsAreBroken) {
  for (const char* head :
       {"", "Content-Type: a/b", "Content-Disposition: form-data", "Content-Disposition: attachment; name=a",
        "Content-Disposition: form-data; name=\"a", "Content-Disposition: form-data; name", "no colon",
        "Content-Disposition: form-data; name=a\r\nContent-Disposition: form-data; name=b",
        "Content-Disposition: form-data; name=a\r\nContent-Transfer-Encoding: base64"})
    EXPECT_NE(read(std::string("--bd\r\n") + head + "\r\n\r\nx\r\n--bd--", 7).error, "") << head;
}

TEST(Multipart, SomethingElseAfterABoundaryIsBroken) {
  EXPECT_NE(read("--bdx\r\n", 3).error, "");
  EXPECT_NE(read("--bd\nContent-Disposition: form-data; name=a\n\nx\n--bd--", 3).error, "");
}

TEST(Multipart, Boundaries) {
  EXPECT_EQ(multipart_boundary("multipart/form-data; boundary=abc"), "abc");
  EXPECT_EQ(multipart_boundary("Multipart/Form-Data ; Boundary=\"a b\"; charset=utf-8"), "a b");
  for (const std::string& type :
       {std::string("multipart/form-data"), std::string("multipart/mixed; boundary=a"),
        std::string("multipart/form-data; boundary="), std::string("multipart/form-data; boundary=\"\""),
        std::string("multipart/form-data; boundary=a; boundary=b"),
        std::string("multipart/form-data; boundary=\"a\r\nb\""),
        std::string("multipart/form-data; boundary=\"a "),
        "multipart/form-data; boundary=" + std::string(71, 'a'),
        std::string("multipart/form-data; boundary=\"a \"")})
    EXPECT_EQ(multipart_boundary(type), "") << type;
}

TEST(DisplayName, KeepsNothingHarmful) {
  EXPECT_EQ(display_name("bunny.obj"), "bunny.obj");
  EXPECT_EQ(display_name("../../etc/passwd"), "passwd");
  EXPECT_EQ(display_name("C:\\meshes\\a.stl"), "a.stl");
  EXPECT_EQ(display_name("..hidden"), "hidden");
  EXPECT_EQ(display_name("a\r\nb\0c"), "ab");
  EXPECT_EQ(display_name("a\xe2\x80\xae"
                         "jbo.exe"),
            "ajbo.exe");  // right-to-left override
  EXPECT_EQ(display_name("caf\xc3\xa9.obj"), "caf\xc3\xa9.obj");
  EXPECT_EQ(display_name("bad\xff\xc3.obj"), "bad.obj");
  EXPECT_EQ(display_name("\xed\xa0\x80x"), "x");  // a surrogate
  EXPECT_EQ(display_name(""), "");
  EXPECT_LE(display_name(std::string(1000, 'a')).size(), 128u);
}

}  // namespace
}  // namespace sheetform::server
