#include "sheetform/blueprint/assembly.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <unordered_map>
#include <utility>

#include "sheetform/blueprint/seams.h"
#include "sheetform/blueprint/sheet_svg.h"
#include "sheetform/blueprint/text.h"

namespace sheetform {
namespace {

using Json = nlohmann::ordered_json;

// Seams of each part, by index.
std::vector<std::vector<int>> seams_by_part(const Blueprint& b) {
  std::vector<std::vector<int>> out(b.parts.size());
  for (std::size_t s = 0; s < b.seams.size(); ++s) {
    out[b.seams[s].parts[0]].push_back(static_cast<int>(s));
    if (b.seams[s].parts[1] != b.seams[s].parts[0]) out[b.seams[s].parts[1]].push_back(static_cast<int>(s));
  }
  return out;
}

int other(const Seam& seam, int part) { return seam.parts[0] == part ? seam.parts[1] : seam.parts[0]; }

// Parts that hang together by seams, in ascending order; without `without`.
std::vector<int> reached(const Blueprint& b, const std::vector<std::vector<int>>& at, int start,
                         int without) {
  std::vector<char> seen(b.parts.size(), 0);
  std::vector<int> todo{start}, out;
  seen[start] = 1;
  while (!todo.empty()) {
    const int p = todo.back();
    todo.pop_back();
    out.push_back(p);
    for (int s : at[p])
      if (const int q = other(b.seams[s], p); q != without && !std::exchange(seen[q], 1)) todo.push_back(q);
  }
  std::sort(out.begin(), out.end());
  return out;
}

double glue_of(const Blueprint& b, const std::vector<int>& seams) {
  double sum = 0;
  for (int s : seams) sum += b.seams[s].length;
  return sum;
}

int last_part(const Blueprint& b, const std::vector<std::vector<int>>& at, const std::vector<int>& group) {
  if (group.size() < 3) return -1;
  std::vector<int> order = group;
  std::stable_sort(order.begin(), order.end(),
                   [&](int x, int y) { return glue_of(b, at[x]) < glue_of(b, at[y]); });
  for (int p : order) {
    const int start = group.front() == p ? group.back() : group.front();
    if (reached(b, at, start, p).size() + 1 == group.size()) return p;
  }
  return -1;
}

// Points of the flat parts that are one, since seams between them are glued.
class GluedPoints {
 public:
  int of(int t) const {
    for (auto it = to_.find(t); it != to_.end(); it = to_.find(t)) t = it->second;
    return t;
  }
  bool begun(const Seam& seam) const {
    return of(seam.vt[0].front()) == of(seam.vt[1].front()) || of(seam.vt[0].back()) == of(seam.vt[1].back());
  }
  void glue(const Seam& seam) {
    for (std::size_t i = 0; i < seam.vt[0].size(); ++i)
      if (const int a = of(seam.vt[0][i]), c = of(seam.vt[1][i]); a != c) to_[a] = c;
  }

 private:
  std::unordered_map<int, int> to_;
};

// Seams of a part with itself, those first whose sides hang together at an end already: from the tip of a
// slit outwards, like a zip. By number where none does.
std::vector<int> zipped(const Blueprint& b, std::vector<int> seams) {
  GluedPoints points;
  std::vector<int> out;
  while (!seams.empty()) {
    auto next = std::find_if(seams.begin(), seams.end(), [&](int s) { return points.begun(b.seams[s]); });
    if (next == seams.end()) next = seams.begin();
    points.glue(b.seams[*next]);
    out.push_back(*next);
    seams.erase(next);
  }
  return out;
}

// Joins one group of parts, the strongest connection first.
void order_group(const Blueprint& b, const std::vector<std::vector<int>>& at, const std::vector<int>& group,
                 std::vector<AssemblyStep>& out) {
  const int last = last_part(b, at, group);
  std::unordered_map<int, std::vector<int>> with_itself;
  for (int p : group) {
    std::vector<int> own;
    std::copy_if(at[p].begin(), at[p].end(), std::back_inserter(own),
                 [&](int s) { return other(b.seams[s], p) == p; });
    with_itself[p] = zipped(b, std::move(own));
  }
  std::vector<char> built(b.parts.size(), 0);
  for (std::size_t step = 0; step < group.size(); ++step) {
    AssemblyStep best;
    double best_key = -1;
    for (int p : group) {
      if (built[p] || (p == last && step + 1 < group.size())) continue;
      AssemblyStep candidate{p, {}, 0};
      double with_others = 0;
      for (int s : at[p])
        if (const int q = other(b.seams[s], p); q != p && built[q])
          candidate.seams.push_back(s), with_others += b.seams[s].length;
      candidate.seams.insert(candidate.seams.begin(), with_itself[p].begin(), with_itself[p].end());
      candidate.joined = glue_of(b, candidate.seams);
      const double key = step == 0 ? b.parts[p].area : with_others;
      if (key > best_key) best = std::move(candidate), best_key = key;
    }
    built[best.part] = 1;
    out.push_back(std::move(best));
  }
}

double length_of_line(const BlueprintLine& line) {
  double sum = length_of(line.points);
  if (line.closed && line.points.size() > 1) sum += (line.points.front() - line.points.back()).norm();
  return sum;
}

Vector2 size_of(const BlueprintPart& part) {
  const Placement turn = flat_turn(part.outline);
  return bounds_of(placed(part.outline, turn)).size();
}

std::vector<int> sheet_of_parts(const Blueprint& b) {
  std::vector<int> sheet(b.parts.size(), 0);
  for (std::size_t s = b.sheets.size(); s-- > 0;)
    for (const PlacedPart& p : b.sheets[s].parts) sheet[p.part] = static_cast<int>(s) + 1;
  return sheet;
}

Json part_json(const Blueprint& b, int i, const std::vector<int>& seams, int sheet) {
  const BlueprintPart& part = b.parts[i];
  const Vector2 size = size_of(part);
  Json neighbours = Json::array();
  for (int s : seams)
    neighbours.push_back({{"seam", b.seams[s].number}, {"part", b.parts[other(b.seams[s], i)].label}});
  return {{"label", part.label},
          {"patch", part.patch},
          {"width_mm", size.x()},
          {"height_mm", size.y()},
          {"area_mm2", part.area},
          {"sheet", sheet},
          {"copies", b.options.copies},
          {"mirror_of", part.mirror_of < 0 ? Json(nullptr) : Json(b.parts[part.mirror_of].label)},
          {"neighbours", std::move(neighbours)}};
}

Json totals_json(const Totals& t) {
  return {
      {"parts", t.parts},    {"sheets", t.sheets}, {"cut_mm", t.cut},    {"score_mm", t.score},
      {"drawn_mm", t.drawn}, {"glue_mm", t.glue},  {"area_mm2", t.area}, {"waste_share", 1 - t.used_share},
      {"minutes", t.minutes}};
}

// Quoted always; a leading = + - @ gets a quote mark before it, so that no spreadsheet takes it for a
// formula.
std::string csv_cell(const std::string& text) {
  std::string out = "\"";
  if (!text.empty() && std::string("=+-@\t\r").find(text.front()) != std::string::npos) out += '\'';
  for (char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

}  // namespace

std::vector<AssemblyStep> assembly_order(const Blueprint& b) {
  const auto at = seams_by_part(b);
  std::vector<char> done(b.parts.size(), 0);
  std::vector<AssemblyStep> out;
  for (std::size_t p = 0; p < b.parts.size(); ++p) {
    if (done[p]) continue;
    const std::vector<int> group = reached(b, at, static_cast<int>(p), -1);
    for (int q : group) done[q] = 1;
    order_group(b, at, group, out);
  }
  return out;
}

std::string step_text(const Blueprint& b, const AssemblyStep& step) {
  std::vector<std::pair<int, std::string>> seams_to;  // neighbours in the order of their first seam
  for (int s : step.seams) {
    const int to = other(b.seams[s], step.part);
    const auto known =
        std::find_if(seams_to.begin(), seams_to.end(), [&](const auto& n) { return n.first == to; });
    const std::string number = std::to_string(b.seams[s].number);
    if (known == seams_to.end())
      seams_to.emplace_back(to, number);
    else
      known->second += ", " + number;
  }
  std::string text = b.parts[step.part].label;
  for (const auto& [to, numbers] : seams_to)
    text += (text.size() == b.parts[step.part].label.size() ? ": to " : "; to ") +
            (to == step.part ? "itself" : b.parts[to].label) +
            (numbers.find(',') == std::string::npos ? " at seam " : " at seams ") + numbers;
  return text;
}

Totals totals_of(const Blueprint& b, const Profile& profile) {
  Totals t;
  const int copies = b.options.copies;
  t.parts = copies * static_cast<int>(b.parts.size()), t.sheets = static_cast<int>(b.sheets.size());
  for (const BlueprintPart& part : b.parts) {
    t.area += copies * part.area;
    for (const BlueprintLine& line : part.lines) {
      if (!profile.of(line.operation).drawn) continue;
      const double length = copies * length_of_line(line);
      switch (line.operation) {
        case Operation::kText:
        case Operation::kNotch:
          t.drawn += length;
          break;
        case Operation::kScoreMountain:
        case Operation::kScoreValley:
          t.score += length;
          break;
        case Operation::kCutInner:
        case Operation::kCutOuter:
          t.cut += length;
          break;
        case Operation::kGuide:
          break;
      }
    }
  }
  for (const Seam& seam : b.seams) t.glue += copies * seam.length;
  t.used_share = b.used_share;
  t.minutes =
      (t.cut * profile.minutes_per_metre_cut + (t.score + t.drawn) * profile.minutes_per_metre_score) / 1000;
  return t;
}

std::string to_part_list_json(const Blueprint& b, const Profile& profile) {
  const auto at = seams_by_part(b);
  const std::vector<int> sheet = sheet_of_parts(b);
  Json parts = Json::array(), seams = Json::array(), steps = Json::array();
  for (std::size_t p = 0; p < b.parts.size(); ++p)
    parts.push_back(part_json(b, static_cast<int>(p), at[p], sheet[p]));
  for (const Seam& s : b.seams)
    seams.push_back({{"number", s.number},
                     {"parts", {b.parts[s.parts[0]].label, b.parts[s.parts[1]].label}},
                     {"length_mm", s.length},
                     {"notches", {s.code[0], s.code[1]}},
                     {"arch", s.arch}});
  for (const AssemblyStep& step : assembly_order(b)) {
    Json numbers = Json::array();
    for (int s : step.seams) numbers.push_back(b.seams[s].number);
    steps.push_back(
        {{"part", b.parts[step.part].label}, {"seams", std::move(numbers)}, {"joined_mm", step.joined}});
  }
  const Json j = {{"schema", "sheetform-parts/1"},
                  {"origin", Json::parse(origin_json(b))},
                  {"parts", parts},
                  {"seams", seams},
                  {"steps", steps},
                  {"totals", totals_json(totals_of(b, profile))},
                  {"warnings", b.warnings}};
  return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_part_list_csv(const Blueprint& b) {
  const auto at = seams_by_part(b);
  const std::vector<int> sheet = sheet_of_parts(b);
  std::string out = "label,width_mm,height_mm,area_mm2,sheet,copies,mirror_of,neighbours,job,link\r\n";
  for (std::size_t p = 0; p < b.parts.size(); ++p) {
    const BlueprintPart& part = b.parts[p];
    const Vector2 size = size_of(part);
    std::string neighbours;
    for (int s : at[p])
      neighbours += (neighbours.empty() ? "" : " ") + b.parts[other(b.seams[s], static_cast<int>(p))].label +
                    ":" + std::to_string(b.seams[s].number);
    out += csv_cell(part.label) + ',' + rounded(size.x(), 2) + ',' + rounded(size.y(), 2) + ',' +
           rounded(part.area, 1) + ',' + std::to_string(sheet[p]) + ',' + std::to_string(b.options.copies) +
           ',' + csv_cell(part.mirror_of < 0 ? "" : b.parts[part.mirror_of].label) + ',' +
           csv_cell(neighbours) + ',' + csv_cell(b.origin.job) + ',' + csv_cell(b.origin.link) + "\r\n";
  }
  return out;
}

}  // namespace sheetform
