#include "sheetform/blueprint/fold_file.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "sheetform/blueprint/fold_lines.h"
#include "sheetform/blueprint/sheet_svg.h"
#include "sheetform/blueprint/text.h"

namespace sheetform {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFlatAngle = 1e-7;  // degrees: what rounding leaves of a planar pair of triangles

class FoldWriter {
 public:
  explicit FoldWriter(const Blueprint& blueprint) : b_(blueprint) {
    for (const Seam& seam : b_.seams)
      for (int k = 0; k < 2; ++k)
        for (std::size_t i = 0; i + 1 < seam.vt[k].size(); ++i)
          seam_at_[key(seam.vt[k][i], seam.vt[k][i + 1])] = seam.number;
  }

  void add_part(int part, const Placement& placement) {
    const StripMesh::Patch& patch = b_.strips.patches[b_.parts[part].patch];
    std::map<int, int> id;  // vt -> vertex
    const auto vertex = [&](int v, int vt) {
      const auto [it, fresh] = id.emplace(vt, static_cast<int>(flat_.size()));
      if (!fresh) return it->second;
      const Vector2 p = placement(b_.flat[vt]);
      const Vector3 x = b_.scale * b_.strips.points[v];
      flat_.push_back({p.x(), p.y()});
      solid_.push_back({x.x(), x.y(), x.z()});
      return it->second;
    };
    const bool mirrored = b_.options.marked_face == Face::kInside;
    for (const StripMesh::Triangle& t : patch.triangles) {
      std::array<int, 3> face{vertex(t.v[0], t.vt[0]), vertex(t.v[1], t.vt[1]), vertex(t.v[2], t.vt[2])};
      if (mirrored) std::swap(face[1], face[2]);
      faces_.push_back(face);
      face_parts_.push_back(b_.parts[part].label);
    }
    for (const Crease& c : creases_of(b_.strips, b_.parts[part].patch)) {
      const double angle = mirrored ? c.angle : -c.angle;
      const char* assignment = std::abs(angle) <= kFlatAngle ? "F" : angle < 0 ? "M" : "V";
      edge(id.at(c.vt[0]), id.at(c.vt[1]), assignment, std::abs(angle) <= kFlatAngle ? 0 : angle,
           c.ruling >= 0 ? "ruling" : "diagonal", 0);
    }
    const std::vector<int>& rim = patch.boundary_vt;
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const int a = rim[i], c = rim[(i + 1) % rim.size()];
      const auto seam = seam_at_.find(key(a, c));
      edge(id.at(a), id.at(c), "B", 0, seam == seam_at_.end() ? "border" : "seam",
           seam == seam_at_.end() ? 0 : seam->second);
    }
  }

  std::string write() const {
    const Json folded = {{"frame_parent", 0},
                         {"frame_inherit", true},
                         {"frame_title", "folded form"},
                         {"frame_classes", Json::array({"foldedForm"})},
                         {"frame_attributes", Json::array({"3D"})},
                         {"frame_unit", "mm"},
                         {"vertices_coords", solid_}};
    const Json j = {{"file_spec", 1.2},
                    {"file_creator", "sheetform " + valid_utf8(b_.origin.version)},
                    {"file_title", valid_utf8(b_.origin.model)},
                    {"file_description", origin_json(b_)},
                    {"file_classes", Json::array({"multiModel"})},
                    {"frame_title", "crease pattern"},
                    {"frame_classes", Json::array({"creasePattern"})},
                    {"frame_attributes", Json::array({"2D", "manifold", "orientable"})},
                    {"frame_unit", "mm"},
                    {"vertices_coords", flat_},
                    {"edges_vertices", edges_},
                    {"edges_assignment", assignments_},
                    {"edges_foldAngle", angles_},
                    {"faces_vertices", faces_},
                    {"faces_sheetform:part", face_parts_},
                    {"edges_sheetform:kind", kinds_},
                    {"edges_sheetform:seam", seams_},
                    {"file_frames", Json::array({folded})}};
    return j.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  }

 private:
  static std::array<int, 2> key(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

  void edge(int a, int b, const char* assignment, double angle, const char* kind, int seam) {
    edges_.push_back({a, b});
    assignments_.emplace_back(assignment);
    angles_.push_back(angle);
    kinds_.emplace_back(kind);
    seams_.push_back(seam > 0 ? Json(seam) : Json(nullptr));
  }

  const Blueprint& b_;
  std::map<std::array<int, 2>, int> seam_at_;  // by the two vt of an edge
  std::vector<std::array<double, 2>> flat_;
  std::vector<std::array<double, 3>> solid_;
  std::vector<std::array<int, 2>> edges_;
  std::vector<std::string> assignments_, kinds_, face_parts_;
  std::vector<double> angles_;
  std::vector<std::array<int, 3>> faces_;
  Json seams_ = Json::array();
};

}  // namespace

std::string to_fold(const Blueprint& b, int part) {
  FoldWriter writer(b);
  if (part >= 0) {
    writer.add_part(part, {});
    return writer.write();
  }
  double x = 0;
  for (const BlueprintSheet& sheet : b.sheets) {
    for (const PlacedPart& p : sheet.parts) {
      if (p.copy > 0) continue;
      Placement place = p.placement;
      place.shift.x() += x;
      writer.add_part(p.part, place);
    }
    x += sheet.width + 20;
  }
  return writer.write();
}

}  // namespace sheetform
