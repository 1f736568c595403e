#include "sheetform/blueprint/result_reader.h"

#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "sheetform/base/error.h"
#include "sheetform/strip/patch_shape.h"

namespace sheetform {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLargest = 1e60;  // products of larger coordinates overflow

[[noreturn]] void refuse(const std::string& what, const std::string& where) {
  throw Error(ErrorCode::kUnreadableMesh, what, where, "Use the files as the decomposition wrote them");
}

void check_size(std::string_view text, const char* name, const ResultLimits& limits) {
  if (text.size() > limits.max_bytes)
    throw Error(ErrorCode::kLimitExceeded,
                "the file has more than " + std::to_string(limits.max_bytes) + " bytes", name);
}

// --- ruled.obj
// -----------------------------------------------------------------------------------------------------

std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string_view take_word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
  const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

bool parse(std::string_view word, auto& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  return code == std::errc() && end == word.data() + word.size();
}

struct Obj {
  std::vector<Vector3> v;
  std::vector<Vector2> vt;
  std::map<std::string, std::vector<StripMesh::Triangle>, std::less<>> groups;
};

class ObjReader {
 public:
  Obj read(std::string_view text) {
    std::vector<StripMesh::Triangle>* group = nullptr;
    while (!text.empty()) {
      ++line_;
      std::string_view line = take_line(text);
      const std::string_view kind = take_word(line);
      if (kind == "v")
        out_.v.emplace_back(numbers<3>(line));
      else if (kind == "vt")
        out_.vt.emplace_back(numbers<2>(line));
      else if (kind == "g")
        group = &out_.groups[std::string(take_word(line))];
      else if (kind == "f")
        add_face(line, group);
    }
    check_faces();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    refuse(what, "ruled.obj line " + std::to_string(line_));
  }

  template <int N>
  Eigen::Matrix<double, N, 1> numbers(std::string_view line) const {
    Eigen::Matrix<double, N, 1> x;
    for (int k = 0; k < N; ++k)
      if (!parse(take_word(line), x[k]) || !(std::abs(x[k]) <= kLargest))
        fail("not " + std::to_string(N) + " finite numbers");
    return x;
  }

  // One-based, negative counts back from the last one read.
  int index(std::string_view word, std::size_t count) const {
    long long i = 0;
    if (!parse(word, i)) fail("not a triangle of v/vt corners");
    i = i > 0 ? i - 1 : static_cast<long long>(count) + i;
    if (i < 0 || i > 2'000'000'000) fail("an index out of range");
    return static_cast<int>(i);
  }

  void add_face(std::string_view line, std::vector<StripMesh::Triangle>* group) {
    if (!group) fail("a face before the first group");
    StripMesh::Triangle t{};
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = take_word(line);
      const std::size_t slash = word.find('/');
      if (slash == std::string_view::npos) fail("not a triangle of v/vt corners");
      std::string_view second = word.substr(slash + 1);
      t.v[k] = index(word.substr(0, slash), out_.v.size());
      t.vt[k] = index(second.substr(0, second.find('/')), out_.vt.size());
    }
    if (!take_word(line).empty()) fail("a face with more than three corners");
    group->push_back(t);
  }

  void check_faces() const {
    for (const auto& [name, faces] : out_.groups)
      for (const StripMesh::Triangle& t : faces)
        for (int k = 0; k < 3; ++k)
          if (t.v[k] >= static_cast<int>(out_.v.size()) || t.vt[k] >= static_cast<int>(out_.vt.size()))
            refuse("a face names a vertex that does not exist", "ruled.obj, group " + name);
  }

  Obj out_;
  std::size_t line_ = 0;
};

// --- layout.json
// ---------------------------------------------------------------------------------------------------

const Json& member(const Json& object, const char* key, const std::string& where) {
  if (!object.is_object() || !object.contains(key))
    refuse(std::string("\"") + key + "\" is missing", "layout.json, " + where);
  return object[key];
}

double number(const Json& object, const char* key, const std::string& where) {
  const Json& x = member(object, key, where);
  if (!x.is_number() || !(std::abs(x.get<double>()) <= kLargest))
    refuse(std::string("\"") + key + "\" is not a finite number", "layout.json, " + where);
  return x.get<double>();
}

int natural(const Json& x, const std::string& where) {
  const bool whole = x.is_number_unsigned() && x.get<std::uint64_t>() <= 2'000'000'000u;
  if (!whole) refuse("not an integer from 0 to 2000000000", "layout.json, " + where);
  return static_cast<int>(x.get<std::uint64_t>());
}

int natural(const Json& object, const char* key, const std::string& where) {
  return natural(member(object, key, where), where + ", \"" + key + "\"");
}

const Json& list(const Json& object, const char* key, const std::string& where) {
  const Json& x = member(object, key, where);
  if (!x.is_array()) refuse(std::string("\"") + key + "\" is not a list", "layout.json, " + where);
  return x;
}

std::vector<int> naturals(const Json& object, const char* key, std::size_t below, const std::string& where) {
  std::vector<int> out;
  for (const Json& x : list(object, key, where)) {
    out.push_back(natural(x, where + ", \"" + key + "\""));
    if (static_cast<std::size_t>(out.back()) >= below)
      refuse("an index out of range", "layout.json, " + where + ", \"" + key + "\"");
  }
  return out;
}

// Position of each id of a list, which must not repeat one.
std::map<int, int> positions(const Json& items, const char* name, std::vector<int>& ids) {
  std::map<int, int> at;
  for (const Json& item : items) {
    const int id = natural(item, "id", name);
    if (!at.emplace(id, static_cast<int>(ids.size())).second)
      refuse("id " + std::to_string(id) + " is used twice", std::string("layout.json, ") + name);
    ids.push_back(id);
  }
  return at;
}

int position(const std::map<int, int>& at, int id, const std::string& where) {
  const auto it = at.find(id);
  if (it == at.end()) refuse("id " + std::to_string(id) + " does not exist", "layout.json, " + where);
  return it->second;
}

struct Ids {
  std::map<int, int> patches, arches;
};

StripMesh::Patch read_patch(const Json& j, const Ids& ids, std::size_t points, const std::string& where) {
  StripMesh::Patch p;
  p.boundary = naturals(j, "boundary", points, where);
  p.corners = naturals(j, "corners", p.boundary.size(), where);
  for (const Json& a : list(j, "arches", where))
    p.arches.push_back(position(ids.arches, natural(a, where + ", \"arches\""), where));
  for (const Json& r : list(j, "rulings", where)) {
    if (!r.is_array() || r.size() != 2) refuse("a ruling is not a pair of indices", "layout.json, " + where);
    const std::array<int, 2> ends{natural(r[0], where + ", \"rulings\""),
                                  natural(r[1], where + ", \"rulings\"")};
    for (int v : ends)
      if (static_cast<std::size_t>(v) >= points)
        refuse("a ruling names a vertex that does not exist", "layout.json, " + where);
    p.rulings.push_back(ends);
  }
  if (const Json& mirror = member(j, "mirror_of", where); !mirror.is_null())
    p.mirror_of = position(ids.patches, natural(mirror, where + ", \"mirror_of\""), where);
  if (j.contains("component")) p.component = natural(j, "component", where);
  return p;
}

StripMesh::Arch read_arch(const Json& j, const Ids& ids, std::size_t points, const std::string& where) {
  StripMesh::Arch a;
  a.vertices = naturals(j, "vertices", points, where);
  if (a.vertices.size() < 2) refuse("an arch of fewer than two vertices", "layout.json, " + where);
  const Json& sides = list(j, "patches", where);
  if (sides.size() != 2) refuse("\"patches\" is not a pair", "layout.json, " + where);
  a.patches[0] = position(ids.patches, natural(sides[0], where), where);
  a.patches[1] = sides[1].is_null() ? -1 : position(ids.patches, natural(sides[1], where), where);
  a.crease = j.contains("crease") && j["crease"].is_boolean() && j["crease"].get<bool>();
  a.on_plane = j.contains("on_plane") && j["on_plane"].is_boolean() && j["on_plane"].get<bool>();
  a.drawn = j.contains("drawn") && j["drawn"].is_boolean() && j["drawn"].get<bool>();
  return a;
}

std::string label_of(const Json& j, const std::string& where) {
  const Json& label = member(j, "label", where);
  if (!label.is_string() || label.get_ref<const std::string&>().empty())
    refuse("\"label\" is not a text", "layout.json, " + where);
  return label.get<std::string>();
}

void read_header(const Json& root, StoredResult& out) {
  if (member(root, "schema", "root") != "sheetform-layout/1")
    refuse("the schema is not sheetform-layout/1", "layout.json");
  out.scale = number(root, "scale", "root");
  if (!(out.scale > 0)) refuse("\"scale\" is not positive", "layout.json");
  const Json& input = member(root, "input", "root");
  out.bbox_diagonal = number(input, "bbox_diagonal", "input");
  out.input_vertices = natural(input, "vertices", "input"),
  out.input_faces = natural(input, "faces", "input");
  const Json& parameters = member(root, "parameters", "root");
  out.e_max = number(parameters, "e_max", "parameters");
  if (!(out.e_max > 0 && out.e_max <= 1))
    refuse("\"e_max\" is no fraction of the diagonal", "layout.json, parameters");
  if (parameters.contains("max_sides")) out.max_sides = natural(parameters, "max_sides", "parameters");
  out.parameters = parameters.dump();
  out.report = member(root, "report", "root").dump();
}

void read_layout(const Json& root, StoredResult& out) {
  read_header(root, out);
  const Json &patches = list(root, "patches", "root"), &arches = list(root, "arches", "root");
  Ids ids;
  ids.patches = positions(patches, "patches", out.patch_ids);
  ids.arches = positions(arches, "arches", out.arch_ids);
  const std::size_t points = out.strips.points.size();
  for (const Json& j : patches) {
    const std::string where = "patch " + std::to_string(out.patch_ids[out.strips.patches.size()]);
    out.strips.patches.push_back(read_patch(j, ids, points, where));
    out.labels.push_back(label_of(j, where));
    out.sheets.push_back(j.contains("sheet") ? natural(j, "sheet", where) : 0);
  }
  for (const Json& j : arches)
    out.strips.arches.push_back(
        read_arch(j, ids, points, "arch " + std::to_string(out.arch_ids[out.strips.arches.size()])));
}

Json parse_json(std::string_view text) {
  try {
    return Json::parse(text);
  } catch (const Json::exception& e) {
    refuse(std::string("not JSON: ") + e.what(), "layout.json");
  }
}

}  // namespace

StoredResult read_result(std::string_view ruled_obj, std::string_view layout_json,
                         const ResultLimits& limits) {
  check_size(ruled_obj, "ruled.obj", limits);
  check_size(layout_json, "layout.json", limits);
  Obj obj = ObjReader().read(ruled_obj);
  StoredResult out;
  out.strips.points = std::move(obj.v);
  try {
    read_layout(parse_json(layout_json), out);
  } catch (const Json::exception& e) {
    refuse(e.what(), "layout.json");
  }
  for (const Vector2& q : obj.vt) out.strips.uvs.push_back(q / out.scale);
  for (std::size_t p = 0; p < out.strips.patches.size(); ++p) {
    const auto it = obj.groups.find("patch_" + std::to_string(out.patch_ids[p]));
    if (it == obj.groups.end()) continue;
    out.strips.patches[p].triangles = std::move(it->second);
    obj.groups.erase(it);
    fill_boundary_vt(out.strips.patches[p]);
  }
  for (const auto& [name, faces] : obj.groups)
    if (!faces.empty())
      refuse("faces in group '" + name + "', which is no patch of layout.json", "ruled.obj");
  return out;
}

}  // namespace sheetform
