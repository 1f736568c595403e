// Field and tracing on mesh files: one line of figures each, and an OBJ to look at with the mesh, the
// singular faces and the candidate paths (or, with --layout, a set of paths chosen farthest first and
// smoothed).
//   trace_view [--layout] [--threads n] [--out folder] mesh...
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sheetform/field/cross_field.h"
#include "sheetform/mesh/creases.h"
#include "sheetform/mesh/mesh_io.h"
#include "sheetform/tracing/path_smoothing.h"
#include "sheetform/tracing/tracing.h"

namespace sheetform {
namespace {

struct Options {
  bool layout = false;
  int threads = 1;
  std::filesystem::path out;
  std::vector<std::string> files;
};

Options parse(int argc, char** argv) {
  Options o;
  for (int i = 1; i < argc; ++i) {
    const std::string arg = argv[i];
    if (arg == "--layout")
      o.layout = true;
    else if (arg == "--threads" && i + 1 < argc)
      o.threads = std::stoi(argv[++i]);
    else if (arg == "--out" && i + 1 < argc)
      o.out = argv[++i];
    else
      o.files.push_back(arg);
  }
  return o;
}

// Processor seconds of the whole process: other programs do not count.
class Lap {
 public:
  double next() {
    const std::clock_t now = std::clock(), since = last_;
    last_ = now;
    return static_cast<double>(now - since) / CLOCKS_PER_SEC;
  }

 private:
  std::clock_t last_ = std::clock();
};

// Farthest first, as the search does, without looking at patches.
std::vector<Path> choose(const SurfaceMesh& mesh, const TracingGraph& graph, std::vector<Path> pool,
                         int count) {
  NodeDistance distance(graph, bounding_box_diagonal(mesh.points));
  std::vector<char> used(2 * mesh.points.size(), 0);
  std::vector<Path> chosen;
  const auto collides = [&](const Path& p) {
    for (std::size_t i = 0; i < p.vertices.size(); ++i)
      if (used[2 * p.vertices[i] + (p.dirs[i] & 1)]) return true;
    return false;
  };
  while (static_cast<int>(chosen.size()) < count) {
    std::erase_if(pool, collides);
    if (pool.empty()) break;
    const auto best = std::max_element(pool.begin(), pool.end(), [&](const Path& a, const Path& b) {
      return distance.mean(a) < distance.mean(b);
    });
    for (std::size_t i = 0; i < best->vertices.size(); ++i)
      used[2 * best->vertices[i] + (best->dirs[i] & 1)] = 1;
    distance.add(*best);
    chosen.push_back(*best);
  }
  return chosen;
}

std::vector<char> edges_of(const SurfaceMesh& mesh, const std::vector<Path>& paths) {
  std::vector<char> edge(mesh.edges.size(), 0);
  for (const Path& p : paths)
    for (std::size_t i = 0; i + (p.loop ? 0 : 1) < p.vertices.size(); ++i)
      edge[mesh.find_edge(p.vertices[i], p.vertices[(i + 1) % p.vertices.size()])] = 1;
  return edge;
}

void write_view(const std::filesystem::path& path, const SurfaceMesh& mesh, const CrossField& field,
                const std::vector<Path>& paths) {
  std::ofstream out(path);
  for (const Vector3& p : mesh.points) out << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  std::vector<int> index(mesh.faces.size(), 0);
  for (std::size_t i = 0; i < field.singular_faces.size(); ++i)
    index[field.singular_faces[i]] = field.singular_index[i];
  for (int kind : {0, 1, -1}) {
    out << "g " << (kind == 0 ? "surface" : kind > 0 ? "singular_plus" : "singular_minus") << '\n';
    for (int f = 0; f < mesh.face_count(); ++f)
      if ((index[f] > 0) - (index[f] < 0) == kind)
        out << "f " << mesh.faces[f][0] + 1 << ' ' << mesh.faces[f][1] + 1 << ' ' << mesh.faces[f][2] + 1
            << '\n';
  }
  for (std::size_t i = 0; i < paths.size(); ++i) {
    out << "g path_" << i << "\nl";
    for (int v : paths[i].vertices) out << ' ' << v + 1;
    if (paths[i].loop) out << ' ' << paths[i].vertices[0] + 1;
    out << '\n';
  }
}

void print_paths(const SurfaceMesh& mesh, const std::vector<Path>& paths) {
  const double diagonal = bounding_box_diagonal(mesh.points);
  int loops = 0;
  double drift = 0, length = 0;
  for (const Path& p : paths)
    loops += p.loop, drift += std::sqrt(p.drift) * 45, length += p.length / diagonal;
  const double n = std::max<double>(1, static_cast<double>(paths.size()));
  std::printf(" %4zu paths (%3d loops), drift %.1f deg, length %.2f", paths.size(), loops, drift / n,
              length / n);
}

void run(const std::string& file, const Options& options) {
  const MeshFile read = read_mesh_file(file);
  SurfaceMesh mesh = build_surface_mesh(read.soup.points, read.soup.faces);
  RunContext context;
  context.threads = options.threads;
  const std::vector<char> crease = detect_creases(mesh, 40);
  Lap lap;
  const CurvatureField curvature = principal_curvature(mesh, crease, {}, context);
  const double curvature_time = lap.next();
  const CrossField field = cross_field(mesh, crease, curvature, nullptr, {}, context);
  const double field_time = lap.next();
  const TracingGraph graph = tracing_graph(mesh, crease, field, {}, context);
  const double graph_time = lap.next();
  std::vector<Path> paths = trace_candidates(mesh, graph, field, {}, context);
  const double trace_time = lap.next();
  int plus = 0, minus = 0;
  for (int i : field.singular_index) (i > 0 ? plus : minus) += i;
  const std::string name = std::filesystem::path(file).stem().string();
  std::printf("%-16s %6d faces, curvature %.3f field %.3f graph %.3f trace %.3f s, singular +%d %d,",
              name.c_str(), mesh.face_count(), curvature_time, field_time, graph_time, trace_time, plus,
              minus);
  print_paths(mesh, paths);
  if (options.layout) {
    paths = choose(mesh, graph, std::move(paths), 20);
    const ClosestPointTree tree(mesh.points, mesh.faces);
    lap.next();
    const auto moved = smooth_paths(mesh, edges_of(mesh, paths), graph.terminal, tree, {}, context);
    std::printf(", smoothing %.3f s moved %zu", lap.next(), moved.size());
  }
  std::printf("\n");
  if (!options.out.empty()) write_view(options.out / (name + ".obj"), mesh, field, paths);
}

}  // namespace
}  // namespace sheetform

int main(int argc, char** argv) {
  const sheetform::Options options = sheetform::parse(argc, argv);
  if (options.files.empty()) {
    std::fprintf(stderr, "usage: trace_view [--layout] [--threads n] [--out folder] mesh...\n");
    return 2;
  }
  int status = 0;
  for (const std::string& file : options.files) try {
      sheetform::run(file, options);
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s: %s\n", file.c_str(), e.what());
      status = 1;
    }
  return status;
}
