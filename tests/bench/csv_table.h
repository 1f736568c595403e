// Tables of measurements: a header line, then rows of comma-separated cells; what cannot be said is empty.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sheetform::bench {

struct CsvTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;

  int column(const std::string& name) const;  ///< -1 if there is none
  std::optional<double> number(std::size_t row, const std::string& name) const;
  std::string text(std::size_t row, const std::string& name) const;
  /// Starts a row; cells follow by put().
  void add_row() { rows.emplace_back(columns.size()); }
  /// In the last row; adds the column when it is new.
  void put(const std::string& name, const std::string& value);
  void put(const std::string& name, double value);
  std::string to_string() const;
};

/// Throws std::runtime_error when the file cannot be read or rows differ in length.
CsvTable read_csv(const std::filesystem::path& path);
void write_csv(const CsvTable& table, const std::filesystem::path& path);

/// Prints, for every numeric column that both have, the geometric mean of now / before over the rows of equal
/// mesh, faces and e_max, the best and the worst of them, and the rows where a count or flag got worse.
void print_comparison(const CsvTable& now, const CsvTable& before);

}  // namespace sheetform::bench
