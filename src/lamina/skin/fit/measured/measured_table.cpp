// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/measured/measured_table.h"

#include <algorithm>
#include <cctype>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_output.h"
#include "lamina/base/spectrum/spectrum_table.h"

namespace lamina::fit_detail {
namespace {

constexpr std::string_view wavelength_column = "wavelength_nm";

/// Whether a name is that of a quantity in percent, as instruments write it: "%R", "T [%]",
/// "Reflectance (%)".
bool is_percent_of(std::string_view name, std::string_view column) {
  std::string letters;
  bool has_percent = false;
  for (const char c : name) {
    if (c == '%')
      has_percent = true;
    else if (std::string_view(" ()[]_-").find(c) == std::string_view::npos)
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return has_percent && (column == "reflectance" || column == "transmittance") &&
         (letters == column || letters == column.substr(0, 1));
}

}  // namespace

const std::vector<std::string_view>& measured_columns() {
  static const std::vector<std::string_view> columns = {wavelength_column,
                                                        "k_per_mm",
                                                        "fx_per_mm",
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
    const std::filesystem::path path = file->file_path();
    if (path.extension() == ".rxt" || path.extension() == ".RXT") {
      iad_ = read_iad_file(read_file_bytes(path, file->memory()), path.string());
      csv_ = parse_csv(iad_->table, path.string(), file->memory());
    } else {
      csv_ = load_csv(path, file->memory());
    }
    rows_ = csv_->rows();
    if (const auto columns = entry.optional("columns")) check_names(*columns);
    for (const std::string_view column : measured_columns())
      if (entry.has(column) && find(column))
        entry.required(column).fail("is a column of the file, too");
  } else if (entry.has("columns")) {
    entry.required("columns").fail("needs \"file\", whose columns it names");
  } else if (rows_ == 0) {
    entry.value().fail("must have \"file\", or arrays such as \"reflectance\"");
  }
}

void MeasuredTable::check_names(const JsonInput& columns) {
  const JsonObject names = columns.object(measured_columns());
  for (const std::string_view column : measured_columns())
    if (const auto name = names.optional(column)) {
      if (!csv_->find_column(name->string()))
        name->fail("must be a column of its file, but is " + json_quoted(name->string()) +
                   other_columns(""));
      names_.emplace(column, name->string());
    }
}

std::optional<std::size_t> MeasuredTable::find(std::string_view column) const {
  if (!csv_) return std::nullopt;
  if (const auto name = names_.find(column); name != names_.end())
    return csv_->find_column(name->second);
  if (const auto place = csv_->find_column(column)) return place;
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < csv_->columns().size(); ++i) {
    if (!is_percent_of(csv_->columns()[i], column)) continue;
    if (found) return std::nullopt;
    found = i;
  }
  if (const auto unit = entry_.optional("unit");
      found && unit && unit->is_string() && unit->string() == "fraction")
    unit->fail("must be \"percent\", as column " + json_quoted(csv_->columns()[*found]) +
               " of its file says, but is \"fraction\"");
  return found;
}

std::string MeasuredTable::other_columns(std::string_view wanted) const {
  if (!csv_) return {};
  std::string list;
  for (const std::string& name : csv_->columns())
    list += (list.empty() ? "" : ", ") + json_quoted(name);
  list = "; its file has the columns " + list;
  if (wanted.empty()) return list;
  return list + ", and \"columns\": { " + json_quoted(std::string(wanted)) + ": " +
         json_quoted(csv_->columns().back()) + " } would take one of them";
}

bool MeasuredTable::has(std::string_view column) const {
  return find(column) || entry_.has(column);
}

std::vector<double> MeasuredTable::numbers(std::string_view column,
                                           const NumberRange& range) const {
  if (!has(column)) return {};
  const auto place = find(column);
  if (!place) return entry_.required(column).number_or_numbers(rows_, range);
  std::vector<double> numbers;
  for (std::size_t row = 0; row < rows_; ++row) numbers.push_back(csv_->number(row, *place, range));
  return numbers;
}

void MeasuredTable::raise_rows() {
  if (csv_) raise_wavelengths(*csv_, find(wavelength_column).value_or(0));
}

std::vector<double> MeasuredTable::ascending_wavelengths() const {
  if (csv_) {
    if (const auto place = find(wavelength_column)) return read_wavelengths(*csv_, *place);
    // A file that starts with what was measured has a row for each band.
    if (std::ranges::any_of(measured_columns(),
                            [&](std::string_view column) { return find(column) == 0; }))
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
  if (csv_ && !entry_.has(column)) csv_->fail(row, find(column).value_or(0), message);
  const JsonInput value = entry_.required(column);
  throw InvalidInput((value.is_array() ? value.array()[row] : value).where() + " " + message);
}

}  // namespace lamina::fit_detail
