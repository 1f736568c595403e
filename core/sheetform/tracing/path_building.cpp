#include "sheetform/tracing/path_building.h"

#include <algorithm>

namespace sheetform {
namespace {

using Step = Walk::Step;

// Cycles of at most this many steps come from chains of neighbouring arcs that overlap; longer ones are real.
constexpr int kShortCycle = 5;

// Cuts out v ... v when the second v follows within kShortCycle steps (a spike a-b-a is the shortest case).
std::vector<Step> without_short_cycles(const std::vector<Step>& steps) {
  std::vector<Step> out;
  for (const Step& step : steps) {
    const int size = static_cast<int>(out.size());
    int at = size - 1;
    while (at >= std::max(0, size - kShortCycle) && out[at].vertex != step.vertex) --at;
    if (at >= std::max(0, size - kShortCycle)) out.resize(at + 1);
    if (out.empty() || out.back().vertex != step.vertex) out.push_back(step);
  }
  return out;
}

// The same across the seam of a loop: turns the start away from it and cleans again.
std::vector<Step> without_short_cycles_of_loop(std::vector<Step> steps) {
  std::rotate(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  return without_short_cycles(steps);
}

bool are_corners_of_a_face(const SurfaceMesh& mesh, int a, int b, int c) {
  const int e = mesh.find_edge(a, b);
  if (e < 0) return false;
  for (int f : {mesh.edges[e].f0, mesh.edges[e].f1})
    if (f >= 0 && std::find(mesh.faces[f].begin(), mesh.faces[f].end(), c) != mesh.faces[f].end())
      return true;
  return false;
}

// Two consecutive edges of one triangle become its third edge. Never an edge between two terminal vertices:
// it may be a border or a crease.
bool is_ear(const PathBuilder& in, const Step& a, const Step& b, const Step& c) {
  if (in.graph.terminal[a.vertex] && in.graph.terminal[c.vertex]) return false;
  return a.vertex != c.vertex && are_corners_of_a_face(in.mesh, a.vertex, b.vertex, c.vertex);
}

std::vector<Step> without_ears(const PathBuilder& in, std::vector<Step> steps, bool loop) {
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<Step> out;
    for (const Step& step : steps) {
      if (out.size() >= 2 && is_ear(in, out[out.size() - 2], out.back(), step))
        out.pop_back(), changed = true;
      out.push_back(step);
    }
    if (loop && out.size() > 3) {
      if (is_ear(in, out[out.size() - 2], out.back(), out.front())) out.pop_back(), changed = true;
      if (is_ear(in, out.back(), out.front(), out[1])) out.erase(out.begin()), changed = true;
    }
    steps = std::move(out);
  }
  return steps;
}

bool passes_terminal(const TracingGraph& graph, const std::vector<Step>& steps, bool loop) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool end = !loop && (i == 0 || i + 1 == steps.size());
    if (!end && graph.terminal[steps[i].vertex]) return true;
  }
  return false;
}

// True when a vertex occurs twice, or when vertices far apart along the path are neighbours on the mesh: such
// a path would leave a sliver one edge wide between two of its own parts.
bool touches_itself(const SurfaceMesh& mesh, const std::vector<Step>& steps, bool loop) {
  constexpr int kNear = 6;  // steps; a bend or a zigzag of the chain stays below
  const int n = static_cast<int>(steps.size());
  std::vector<std::pair<int, int>> where;  // vertex, position
  for (int i = 0; i < n; ++i) where.emplace_back(steps[i].vertex, i);
  std::sort(where.begin(), where.end());
  for (int i = 0; i + 1 < n; ++i)
    if (where[i].first == where[i + 1].first) return true;
  for (int i = 0; i < n; ++i) {
    const int v = steps[i].vertex;
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e) {
      const int w = mesh.edges[*e].other(v);
      const auto it = std::lower_bound(where.begin(), where.end(), std::pair(w, 0));
      if (it == where.end() || it->first != w) continue;
      const int apart = std::abs(it->second - i);
      if (std::min(apart, loop ? n - apart : apart) > kNear) return true;
    }
  }
  return false;
}

bool is_chain_of_edges(const SurfaceMesh& mesh, const std::vector<Step>& steps, bool loop) {
  const std::size_t n = steps.size();
  for (std::size_t i = 0; i + (loop ? 0 : 1) < n; ++i)
    if (mesh.find_edge(steps[i].vertex, steps[(i + 1) % n].vertex) < 0) return false;
  return true;
}

}  // namespace

void PathBuilder::append(const TracingGraph::Arc& arc, Walk& walk) const {
  const int head = TracingGraph::vertex(arc.to);
  const Vector3 way = mesh.points[head] - mesh.points[walk.steps.back().vertex];
  for (int i = arc.chain_begin; i < arc.chain_end; ++i)
    walk.steps.push_back(
        {graph.chain[i], static_cast<signed char>(closest_direction(field, graph.chain[i], way))});
  walk.steps.push_back({head, static_cast<signed char>(arc.to & 3)});
  const double d = arc.drift / 45.0;
  walk.length += arc.length;
  walk.drift_length += arc.length * d * d;
}

Path PathBuilder::finish(Walk walk, bool loop) const {
  std::vector<Step> steps = without_short_cycles(walk.steps);
  if (loop) steps = without_short_cycles_of_loop(std::move(steps));
  steps = without_ears(*this, std::move(steps), loop);
  const std::size_t least = loop ? 3 : 2;
  if (steps.size() < least || passes_terminal(graph, steps, loop) || touches_itself(mesh, steps, loop) ||
      !is_chain_of_edges(mesh, steps, loop))
    return {};
  Path path;
  path.loop = loop;
  path.drift = walk.length > 0 ? walk.drift_length / walk.length : 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    path.vertices.push_back(steps[i].vertex);
    path.dirs.push_back(steps[i].dir);
    const std::size_t next = (i + 1) % steps.size();
    if (loop || next != 0)
      path.length += (mesh.points[steps[i].vertex] - mesh.points[steps[next].vertex]).norm();
  }
  return path;
}

Walk reversed(const Walk& walk) {
  Walk out = walk;
  std::reverse(out.steps.begin(), out.steps.end());
  for (Walk::Step& step : out.steps) step.dir = static_cast<signed char>((step.dir + 2) & 3);
  return out;
}

}  // namespace sheetform
