// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/spectrum_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <optional>

#include "lamina/base/core/error.h"
#include "lamina/base/io/json_output.h"
#include "lamina/base/io/utf8_text.h"

namespace lamina {
namespace {

/// Words of a name without the marks between them: "Wavelength (nm)" has "wavelength" and "nm".
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words(1);
  for (const char c : name) {
    if (std::string_view(" _-()[]/.").find(c) == std::string_view::npos)
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!words.back().empty())
      words.emplace_back();
  }
  return words;
}

/// Nanometres per unit that a name of a column says, if it is one of wavelengths.
std::optional<double> wavelength_unit(std::string_view name) {
  for (const std::string& word : words_of(name)) {
    if (word == "nm") return 1.0;
    if (word == "um" || word == "µm" || word == "μm") return 1000.0;
  }
  return std::nullopt;
}

/// The place of the column of values.
std::size_t find_spectrum_column(const CsvTable& table, std::string_view column) {
  if (!column.empty()) return table.column(column);
  if (table.columns().size() == 2) return 1;
  throw InvalidInput(table.file() + ": has " + std::to_string(table.columns().size() - 1) +
                     " columns besides the wavelengths; \"column\" must say which");
}

}  // namespace

double interpolate(const SpectrumTable& table, double wavelength) {
  const auto& x = table.wavelengths;
  const auto above = std::ranges::upper_bound(x, wavelength);
  const auto i = static_cast<std::size_t>(above - x.begin());
  if (i == 0) return table.values.front();
  if (i == x.size()) return table.values.back();
  const double t = (wavelength - x[i - 1]) / (x[i] - x[i - 1]);
  return (1.0 - t) * table.values[i - 1] + t * table.values[i];
}

void raise_wavelengths(CsvTable& table, std::size_t column) {
  const auto is_number = [&](std::size_t row) {
    const std::string& cell = table.text(row, column);
    return !cell.empty() && cell.find_first_not_of("0123456789.,") == std::string::npos;
  };
  const std::size_t last = table.rows() - 1;
  if (is_number(0) && is_number(last) && table.number(0, column) > table.number(last, column))
    table.reverse_rows();
}

std::vector<double> read_wavelengths(const CsvTable& table, std::size_t column) {
  const std::string& name = table.columns()[column];
  const auto unit = wavelength_unit(name);
  if (!unit && column == 0)
    throw InvalidInput(table.file() +
                       ": the first column must be wavelengths, with their unit in its name, as "
                       "wavelength_nm, but is " +
                       json_quoted(excerpt(name)));
  if (!unit)
    throw InvalidInput(table.file() + ": column " + json_quoted(excerpt(name)) +
                       " must have the unit of its wavelengths in its name, as wavelength_nm");
  const NumberRange range =
      closed_interval(200.0 / *unit, 3000.0 / *unit, *unit == 1.0 ? "nm" : "um");
  std::vector<double> wavelengths;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double wavelength = *unit * table.number(row, column, range);
    if (row > 0 && wavelength <= wavelengths.back())
      table.fail(row, column,
                 std::string("must be longer than the wavelength before it, but is ") +
                     (wavelength == wavelengths.back() ? "the same, " : "") +
                     table.text(row, column));
    wavelengths.push_back(wavelength);
  }
  return wavelengths;
}

SpectrumTable read_spectrum(CsvTable table, std::string_view column, const NumberRange& range) {
  raise_wavelengths(table);
  SpectrumTable spectrum{.wavelengths = read_wavelengths(table), .values = {}};
  const std::size_t place = find_spectrum_column(table, column);
  for (std::size_t row = 0; row < table.rows(); ++row)
    spectrum.values.push_back(table.number(row, place, range));
  return spectrum;
}

}  // namespace lamina
