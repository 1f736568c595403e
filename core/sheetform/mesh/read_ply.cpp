// Stanford PLY: text and both byte orders, any elements and properties; vertices, faces and triangle strips
// are kept.
#include <algorithm>
#include <array>
#include <bit>

#include "sheetform/mesh/mesh_read.h"

namespace sheetform::reading {
namespace {

enum class Kind { kSigned, kUnsigned, kFloat };
struct Type {
  Kind kind = Kind::kSigned;
  unsigned bytes = 0;
};
struct Property {
  std::string name;
  Type type, count_type;
  bool list = false;
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};
enum class Encoding { kText, kLittle, kBig };
struct Header {
  Encoding encoding = Encoding::kText;
  std::vector<Element> elements;
  std::size_t body = 0;   // byte
  std::int64_t line = 1;  // of the body, when it is text
};

Type parse_type(std::string_view name, const Scanner& in) {
  static const std::array<std::pair<std::string_view, Type>, 16> kTypes{{{"char", {Kind::kSigned, 1}},
                                                                         {"int8", {Kind::kSigned, 1}},
                                                                         {"uchar", {Kind::kUnsigned, 1}},
                                                                         {"uint8", {Kind::kUnsigned, 1}},
                                                                         {"short", {Kind::kSigned, 2}},
                                                                         {"int16", {Kind::kSigned, 2}},
                                                                         {"ushort", {Kind::kUnsigned, 2}},
                                                                         {"uint16", {Kind::kUnsigned, 2}},
                                                                         {"int", {Kind::kSigned, 4}},
                                                                         {"int32", {Kind::kSigned, 4}},
                                                                         {"uint", {Kind::kUnsigned, 4}},
                                                                         {"uint32", {Kind::kUnsigned, 4}},
                                                                         {"float", {Kind::kFloat, 4}},
                                                                         {"float32", {Kind::kFloat, 4}},
                                                                         {"double", {Kind::kFloat, 8}},
                                                                         {"float64", {Kind::kFloat, 8}}}};
  for (const auto& [known, type] : kTypes)
    if (known == name) return type;
  unreadable("no type of PLY: " + shown(name), in.where());
}

Encoding parse_encoding(std::string_view name, const Scanner& in) {
  if (name == "ascii") return Encoding::kText;
  if (name == "binary_little_endian") return Encoding::kLittle;
  if (name == "binary_big_endian") return Encoding::kBig;
  unreadable("no format of PLY: " + shown(name), in.where());
}

Element parse_element(Scanner& in) {
  Element element;
  element.name = in.word();
  const std::string_view word = in.word();
  const std::optional<std::int64_t> count = parse_integer(word);
  if (!count || *count < 0)
    unreadable("the number of '" + element.name.substr(0, 40) + "' is no count: " + shown(word), in.where());
  element.count = static_cast<std::uint64_t>(*count);
  return element;
}

Property parse_property(Scanner& in) {
  Property property;
  std::string_view word = in.word();
  if (word == "list") {
    property.list = true;
    property.count_type = parse_type(in.word(), in);
    if (property.count_type.kind == Kind::kFloat) unreadable("the length of a list is a float", in.where());
    word = in.word();
  }
  property.type = parse_type(word, in);
  property.name = in.word();
  if (property.name.empty()) unreadable("a property has no name", in.where());
  return property;
}

// The byte after the line of end_header. A CR-only header must not swallow a first body byte that happens to
// be LF.
std::size_t body_begin(std::string_view bytes, const Scanner& in) {
  const bool cr_only = bytes.size() > 4 && bytes[3] == '\r' && bytes[4] != '\n';
  std::size_t at = static_cast<std::size_t>(in.position() - bytes.data());
  while (at < bytes.size() && (bytes[at] == ' ' || bytes[at] == '\t')) ++at;
  if (at < bytes.size() && bytes[at] == '\r' && !cr_only && at + 1 < bytes.size() && bytes[at + 1] == '\n')
    ++at;
  return std::min(bytes.size(), at + 1);
}

Header parse_header(std::string_view bytes) {
  Header header;
  Scanner in(bytes, kNoComment, false);
  in.next_line();
  bool format = false;
  for (;; in.next_line()) {
    if (in.at_end())
      unreadable("the header has no end_header", in.where(), "the file is cut off: export the mesh again");
    const std::string_view key = in.word();
    if (key == "end_header") break;
    if (key == "format")
      header.encoding = parse_encoding(in.word(), in), format = true;
    else if (key == "element")
      header.elements.push_back(parse_element(in));
    else if (key == "property" && header.elements.empty())
      unreadable("a property before any element", in.where());
    else if (key == "property")
      header.elements.back().properties.push_back(parse_property(in));
    else if (!key.empty() && key != "comment" && key != "obj_info")
      unreadable("no word of a PLY header: " + shown(key), in.where());
  }
  if (!format) unreadable("the header has no format", in.where());
  header.body = body_begin(bytes, in);
  header.line = in.line() + 1;
  return header;
}

// Values one after the other from a text body.
class TextBody {
 public:
  TextBody(std::string_view bytes, std::int64_t line) : in_(bytes, kNoComment, false, line) {}
  double value(Type) {
    const std::string_view word = in_.word_on_any_line();
    const std::optional<double> number = parse_number(word);
    if (word.empty())
      unreadable("the file ends too early", where(), "the file is cut off: export the mesh again");
    if (!number)
      unreadable("no number: " + shown(word), where(), "correct the line or export the mesh again");
    return *number;
  }
  static std::uint64_t min_bytes(Type) { return 2; }
  std::uint64_t bytes_left() const {
    return in_.bytes_left() + 1;
  }  // the last value needs no blank behind it
  std::string where() const { return in_.where(); }
  std::int64_t place(std::uint64_t) const { return in_.line(); }

 private:
  Scanner in_;
};

// Values one after the other from a binary body.
class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, std::size_t begin, bool big) : bytes_(bytes), at_(begin), big_(big) {}
  double value(Type type) {
    if (bytes_left() < type.bytes)
      unreadable("the file ends too early", where(), "the file is cut off: export the mesh again");
    std::uint64_t bits = 0;
    for (unsigned k = 0; k < type.bytes; ++k) {
      const unsigned shift = 8 * (big_ ? type.bytes - 1 - k : k);
      bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes_[at_ + k])) << shift;
    }
    at_ += type.bytes;
    if (type.kind == Kind::kFloat)
      return type.bytes == 8 ? std::bit_cast<double>(bits)
                             : std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    const std::uint64_t sign = std::uint64_t{1} << (8 * type.bytes - 1);
    const bool negative = type.kind == Kind::kSigned && (bits & sign) != 0;
    return static_cast<double>(bits) - (negative ? 2.0 * static_cast<double>(sign) : 0.0);
  }
  static std::uint64_t min_bytes(Type type) { return type.bytes; }
  std::uint64_t bytes_left() const { return bytes_.size() - at_; }
  std::string where() const { return at_byte(at_); }
  static std::int64_t place(std::uint64_t item) { return static_cast<std::int64_t>(item); }

 private:
  std::string_view bytes_;
  std::size_t at_;
  bool big_;
};

template <class Body>
class BodyReader {
 public:
  BodyReader(Body& body, PolygonSoup& soup, const ReadLimits& limits)
      : body_(body), soup_(soup), limits_(limits) {}

  void read(const Element& element) {
    if (element.properties.empty()) return;
    std::uint64_t least = 0;
    for (const Property& p : element.properties) least += Body::min_bytes(p.list ? p.count_type : p.type);
    check_count(element.count, least, body_.bytes_left(), "'" + element.name.substr(0, 40) + "'",
                body_.where());
    if (element.name == "vertex")
      read_vertices(element);
    else if (element.name == "face")
      read_faces(element, false);
    else if (element.name == "tristrips")
      read_faces(element, true);
    else
      for (std::uint64_t i = 0; i < element.count; ++i)
        for (const Property& p : element.properties) skip(p);
  }

 private:
  std::uint64_t list_length(const Property& p) {
    const double length = body_.value(p.count_type);
    if (!(length >= 0) || length != std::floor(length))
      unreadable("the length of a list is no count", body_.where());
    const double most = static_cast<double>(body_.bytes_left() / Body::min_bytes(p.type));
    if (length > most)
      unreadable("a list is longer than the rest of the file", body_.where(),
                 "the file is cut off or damaged: export the mesh again");
    return static_cast<std::uint64_t>(length);
  }

  void skip(const Property& p) {
    for (std::uint64_t k = p.list ? list_length(p) : 1; k > 0; --k) body_.value(p.type);
  }

  void read_vertices(const Element& element) {
    check_vertices(element.count, limits_);
    std::array<int, 3> axis{-1, -1, -1};  // property of x, y, z
    for (int i = 0; i < static_cast<int>(element.properties.size()); ++i)
      for (int k = 0; k < 3; ++k)
        if (!element.properties[i].list && element.properties[i].name == std::string_view("xyz").substr(k, 1))
          axis[k] = i;
    if (*std::min_element(axis.begin(), axis.end()) < 0)
      unreadable("the vertices have no x, y and z", "the header", "export the mesh again");
    soup_.points.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      Vector3 point = Vector3::Zero();
      for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
        const auto k = std::find(axis.begin(), axis.end(), p) - axis.begin();
        if (k == 3)
          skip(element.properties[p]);
        else
          point[k] = coordinate(element.properties[p].type);
      }
      soup_.points.push_back(point);
    }
  }

  double coordinate(Type type) {
    const double value = body_.value(type);
    return is_plain_coordinate(value, limits_) ? value : checked_coordinate(value, limits_, body_.where());
  }

  void read_faces(const Element& element, bool strips) {
    if (!strips) check_faces(soup_.line.size() + element.count, limits_);
    const auto corners =
        std::find_if(element.properties.begin(), element.properties.end(), [](const Property& p) {
          return p.list && (p.name == "vertex_indices" || p.name == "vertex_index" || p.name == "vertex_ids");
        });
    if (corners == element.properties.end())
      unreadable("the faces have no list of vertices", "the header",
                 "export the faces with a list 'vertex_indices'");
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (auto p = element.properties.begin(); p != element.properties.end(); ++p) {
        if (p != corners)
          skip(*p);
        else if (strips)
          read_strip(*p, i);
        else
          read_polygon(*p, i);
      }
  }

  std::int64_t index(Type type) {
    const double value = body_.value(type);
    if (!(std::abs(value) < 1e15) || value != std::floor(value))
      unreadable("a face corner is no vertex number", body_.where());
    return static_cast<std::int64_t>(value);
  }

  void read_polygon(const Property& p, std::uint64_t item) {
    const std::uint64_t sides = list_length(p);
    check_sides(sides, limits_, body_.where());
    for (std::uint64_t k = 0; k < sides; ++k) soup_.corners.push_back(index(p.type));
    soup_.close(body_.place(item));
  }

  // Every index makes a triangle with the two before it, turned every other time; -1 starts anew.
  void read_strip(const Property& p, std::uint64_t item) {
    std::array<std::int64_t, 2> last{};
    std::uint64_t have = 0;
    for (std::uint64_t k = list_length(p); k > 0; --k) {
      const std::int64_t next = index(p.type);
      if (next < 0) {
        have = 0;
        continue;
      }
      if (have >= 2 && have % 2 == 0) add_triangle(last[0], last[1], next, item);
      if (have >= 2 && have % 2 == 1) add_triangle(last[1], last[0], next, item);
      if (have < 2)
        last[have] = next;
      else
        last = {last[1], next};
      ++have;
    }
  }

  void add_triangle(std::int64_t a, std::int64_t b, std::int64_t c, std::uint64_t item) {
    if (a == b || b == c || c == a) return;
    check_faces(soup_.line.size() + 1, limits_);
    soup_.corners.insert(soup_.corners.end(), {a, b, c});
    soup_.close(body_.place(item));
  }

  Body& body_;
  PolygonSoup& soup_;
  const ReadLimits& limits_;
};

template <class Body>
void read_body(Body& body, const Header& header, PolygonSoup& soup, const ReadLimits& limits) {
  BodyReader<Body> reader(body, soup, limits);
  for (const Element& element : header.elements) reader.read(element);
}

}  // namespace

MeshFile read_ply(std::string_view bytes, const ReadLimits& limits) {
  const Header header = parse_header(bytes);
  PolygonSoup soup;
  soup.binary = header.encoding != Encoding::kText;
  if (soup.binary) {
    BinaryBody body(bytes, header.body, header.encoding == Encoding::kBig);
    read_body(body, header, soup, limits);
  } else {
    TextBody body(bytes.substr(header.body), header.line);
    read_body(body, header, soup, limits);
  }
  return triangulated(std::move(soup), "ply", limits, 0);
}

}  // namespace sheetform::reading
