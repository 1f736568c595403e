#include "sheetform/blueprint/exports.h"

#include "sheetform/base/error.h"
#include "sheetform/blueprint/assembly.h"
#include "sheetform/blueprint/fold_file.h"
#include "sheetform/blueprint/obj_file.h"
#include "sheetform/blueprint/result_reader.h"
#include "sheetform/blueprint/sheet_svg.h"
#include "sheetform/blueprint/zip.h"

namespace sheetform {
namespace {

using Files = std::vector<ZipEntry>;

const char* media_type_of(const std::string& name) {
  const std::string end = name.substr(name.rfind('.') + 1);
  if (end == "svg") return "image/svg+xml";
  if (end == "dxf") return "image/vnd.dxf";
  if (end == "pdf") return "application/pdf";
  if (end == "fold" || end == "json") return "application/json";
  if (end == "stl") return "model/stl";
  if (end == "obj") return "model/obj";
  if (end == "csv") return "text/csv";
  return "application/zip";
}

// A single part on a page of its own, as if it were a sheet.
Blueprint part_alone(const Blueprint& b, int part) {
  Blueprint out = b;
  const Placement turn = flat_turn(b.parts[part].outline);
  Polygon all;
  for (const BlueprintLine& line : b.parts[part].lines)
    for (const Vector2& q : line.points) all.push_back(turn(q));
  const Bounds box = bounds_of(all);
  const double margin = 2;
  BlueprintSheet sheet{box.size().x() + 2 * margin, box.size().y() + 2 * margin, {}, {}};
  sheet.parts.push_back({part, 0, {turn.cos, turn.sin, Vector2::Constant(margin) - box.low}});
  out.sheets = {sheet};
  return out;
}

class Exporter {
 public:
  Exporter(const Blueprint& blueprint, const ExportRequest& request, const Profile& profile)
      : b_(blueprint), r_(request), profile_(profile) {}

  Files files(ExportFormat format) const {
    switch (format) {
      case ExportFormat::kSvg:
        return sheets("svg", [&](int s) { return to_svg(b_, s, profile_); });
      case ExportFormat::kDxf:
        return sheets("dxf", [&](int s) { return to_dxf(b_, s, profile_, r_.dxf); });
      case ExportFormat::kPartsSvg:
        return parts("svg", [&](int p) { return to_svg(part_alone(b_, p), 0, profile_); });
      case ExportFormat::kPartsDxf:
        return parts("dxf", [&](int p) { return part_to_dxf(b_, p, profile_, r_.dxf); });
      case ExportFormat::kPdf:
        return {{"blueprint.pdf", to_pdf(b_, profile_, r_.pdf)}};
      case ExportFormat::kFold:
        return {{"blueprint.fold", to_fold(b_, r_.part.empty() ? -1 : part_named())}};
      case ExportFormat::kObj:
        return {{"blueprint.obj", to_obj(b_)}};
      case ExportFormat::kFrame:
        return {{"frame.stl", to_seam_frame_stl(b_, r_.frame)}};
      case ExportFormat::kPartList:
        return {{"parts.json", to_part_list_json(b_, profile_)}};
      case ExportFormat::kPartTable:
        return {{"parts.csv", to_part_list_csv(b_)}};
      case ExportFormat::kAll:
        break;
    }
    Files all;
    for (const ExportFormat each : {ExportFormat::kSvg, ExportFormat::kDxf, ExportFormat::kPartsDxf,
                                    ExportFormat::kPdf, ExportFormat::kFold, ExportFormat::kObj,
                                    ExportFormat::kFrame, ExportFormat::kPartList, ExportFormat::kPartTable})
      for (ZipEntry& file : files(each)) all.push_back(std::move(file));
    return all;
  }

 private:
  int part_named() const {
    for (std::size_t p = 0; p < b_.parts.size(); ++p)
      if (b_.parts[p].label == r_.part) return static_cast<int>(p);
    throw Error(ErrorCode::kInvalidParameter, "there is no part of this label", "part",
                "Use a label of layout.json");
  }

  Files sheets(const char* end, const auto& write) const {
    const int count = static_cast<int>(b_.sheets.size());
    if (r_.sheet > count)
      throw Error(ErrorCode::kInvalidParameter, "there are only " + std::to_string(count) + " sheets",
                  "sheet", "Ask for a lower number");
    Files out;
    for (int s = 0; s < count; ++s)
      if (r_.sheet == 0 || r_.sheet == s + 1)
        out.push_back({"sheet-" + std::to_string(s + 1) + '.' + end, write(s)});
    return out;
  }

  // Labels that differ only in letters no file name may hold stay apart by the patch's number.
  Files parts(const char* end, const auto& write) const {
    Files out;
    const int only = r_.part.empty() ? -1 : part_named();
    for (int p = 0; p < static_cast<int>(b_.parts.size()); ++p) {
      if (only >= 0 && p != only) continue;
      const std::string name = file_name_of(b_.parts[p].label);
      const bool plain = name == b_.parts[p].label;
      out.push_back({"parts/" + name + (plain ? "" : "-" + std::to_string(p)) + '.' + end, write(p)});
    }
    return out;
  }

  const Blueprint& b_;
  const ExportRequest& r_;
  const Profile& profile_;
};

double longest_side(const StripMesh& strips) {
  Eigen::AlignedBox3d box;
  for (const Vector3& p : strips.points) box.extend(p);
  const double longest = box.isEmpty() ? 0 : box.sizes().maxCoeff();
  if (!(longest > 0)) throw Error(ErrorCode::kInvalidParameter, "the model has no size", "model_size");
  return longest;
}

std::string without_folder(const std::string& name) { return name.substr(name.rfind('/') + 1); }

}  // namespace

Artifact export_result(std::string_view ruled_obj, std::string_view layout_json, const ExportRequest& request,
                       const BlueprintOrigin& origin, const std::vector<Profile>& own) {
  const Profile& profile = profile_named(request.blueprint.profile, own);
  const StoredResult stored = read_result(ruled_obj, layout_json);
  BlueprintOrigin from = origin;
  if (from.parameters.empty()) from.parameters = stored.parameters;
  if (from.request.empty()) from.request = request.text;
  BlueprintOptions options = request.blueprint;
  if (request.format == ExportFormat::kPdf && request.pdf.page_width > 0) {
    options.page_width = request.pdf.page_width - 2 * request.pdf.page_margin;
    options.page_height = request.pdf.page_height - 2 * request.pdf.page_margin;
    options.page_overlap = request.pdf.overlap;
  }
  const double scale =
      request.model_size > 0 ? request.model_size / longest_side(stored.strips) : stored.scale;
  const Blueprint blueprint = make_blueprint(stored.strips, scale, stored.labels, options, from);
  Files files = Exporter(blueprint, request, profile).files(request.format);
  if (files.size() == 1 && request.format != ExportFormat::kAll) {
    const std::string name = without_folder(files[0].name);
    return {name, media_type_of(name), std::move(files[0].content)};
  }
  if (request.format == ExportFormat::kAll)
    files.insert(files.end(), {{"result/ruled.obj", std::string(ruled_obj)},
                               {"result/layout.json", std::string(layout_json)}});
  return {"blueprint.zip", "application/zip", write_zip(files)};
}

}  // namespace sheetform
