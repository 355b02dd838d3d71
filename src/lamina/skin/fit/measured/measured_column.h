// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "lamina/skin/fit/measured/measured_table.h"
#include "lamina/skin/fit/measured/measurement.h"

namespace lamina::fit_detail {

/// Unit of an entry's numbers: their factor to fractions or 1/mm².
struct MeasuredUnit {
  std::string_view name;
  double factor = 1.0;
};

/// A column, with its errors, of a table.
struct MeasuredColumn {
  std::vector<double> values, standard_deviations;  ///< [row]; empty without the column
};

/// Errors from a column, or from "sd" and "relative_sd" of the entry, which add in quadrature.
/// @param range  of values that are no longer in the unit.
[[nodiscard]] MeasuredColumn read_column(const MeasuredTable& table, const JsonObject& entry,
                                         MeasuredQuantity quantity, const MeasuredUnit& unit,
                                         const NumberRange& range);

}  // namespace lamina::fit_detail
