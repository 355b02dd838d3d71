// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/io/csv_table.h"

namespace lamina {

/// A quantity at ascending wavelengths, as it was measured.
struct SpectrumTable {
  std::vector<double> wavelengths;  ///< [nm], ascending
  std::vector<double> values;       ///< as many

  [[nodiscard]] bool covers(double wavelength) const {
    return wavelengths.front() <= wavelength && wavelength <= wavelengths.back();
  }
};

/// Linear between the entries; at a wavelength [nm] that the table covers.
[[nodiscard]] double interpolate(const SpectrumTable& table, double wavelength);

/// Wavelengths [nm] of the rows of a table, ascending, in [200, 3000]. Their column is the first if
/// none is named; its name says what it is, and the unit: "nm", "wavelength_nm", "lambda [um]".
/// @throws InvalidInput naming file and line.
[[nodiscard]] std::vector<double> read_wavelengths(const CsvTable& table, std::size_t column = 0);

/// Turns a table round whose wavelengths in a column fall, as those of many instruments do.
void raise_wavelengths(CsvTable& table, std::size_t column = 0);

/// A column over the wavelengths of its table, which may fall.
/// @param column  its name; empty in a table of two columns: the second.
/// @param range   of its values.
/// @throws InvalidInput naming file and line.
[[nodiscard]] SpectrumTable read_spectrum(CsvTable table, std::string_view column,
                                          const NumberRange& range);

}  // namespace lamina
