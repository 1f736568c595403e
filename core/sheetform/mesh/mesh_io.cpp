#include "sheetform/mesh/mesh_io.h"

#include <array>
#include <cstdio>
#include <memory>

#include "sheetform/base/error.h"
#include "sheetform/mesh/mesh_read.h"

namespace sheetform {
namespace {

using namespace reading;
constexpr const char* kGiveAMesh = "give an OBJ, STL, PLY or OFF file";

enum class Format { kObj, kStlText, kStlBinary, kPly, kOff, kUnknown };

std::string_view after_byte_order_mark(std::string_view bytes) {
  if (bytes.substr(0, 3) == "\xEF\xBB\xBF") bytes.remove_prefix(3);
  return bytes;
}

// Formats that people send by mistake, told by their first bytes.
void refuse_other_formats(std::string_view bytes) {
  struct Other {
    std::string_view magic;
    const char* name;
  };
  static constexpr std::array<Other, 13> kOthers{{{"PK\x03\x04", "a ZIP archive (3MF is one)"},
                                                  {"\x1F\x8B", "gzip data"},
                                                  {"glTF", "a binary glTF"},
                                                  {"Kaydara FBX", "an FBX"},
                                                  {"BLENDER", "a Blender scene"},
                                                  {"ISO-10303", "a STEP file"},
                                                  {"\xFF\xFE", "UTF-16 text"},
                                                  {"\xFE\xFF", "UTF-16 text"},
                                                  {"%PDF", "a PDF"},
                                                  {"\x89PNG", "a picture (PNG)"},
                                                  {"\xFF\xD8\xFF", "a picture (JPEG)"},
                                                  {"GIF8", "a picture (GIF)"},
                                                  {"<", "an XML or HTML text"}}};
  for (const Other& other : kOthers)
    if (bytes.substr(0, other.magic.size()) == other.magic)
      unreadable(std::string("the file is ") + other.name, {},
                 "unpack it or export the mesh as OBJ, STL, PLY or OFF");
}

std::string ending_of(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  std::string ending(dot == name.npos ? name : name.substr(dot + 1));
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return ending;
}

bool is_binary_stl_size(std::string_view bytes) {
  if (bytes.size() < 134 || (bytes.size() - 84) % 50 != 0) return false;
  std::uint64_t facets = 0;
  for (int k = 3; k >= 0; --k)
    facets = facets * 256 + static_cast<unsigned char>(bytes[80 + static_cast<std::size_t>(k)]);
  return facets == (bytes.size() - 84) / 50;
}

bool is_obj_key(std::string_view word) {
  for (const std::string_view key :
       {"v", "vt", "vn", "vp", "f", "l", "p", "g", "o", "s", "mtllib", "usemtl", "mg"})
    if (word == key) return true;
  return false;
}

bool is_off_key(std::string_view word) {
  const std::size_t at = word.find("OFF");
  return at <= 6 && word.substr(0, at).find_first_not_of("STCNn4") == word.npos;
}

Format format_by_content(std::string_view bytes) {
  if (bytes.substr(0, 3) == "ply" && bytes.size() > 3 && static_cast<unsigned char>(bytes[3]) <= ' ')
    return Format::kPly;
  if (is_binary_stl_size(bytes)) return Format::kStlBinary;
  const bool binary = bytes.substr(0, 512).find('\0') != bytes.npos;
  const std::string_view word = Scanner(bytes, '#', false).word_on_any_line();
  if (word == "solid" || word == "SOLID" || word == "Solid")
    return binary ? Format::kStlBinary : Format::kStlText;
  if (is_off_key(word)) return Format::kOff;
  if (is_obj_key(word)) return Format::kObj;
  return Format::kUnknown;
}

Format format_of(std::string_view bytes, std::string_view name) {
  const Format format = format_by_content(bytes);
  if (format != Format::kUnknown) return format;
  const bool binary = bytes.substr(0, 512).find('\0') != bytes.npos;
  const std::string ending = ending_of(name);
  if (ending.substr(0, 3) == "stl")
    return binary || bytes.size() < 84 ? Format::kStlBinary : Format::kStlText;
  if (ending == "obj") return Format::kObj;
  if (ending == "off") return Format::kOff;
  if (ending == "ply")
    unreadable("a PLY file begins with a line 'ply', this one with " + shown(bytes.substr(0, 12)), at_line(1),
               kGiveAMesh);
  if (binary && bytes.size() >= 84 && ending.empty()) return Format::kStlBinary;
  unreadable("the content is no OBJ, STL, PLY or OFF; it begins with " + shown(bytes.substr(0, 20)),
             at_line(1), kGiveAMesh);
}

MeshFile read_as(Format format, std::string_view bytes, const ReadLimits& limits) {
  switch (format) {
    case Format::kStlText:
      return read_stl_text(bytes, limits);
    case Format::kStlBinary:
      return read_stl_binary(bytes, limits);
    case Format::kPly:
      return read_ply(bytes, limits);
    case Format::kOff:
      return read_off(bytes, limits);
    default:
      return read_obj(bytes, limits);
  }
}

[[noreturn]] void too_large(const ReadLimits& limits) {
  throw Error(ErrorCode::kLimitExceeded,
              "the file is larger than the limit of " + std::to_string(limits.bytes) + " bytes", {},
              "simplify the mesh or save it in a binary format");
}

void append_number(std::string& text, double value) {
  char digits[32];
  text += ' ';
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

}  // namespace

MeshFile read_mesh(std::string_view bytes, std::string_view name_hint, const ReadLimits& limits) {
  if (bytes.size() > limits.bytes) too_large(limits);
  bytes = after_byte_order_mark(bytes);
  if (bytes.find_first_not_of(" \t\r\n") == bytes.npos) unreadable("the file is empty", {}, kGiveAMesh);
  refuse_other_formats(bytes);
  MeshFile file = read_as(format_of(bytes, name_hint), bytes, limits);
  if (file.soup.faces.empty())
    throw Error(ErrorCode::kUnsupportedMesh,
                file.soup.points.empty()
                    ? "the file has neither vertices nor faces"
                    : "the file has " + std::to_string(file.soup.points.size()) + " vertices, but no faces",
                {}, "export a surface of triangles or polygons; points and curves cannot be decomposed");
  return file;
}

MeshFile read_mesh_file(const std::filesystem::path& path, const ReadLimits& limits) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!in) unreadable("the file cannot be opened", path.string(), "check its name and permissions");
  std::string bytes;
  std::array<char, 1 << 16> block;
  while (const std::size_t got = std::fread(block.data(), 1, block.size(), in.get())) {
    bytes.append(block.data(), got);
    if (bytes.size() > limits.bytes) too_large(limits);
  }
  if (std::ferror(in.get()) != 0)
    unreadable("the file cannot be read", path.string(), "check that it is a file");
  return read_mesh(bytes, path.string(), limits);
}

std::string write_obj(const TriangleSoup& soup) {
  std::string text;
  for (const Vector3& p : soup.points) {
    text += 'v';
    for (int k = 0; k < 3; ++k) append_number(text, p[k]);
    text += '\n';
  }
  for (const auto& f : soup.faces)
    text += "f " + std::to_string(f[0] + 1) + ' ' + std::to_string(f[1] + 1) + ' ' +
            std::to_string(f[2] + 1) + '\n';
  return text;
}

}  // namespace sheetform
