#include "server/mapping/field_file.h"

#include <charconv>
#include <cmath>

#include "sheetform_api/json_text.h"

namespace sheetform::server {
namespace {

constexpr const char* kForms =
    "give a .rosy file (count, 4, then three numbers for each face or vertex) or JSON "
    "{\"directions\": [[x, y, z], ...]}";

[[noreturn]] void refuse(const std::string& what, const std::string& where, const std::string& fix) {
  throw Error(ErrorCode::kInvalidParameter, what, where.empty() ? "field" : "field, " + where, fix);
}

struct Mesh {
  std::size_t vertices, faces;
  bool fits(std::size_t count) const { return count == faces || count == vertices; }
};

void check_count(std::size_t count, const Mesh& mesh, const std::string& where) {
  if (mesh.fits(count)) return;
  refuse("the field has " + std::to_string(count) + " directions, the mesh " + std::to_string(mesh.vertices) +
             " vertices and " + std::to_string(mesh.faces) + " triangles",
         where, "give one direction for each vertex or each triangle of this mesh, in its order");
}

Vector3 direction_from(const Vector3& d, const std::string& where) {
  if (!d.allFinite())
    refuse("a direction is not finite", where, "give three numbers, or 0 0 0 to leave it free");
  return d.isZero(0) ? d : d.stableNormalized();
}

/// Numbers of a text with the line on which each stands. Never looks back.
class Numbers {
 public:
  explicit Numbers(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}
  bool done() {
    for (; at_ != end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r' || *at_ == '\n'); ++at_)
      line_ += *at_ == '\n';
    return at_ == end_;
  }
  std::string where() const { return "line " + std::to_string(line_); }
  template <class Number>
  Number next(const std::string& what) {
    if (done()) refuse("the field ends where " + what + " should stand", where(), kForms);
    if (*at_ == '+') ++at_;
    Number value{};
    const auto [stop, error] = std::from_chars(at_, end_, value);
    const bool ends = stop == end_ || *stop == ' ' || *stop == '\t' || *stop == '\r' || *stop == '\n';
    if (error != std::errc() || !ends) refuse("this is not " + what, where(), kForms);
    at_ = stop;
    return value;
  }

 private:
  const char *at_, *end_;
  long long line_ = 1;
};

std::vector<Vector3> read_rosy(std::string_view text, const Mesh& mesh) {
  Numbers numbers(text);
  const auto count = numbers.next<std::uint64_t>("the number of directions");
  check_count(count, mesh, numbers.where());
  const auto arms = numbers.next<std::uint64_t>("the number of arms");
  if (arms != 4)
    refuse("the field has " + std::to_string(arms) + " arms, a cross has 4", numbers.where(),
           "export a 4-symmetric field");
  std::vector<Vector3> directions;
  for (std::uint64_t i = 0; i < count; ++i) {
    Vector3 d;
    for (double& x : d) x = numbers.next<double>("a number of a direction");
    directions.push_back(direction_from(d, numbers.where()));
  }
  if (!numbers.done()) refuse("more follows after the last direction", numbers.where(), kForms);
  return directions;
}

Vector3 direction_from(const api::Json& value, std::size_t index) {
  const std::string where = "direction " + std::to_string(index);
  if (value.is_null()) return Vector3::Zero();
  if (!value.is_array() || value.size() != 3)
    refuse("a direction is not a list of three numbers", where, "write [x, y, z], or null to leave it free");
  Vector3 d;
  for (int k = 0; k < 3; ++k) {
    if (!value[static_cast<std::size_t>(k)].is_number())
      refuse("a direction is not a list of three numbers", where,
             "write [x, y, z], or null to leave it free");
    d[k] = value[static_cast<std::size_t>(k)].get<double>();
  }
  return direction_from(d, where);
}

enum class Per { kAny, kFace, kVertex };

Per per_from(const api::Json& object) {
  const auto per = object.find("per");
  if (per == object.end()) return Per::kAny;
  if (*per == "face") return Per::kFace;
  if (*per == "vertex") return Per::kVertex;
  refuse("per is neither face nor vertex", "per", "write \"face\" or \"vertex\"");
}

std::vector<Vector3> read_json(std::string_view text, const Mesh& mesh, Per& per) {
  api::Json value;
  std::string why;
  if (!api::parse_json(text, value, why)) refuse("the field " + why, {}, kForms);
  if (value.is_object()) {
    per = per_from(value);
    for (const auto& [name, member] : value.items())
      if (name != "per" && name != "directions")
        refuse("there is no member " + name.substr(0, 40), {}, kForms);
    if (!value.contains("directions")) refuse("the field has no directions", {}, kForms);
  }
  const api::Json& list = value.is_object() ? value["directions"] : value;
  if (!list.is_array()) refuse("directions is not a list", {}, kForms);
  if (per == Per::kAny) check_count(list.size(), mesh, {});
  if (per == Per::kFace) check_count(list.size(), {mesh.faces, mesh.faces}, {});
  if (per == Per::kVertex) check_count(list.size(), {mesh.vertices, mesh.vertices}, {});
  std::vector<Vector3> directions;
  for (std::size_t i = 0; i < list.size(); ++i) directions.push_back(direction_from(list[i], i));
  return directions;
}

}  // namespace

UserField read_field(std::string_view bytes, std::size_t vertices, std::size_t faces) {
  const Mesh mesh{vertices, faces};
  const std::size_t start = bytes.find_first_not_of(" \t\r\n");
  if (start == std::string_view::npos) refuse("the field is empty", {}, kForms);
  Per per = Per::kAny;
  const bool json = bytes[start] == '{' || bytes[start] == '[';
  std::vector<Vector3> directions = json ? read_json(bytes, mesh, per) : read_rosy(bytes, mesh);
  UserField field;
  if (per == Per::kVertex || (per == Per::kAny && directions.size() != faces))
    field.per_vertex = std::move(directions);
  else
    field.per_face = std::move(directions);
  return field;
}

}  // namespace sheetform::server
