#include "bench_run.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "refine.h"
#include "sheetform/mesh/mesh_io.h"
#include "support/shapes.h"

namespace sheetform::bench {
namespace {

std::vector<double> numbers_of(const std::string& list) {
  std::vector<double> numbers;
  std::stringstream in(list);
  for (std::string part; std::getline(in, part, ',');) numbers.push_back(std::stod(part));
  return numbers;
}

Effort effort_of(const std::string& word) {
  if (word == "draft") return Effort::kDraft;
  if (word == "normal") return Effort::kNormal;
  if (word == "thorough") return Effort::kThorough;
  throw std::invalid_argument("--effort is draft, normal or thorough");
}

bool on_off(const std::string& word) {
  if (word != "on" && word != "off") throw std::invalid_argument("on or off, not '" + word + "'");
  return word == "on";
}

void set_option(const std::string& name, const std::string& value, Options& o) {
  if (name == "--e-max") {
    o.e_max = numbers_of(value);
  } else if (name == "--threads") {
    o.threads = std::stoi(value);
  } else if (name == "--repeat") {
    o.repeat = std::stoi(value);
  } else if (name == "--coarse") {
    o.coarse = std::stoi(value);
  } else if (name == "--refine") {
    o.refine = std::stoi(value);
  } else if (name == "--effort") {
    o.params.effort = effort_of(value);
  } else if (name == "--t-junctions") {
    o.params.t_junctions = on_off(value);
  } else if (name == "--self-seams") {
    o.params.self_seams = on_off(value);
  } else if (name == "--csv") {
    o.csv = value;
  } else if (name == "--against") {
    o.against = value;
  } else {
    throw std::invalid_argument("unknown option " + name);
  }
}

InputMesh read_input(const std::string& file) {
  MeshFile read = read_mesh_file(file);
  return {std::move(read.soup), read.format, std::filesystem::path(file).stem().string()};
}

InputMesh sized_input(const std::string& file, int coarse, int times) {
  InputMesh input = read_input(file);
  if (coarse > 0) input.soup = remeshed(input.soup, coarse);
  if (times > 0) input.soup = refined(input.soup, times);
  return input;
}

InputMesh own(const std::string& name, TriangleSoup soup) { return {std::move(soup), "own", name}; }

// Hills and valleys of several sizes: curvature everywhere, no symmetry.
TriangleSoup bumpy_ball(int n) {
  TriangleSoup soup = shapes::sphere(n);
  for (Vector3& p : soup.points)
    p *= 1 + 0.12 * std::sin(3 * p.x() + 1) * std::cos(2 * p.y()) + 0.05 * std::sin(7 * p.z() + 4 * p.x());
  return soup;
}

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

using Sparse = Eigen::SparseMatrix<double>;

Sparse laplacian(const TriangleSoup& soup) {
  const int n = static_cast<int>(soup.points.size());
  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto& f : soup.faces)
    for (int k = 0; k < 3; ++k) {
      const int c = f[k], a = f[(k + 1) % 3], b = f[(k + 2) % 3];
      const Vector3 u = soup.points[a] - soup.points[c], v = soup.points[b] - soup.points[c];
      const double w = std::max(0.5 * u.dot(v) / std::max(u.cross(v).norm(), 1e-300), 1e-9);
      triplets.emplace_back(a, a, w), triplets.emplace_back(b, b, w);
      triplets.emplace_back(std::max(a, b), std::min(a, b), -w);
    }
  Sparse m(n, n);
  m.setFromTriplets(triplets.begin(), triplets.end());
  const double mean = m.diagonal().sum() / n;
  for (int i = 0; i < n; ++i) m.coeffRef(i, i) += 1e-6 * mean;
  m.makeCompressed();
  return m;
}

}  // namespace

const char* const kOptionsHelp =
    "  --e-max 0.05,0.02   tolerances, fractions of the diagonal (0.02)\n"
    "  --threads n         (2)\n"
    "  --repeat n          runs of each, the fastest counts (1)\n"
    "  --effort draft|normal|thorough   --t-junctions on|off   --self-seams on|off\n"
    "  --coarse FACES      files are remeshed to about so many faces first\n"
    "  --refine n          every file is followed by n finer copies, each with four times the faces (0)\n"
    "  --csv FILE          write the table\n"
    "  --against FILE      compare with an earlier table\n";

Options parse_options(int argc, char** argv) {
  Options o;
  for (int i = 1; i < argc; ++i) {
    const std::string arg = argv[i];
    if (arg.rfind("--", 0) != 0) {
      o.files.push_back(arg);
    } else if (arg == "--help") {
      throw std::invalid_argument(std::string("[options] [mesh...]\n") + kOptionsHelp);
    } else if (i + 1 < argc) {
      set_option(arg, argv[++i], o);
    } else {
      throw std::invalid_argument(arg + " needs a value");
    }
  }
  return o;
}

std::vector<InputMesh> own_shapes() {
  const TriangleSoup bumps = shapes::grid({64, 64}, [](double u, double v) {
    return Vector3(u, v, 0.12 * std::sin(5 * u) * std::cos(4 * v) + 0.05 * std::sin(9 * u + 3 * v));
  });
  return {own("torus", shapes::torus(96, 48)),
          own("sphere", shapes::sphere(28)),
          own("saddle", shapes::saddle(60, 0.8)),
          own("helicoid", shapes::helicoid(40, 60, 1, 2, 0.5)),
          own("closed_cylinder", shapes::closed_cylinder(96, 32)),
          own("box", shapes::box(24, {1, 2, 3})),
          own("bumps", bumps)};
}

std::vector<InputMesh> own_scaling() {
  std::vector<InputMesh> meshes;
  for (int n : {32, 64, 128, 256, 512}) meshes.push_back(own("torus", shapes::torus(2 * n, n / 2)));
  for (int n : {13, 26, 52, 104, 208}) meshes.push_back(own("bumpy_ball", bumpy_ball(n)));
  for (int n : {32, 64, 128, 256, 512})
    meshes.push_back(own("closed_cylinder", shapes::closed_cylinder(n, n * 3 / 4)));
  return meshes;
}

double yardstick(const TriangleSoup& soup) {
  const int n = static_cast<int>(soup.points.size());
  if (n < 3 || soup.faces.empty()) return 0;
  const Sparse m = laplacian(soup);
  Eigen::MatrixX3d rhs(n, 3);
  for (int i = 0; i < n; ++i) rhs.row(i) = soup.points[i].transpose();
  double best = 1e300, sum = 0, spent = 0;
  for (int round = 0; round < 7 && (round < 2 || spent < 2); ++round) {
    const double begin = thread_seconds();
    const Eigen::SimplicialLDLT<Sparse> solver(m);
    const Eigen::MatrixX3d x = solver.solve(rhs);
    const double took = thread_seconds() - begin;
    best = std::min(best, took), spent += took;
    sum += x.sum();
  }
  return std::isfinite(sum) ? best : 0;
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void reset_peak_memory() { std::ofstream("/proc/self/clear_refs") << "5"; }

double peak_memory_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) / 1024;
  return 0;
}

int run_all(const Options& options, const std::vector<InputMesh>& own, Row row) {
  CsvTable table;
  int status = 0;
  const auto run = [&](const std::string& name, const std::function<InputMesh()>& read) {
    for (double e_max : options.e_max) try {
        const InputMesh input = read();
        DecomposeParams params = options.params;
        params.e_max = e_max;
        table.add_row();
        table.put("mesh", input.name);
        table.put("e_max", e_max);
        table.put("faces", static_cast<double>(input.soup.faces.size()));
        row(input, params, options, table);
        if (!options.csv.empty()) write_csv(table, options.csv);
      } catch (const std::exception& e) {
        std::fprintf(stderr, "%s at %g: %s\n", name.c_str(), e_max, e.what());
        status = 1;
      }
  };
  for (const std::string& file : options.files)
    for (int times = 0; times <= options.refine; ++times)
      run(file, [&] { return sized_input(file, options.coarse, times); });
  if (options.files.empty())
    for (const InputMesh& mesh : own) run(mesh.name, [&] { return mesh; });
  if (!options.against.empty()) print_comparison(table, read_csv(options.against));
  return status;
}

}  // namespace sheetform::bench
