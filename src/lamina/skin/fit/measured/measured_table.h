// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/io/csv_table.h"
#include "lamina/base/io/json_input.h"
#include "lamina/skin/fit/measured/iad_file.h"

namespace lamina::fit_detail {

/// The keys of an entry that hold a column each, and the columns of its file.
[[nodiscard]] const std::vector<std::string_view>& measured_columns();

/// Rows of numbers in named columns: of the CSV file that an entry names, or of its arrays.
class MeasuredTable {
 public:
  /// @throws InvalidInput if there are both, none, or arrays of different lengths.
  explicit MeasuredTable(const JsonObject& entry);

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] bool has(std::string_view column) const;

  /// [row]; empty without such a column. @throws InvalidInput naming the place of what is no such
  /// number.
  [[nodiscard]] std::vector<double> numbers(std::string_view column,
                                            const NumberRange& range) const;

  /// Turns the rows of a file round whose wavelengths fall.
  void raise_rows();

  /// [row] [nm], ascending; empty without wavelengths.
  [[nodiscard]] std::vector<double> ascending_wavelengths() const;

  /// The file of iad that holds the rows, or none.
  [[nodiscard]] const std::optional<IadFile>& iad() const { return iad_; }

  /// Columns of a file that were not taken, and how to take them; empty without a file.
  [[nodiscard]] std::string other_columns(std::string_view wanted) const;

  /// Throws InvalidInput that names the place and the column.
  [[noreturn]] void fail(std::size_t row, std::string_view column,
                         const std::string& message) const;

 private:
  /// The place of a column in the file, by the name that "columns" has for it or its own.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view column) const;
  void check_names(const JsonInput& columns);

  JsonObject entry_;
  std::map<std::string, std::string, std::less<>> names_;  ///< of columns in the file
  std::optional<IadFile> iad_;
  std::optional<CsvTable> csv_;
  std::size_t rows_ = 0;
};

}  // namespace lamina::fit_detail
