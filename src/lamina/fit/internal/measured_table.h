// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/io/csv_table.h"
#include "lamina/io/json_input.h"

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

  /// [row] [nm], ascending; empty without wavelengths.
  [[nodiscard]] std::vector<double> ascending_wavelengths() const;

  /// Throws InvalidInput that names the place and the column.
  [[noreturn]] void fail(std::size_t row, std::string_view column,
                         const std::string& message) const;

 private:
  JsonObject entry_;
  std::optional<CsvTable> csv_;
  std::size_t rows_ = 0;
};

}  // namespace lamina::fit_detail
