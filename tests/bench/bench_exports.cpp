// How long a download takes: every format, several settings, one result. The promise is two seconds for a
// hundred parts.
//   bench_exports                  a torus of 100 curved parts
//   bench_exports FOLDER           a stored result (ruled.obj and layout.json)
// Each line: processor seconds (the best of three; one thread does it all, so a quiet machine takes as long),
// the ratio to the plain sheets as SVG, the size of the file.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <map>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/exports.h"
#include "sheetform/decompose.h"
#include "support/strip_shapes.h"

namespace {

using namespace sheetform;

std::string read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Stored {
  std::string obj, json;
};

Stored torus() {
  Decomposition d;
  d.strips = shapes::torus_pieces(20, 5, 25);
  d.params.scale = 50;
  d.bbox_diagonal = 4, d.input_vertices = d.input_faces = 1;
  const auto files = write_artifacts(d);
  return {files[0].content, files[1].content};
}

double best_of_three(const auto& run) {
  double best = 1e300;
  for (int i = 0; i < 3; ++i) {
    const std::clock_t start = std::clock();
    run();
    best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : "";
  const Stored stored =
      folder.empty() ? torus() : Stored{read(folder + "/ruled.obj"), read(folder + "/layout.json")};
  const std::vector<std::pair<std::string, std::map<std::string, std::string>>> runs = {
      {"svg", {}},
      {"svg", {{"sheet_size", "600x400"}, {"kerf", "0.2"}, {"profile", "lightburn"}}},
      {"svg", {{"sheet_size", "600x400"}, {"turns", "32"}}},
      {"svg", {{"tabs", "one"}}},
      {"svg", {{"material", "plywood"}, {"thickness", "3"}, {"hinges", "on"}}},
      {"svg", {{"thickness", "1"}, {"surface", "outside"}}},
      {"svg", {{"sheet_size", "a4"}, {"oversize", "split"}}},
      {"dxf", {}},
      {"parts-dxf", {}},
      {"parts-svg", {}},
      {"pdf", {}},
      {"pdf", {{"page", "a4"}, {"profile", "print"}}},
      {"fold", {}},
      {"obj", {}},
      {"frame", {}},
      {"parts-json", {}},
      {"zip", {}}};
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  double plain = 0;
  for (const auto& [format, query] : runs) {
    std::string name = format;
    for (const auto& [key, value] : query) name += ' ' + key + '=' + value;
    try {
      std::size_t size = 0;
      const double seconds = best_of_three([&] {
        size = export_result(stored.obj, stored.json, read_export_request(format, query), {}).content.size();
      });
      if (plain == 0) plain = seconds;
      std::printf("%8.3f s %6.2f x %9zu bytes  %s\n", seconds, seconds / plain, size, name.c_str());
    } catch (const Error& e) {
      std::printf("%s: %s\n", name.c_str(), e.what());
    }
  }
  return 0;
}
