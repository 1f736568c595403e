// Writes every export of small hand-made results into a folder, for readers that are not ours
// (independent_readers.py).
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>

#include "sheetform/blueprint/exports.h"
#include "sheetform/decompose.h"
#include "support/strip_shapes.h"

namespace {

using namespace sheetform;

void save(const std::filesystem::path& path, const std::string& content) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << content;
}

void write_model(const std::filesystem::path& folder, const StripMesh& strips) {
  Decomposition d;
  d.strips = strips;
  d.params.scale = 50, d.bbox_diagonal = 4, d.input_vertices = d.input_faces = 1;
  std::map<std::string, std::string> files;
  for (const Artifact& a : write_artifacts(d)) {
    files[a.name] = a.content;
    save(folder / a.name, a.content);
  }
  const BlueprintOrigin origin{
      "test", "job <1>", "a \"model\" & more", "sha256:00", "https://example.org/?a=1&b=2", ""};
  const auto write = [&](const std::string& name, const std::string& format,
                         const std::map<std::string, std::string>& query) {
    const Artifact a =
        export_result(files["ruled.obj"], files["layout.json"], read_export_request(format, query), origin);
    save(folder / name, a.content);
  };
  write("sheet.svg", "svg", {});
  write("tabs.svg", "svg", {{"tabs", "one"}, {"kerf", "0.2"}, {"profile", "lightburn"}});
  write("sheet.r12.dxf", "dxf", {{"dxf", "r12"}});
  write("sheet.r2000.dxf", "dxf", {{"dxf", "r2000"}, {"profile", "inventor"}});
  write("sheet.pdf", "pdf", {});
  write("tiles.pdf", "pdf", {{"page", "a4"}, {"profile", "print"}});
  write("all.fold", "fold", {});
  write("frame.stl", "frame", {});
  write("parts.json", "parts-json", {});
  write("all.zip", "zip", {});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write_exports FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  write_model(folder / "cube", shapes::cube_faces());
  write_model(folder / "leaves", shapes::two_leaves(60, 0.4, 12));
  write_model(folder / "cone", shapes::cone(24, 1, 0.25));  // its seam ends inside the part
  write_model(folder / "torus", shapes::torus_pieces(12, 4, 15));
  return 0;
}
