// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/io/json_input.h"

namespace lamina {

/// A table in a text file: lines of cells, of which the first names the columns, or the one before
/// the first line of numbers where instruments say something of themselves before it. Empty lines,
/// and those that start with #, are passed over. Cells are parted by commas, semicolons, tabs or
/// blanks; one in quotes may hold them. Numbers have a decimal point, or all of a table a comma
/// where no comma parts its cells. What is wrong is said in one line:
///
///   skin.csv:12: R must lie in [0, 1.2], but is 37.2
class CsvTable {
 public:
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::span<const std::string> columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return lines_.size(); }

  /// The place of a column, or none.
  [[nodiscard]] std::optional<std::size_t> find_column(std::string_view name) const;

  /// Index of a column. @throws InvalidInput naming those that there are.
  [[nodiscard]] std::size_t column(std::string_view name) const;

  [[nodiscard]] const std::string& text(std::size_t row, std::size_t column) const {
    return cells_[row * columns_.size() + column];
  }

  /// A cell as a finite number. @throws InvalidInput if it is none or out of range.
  [[nodiscard]] double number(std::size_t row, std::size_t column,
                              const NumberRange& range = {}) const;

  /// The rows from the last to the first.
  void reverse_rows();

  /// Throws InvalidInput: `FILE:LINE: COLUMN MESSAGE`.
  [[noreturn]] void fail(std::size_t row, std::size_t column, std::string_view message) const;

 private:
  friend CsvTable parse_csv(std::string_view text, std::string name, MemoryBudget& memory);
  std::string file_;
  std::vector<std::string> columns_;
  std::vector<std::string> cells_;  ///< [row][column]
  std::vector<int> lines_;          ///< [row], counted from 1
  char decimal_mark_ = '.';
};

/// @param name  the file that messages name.
/// @throws InvalidInput with name and line if a line has more or fewer cells than the first one, a
///         column is there twice or has no name, or there is no line of values; FileError if it
///         takes more memory than is left.
[[nodiscard]] CsvTable parse_csv(std::string_view text, std::string name, MemoryBudget& memory);

/// Reads a file. @throws FileError if it cannot be read; InvalidInput as parse_csv.
[[nodiscard]] CsvTable load_csv(const std::filesystem::path& file, MemoryBudget& memory);

/// A text as a cell of such a table with commas: in quotes where it needs them, without line ends,
/// and behind an apostrophe where programs of spreadsheets would take it for a formula.
[[nodiscard]] std::string csv_cell(std::string_view text);

}  // namespace lamina
