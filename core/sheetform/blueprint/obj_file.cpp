#include "sheetform/blueprint/obj_file.h"

#include "sheetform/blueprint/sheet_svg.h"
#include "sheetform/blueprint/text.h"
#include "sheetform/blueprint/zip.h"

namespace sheetform {
namespace {

// Where the first copy of each part lies: u counts sheets.
std::vector<Vector2> texture_places(const Blueprint& b) {
  std::vector<Vector2> uv(b.flat.size(), Vector2::Zero());
  for (std::size_t s = 0; s < b.sheets.size(); ++s)
    for (const PlacedPart& p : b.sheets[s].parts) {
      if (p.copy > 0) continue;
      for (const StripMesh::Triangle& t : b.strips.patches[b.parts[p.part].patch].triangles)
        for (int vt : t.vt) {
          const Vector2 q = p.placement(b.flat[vt]);
          uv[vt] = {static_cast<double>(s) + q.x() / b.sheets[s].width, q.y() / b.sheets[s].height};
        }
    }
  return uv;
}

void append_all(std::string& out, const char* key, const auto& values) {
  out += key;
  for (const double x : values) out += ' ', append_exact(out, x);
  out += '\n';
}

}  // namespace

std::string to_obj(const Blueprint& b) {
  std::string out =
      "# " + origin_json(b) +
      "\n# v in mm; vt: sheet number from 0 + share of the sheet's width, share of its height\n";
  for (std::size_t s = 0; s < b.sheets.size(); ++s)
    out += "# sheet " + std::to_string(s) + ": " + rounded(b.sheets[s].width, 4) + " x " +
           rounded(b.sheets[s].height, 4) + " mm\n";
  for (const Vector3& p : b.strips.points) append_all(out, "v", Vector3(b.scale * p));
  for (const Vector2& q : texture_places(b)) append_all(out, "vt", q);
  for (const BlueprintPart& part : b.parts) {
    out += "g part_" + file_name_of(part.label) + '\n';
    for (const StripMesh::Triangle& t : b.strips.patches[part.patch].triangles) {
      out += 'f';
      for (int k = 0; k < 3; ++k) out += ' ' + std::to_string(t.v[k] + 1) + '/' + std::to_string(t.vt[k] + 1);
      out += '\n';
    }
  }
  return out;
}

}  // namespace sheetform
