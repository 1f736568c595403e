#include "csv_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace sheetform::bench {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::size_t at = 0;
  while (true) {
    const std::size_t end = line.find(',', at);
    cells.push_back(line.substr(at, end - at));
    if (end == std::string::npos) return cells;
    at = end + 1;
  }
}

// The row of `table` for the same mesh at the same tolerance, -1 if none.
int matching_row(const CsvTable& table, const CsvTable& of, std::size_t row) {
  for (std::size_t r = 0; r < table.rows.size(); ++r)
    if (table.text(r, "mesh") == of.text(row, "mesh") &&
        table.number(r, "e_max") == of.number(row, "e_max") &&
        table.number(r, "faces") == of.number(row, "faces"))
      return static_cast<int>(r);
  return -1;
}

struct Ratios {
  double log_sum = 0;
  int count = 0;
  double best = 1e300, worst = 0;
  std::string best_row, worst_row;
  void add(double ratio, const std::string& row) {
    log_sum += std::log(ratio), ++count;
    if (ratio < best) best = ratio, best_row = row;
    if (ratio > worst) worst = ratio, worst_row = row;
  }
};

std::string name_of(const CsvTable& t, std::size_t row) {
  return t.text(row, "mesh") + " " + t.text(row, "e_max");
}

Ratios ratios_of(const CsvTable& now, const CsvTable& before, const std::string& column) {
  Ratios ratios;
  for (std::size_t r = 0; r < now.rows.size(); ++r) {
    const int old = matching_row(before, now, r);
    if (old < 0) continue;
    const auto a = now.number(r, column), b = before.number(static_cast<std::size_t>(old), column);
    if (a && b && *a > 0 && *b > 0) ratios.add(*a / *b, name_of(now, r));
  }
  return ratios;
}

void print_flags(const CsvTable& now, const CsvTable& before, const std::string& column) {
  int yes_now = 0, yes_before = 0, both = 0;
  std::string lost;
  for (std::size_t r = 0; r < now.rows.size(); ++r) {
    const int old = matching_row(before, now, r);
    if (old < 0) continue;
    const auto a = now.number(r, column), b = before.number(static_cast<std::size_t>(old), column);
    if (!a || !b) continue;
    ++both, yes_now += *a > 0, yes_before += *b > 0;
    if (*a == 0 && *b > 0) lost += " " + name_of(now, r) + ";";
  }
  if (both > 0)
    std::printf("%-22s %d of %d now, %d before%s%s\n", column.c_str(), yes_now, both, yes_before,
                lost.empty() ? "" : ", lost:", lost.c_str());
}

bool is_flag(const std::string& column) { return column == "valid" || column == "tolerance_met"; }

}  // namespace

int CsvTable::column(const std::string& name) const {
  const auto it = std::find(columns.begin(), columns.end(), name);
  return it == columns.end() ? -1 : static_cast<int>(it - columns.begin());
}

std::string CsvTable::text(std::size_t row, const std::string& name) const {
  const int c = column(name);
  return c < 0 || c >= static_cast<int>(rows[row].size()) ? "" : rows[row][c];
}

std::optional<double> CsvTable::number(std::size_t row, const std::string& name) const {
  const std::string cell = text(row, name);
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (cell.empty() || *end != '\0') return std::nullopt;
  return value;
}

void CsvTable::put(const std::string& name, const std::string& value) {
  int c = column(name);
  if (c < 0) {
    c = static_cast<int>(columns.size());
    columns.push_back(name);
    for (auto& row : rows) row.resize(columns.size());
  }
  rows.back()[c] = value;
}

void CsvTable::put(const std::string& name, double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  put(name, std::string(text));
}

std::string CsvTable::to_string() const {
  std::string out;
  const auto add = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) out += (i > 0 ? "," : "") + cells[i];
    out += '\n';
  };
  add(columns);
  for (const auto& row : rows) add(row);
  return out;
}

CsvTable read_csv(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot read " + path.string());
  CsvTable table;
  std::string line;
  while (std::getline(in, line)) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    std::vector<std::string> cells = cells_of(line);
    if (table.columns.empty()) {
      table.columns = std::move(cells);
    } else if (cells.size() != table.columns.size()) {
      throw std::runtime_error(path.string() + ": a row of " + std::to_string(cells.size()) +
                               " cells: " + line);
    } else {
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

void write_csv(const CsvTable& table, const std::filesystem::path& path) {
  std::ofstream out(path);
  out << table.to_string();
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

void print_comparison(const CsvTable& now, const CsvTable& before) {
  std::printf("%-22s %8s %6s   %s\n", "now / before", "geomean", "rows", "best, worst");
  for (const std::string& column : now.columns) {
    if (column == "mesh" || column == "e_max" || column == "faces" || before.column(column) < 0) continue;
    if (is_flag(column)) {
      print_flags(now, before, column);
      continue;
    }
    const Ratios r = ratios_of(now, before, column);
    if (r.count == 0) continue;
    std::printf("%-22s %8.3f %6d   %.3f (%s), %.3f (%s)\n", column.c_str(), std::exp(r.log_sum / r.count),
                r.count, r.best, r.best_row.c_str(), r.worst, r.worst_row.c_str());
  }
}

}  // namespace sheetform::bench
