// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/fit/internal/measured_table.h"

#include <algorithm>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/spectrum/spectrum_table.h"

namespace lamina::fit_detail {
namespace {

constexpr std::string_view wavelength_column = "wavelength_nm";

}  // namespace

const std::vector<std::string_view>& measured_columns() {
  static const std::vector<std::string_view> columns = {wavelength_column,
                                                        "k_per_mm",
                                                        "r_mm",
                                                        "t_ps",
                                                        "frequency_mhz",
                                                        "reflectance",
                                                        "reflectance_sd",
                                                        "transmittance",
                                                        "transmittance_sd",
                                                        "unscattered_transmittance",
                                                        "unscattered_transmittance_sd",
                                                        "amplitude",
                                                        "amplitude_sd",
                                                        "phase_deg",
                                                        "phase_deg_sd"};
  return columns;
}

MeasuredTable::MeasuredTable(const JsonObject& entry) : entry_(entry) {
  const auto file = entry.optional("file");
  std::optional<JsonInput> longest;
  for (const std::string_view column : measured_columns()) {
    const auto given = entry.optional(column);
    if (!given) continue;
    const bool is_error_of_all = column.ends_with("_sd") && given->is_number();
    if (file && !is_error_of_all) given->fail("stands in the file where one is given");
    if (!given->is_array()) {
      rows_ = std::max<std::size_t>(rows_, 1);
      continue;
    }
    const std::size_t size = given->array(1, 100'000).size();
    if (longest && size != rows_)
      given->fail("must have " + std::to_string(rows_) + " numbers, as " + longest->path() +
                  " has, but has " + std::to_string(size));
    longest = given;
    rows_ = size;
  }
  if (file) {
    csv_ = load_csv(file->file_path(), file->memory());
    rows_ = csv_->rows();
    for (const std::string_view column : measured_columns())
      if (entry.has(column) && csv_->find_column(column))
        entry.required(column).fail("is a column of the file, too");
  } else if (rows_ == 0) {
    entry.value().fail("must have \"file\", or arrays such as \"reflectance\"");
  }
}

bool MeasuredTable::has(std::string_view column) const {
  return (csv_ && csv_->find_column(column)) || entry_.has(column);
}

std::vector<double> MeasuredTable::numbers(std::string_view column,
                                           const NumberRange& range) const {
  if (!has(column)) return {};
  const auto place = csv_ ? csv_->find_column(column) : std::nullopt;
  if (!place) return entry_.required(column).number_or_numbers(rows_, range);
  std::vector<double> numbers;
  for (std::size_t row = 0; row < rows_; ++row) numbers.push_back(csv_->number(row, *place, range));
  return numbers;
}

std::vector<double> MeasuredTable::ascending_wavelengths() const {
  if (csv_) {
    // A file that starts with what was measured has a row for each band.
    if (std::ranges::count(measured_columns().begin() + 1, measured_columns().end(),
                           csv_->columns().front()) > 0)
      return {};
    return read_wavelengths(*csv_);
  }
  const std::vector<double> wavelengths =
      numbers(wavelength_column, closed_interval(200.0, 3000.0, "nm"));
  for (std::size_t row = 1; row < wavelengths.size(); ++row)
    if (wavelengths[row] <= wavelengths[row - 1])
      fail(row, wavelength_column,
           "must be longer than the wavelength before it, but is " + number_text(wavelengths[row]));
  return wavelengths;
}

void MeasuredTable::fail(std::size_t row, std::string_view column,
                         const std::string& message) const {
  if (csv_ && !entry_.has(column)) csv_->fail(row, csv_->find_column(column).value_or(0), message);
  const JsonInput value = entry_.required(column);
  throw InvalidInput((value.is_array() ? value.array()[row] : value).where() + " " + message);
}

}  // namespace lamina::fit_detail
