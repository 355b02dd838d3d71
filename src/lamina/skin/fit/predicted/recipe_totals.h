// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "lamina/base/core/progress.h"
#include "lamina/skin/fit/measured/measurement.h"

namespace lamina::fit_detail {

/// Totals of a recipe by a table in place of a solver, at the bands of a measurement.
class RecipeTotals {
 public:
  virtual ~RecipeTotals() = default;

  /// Fractions of the incident light; the derivatives of what the surface mirrors are 0.
  struct Totals {
    double reflectance = 0.0;  ///< without what the surface mirrors
    double transmittance = 0.0;
  };
  /// @param numbers      what is free, [free number]
  /// @param derivatives  by these, [free number], or empty
  [[nodiscard]] virtual Totals at(std::span<const double> numbers, std::size_t band,
                                  std::span<Totals> derivatives) const = 0;
  [[nodiscard]] virtual double specular_reflectance() const = 0;
};

/// Whether a series is of totals of a recipe alone, whose free numbers are the same in all bands
/// and within the range of a table, and known no better than the table is right.
[[nodiscard]] bool has_recipe_totals(const Measurement& measurement, const MeasuredSeries& series);

/// The table of a series that has one.
/// @throws Interrupted if progress asks to stop.
[[nodiscard]] std::shared_ptr<const RecipeTotals> make_recipe_totals(const Measurement& measurement,
                                                                     const MeasuredSeries& series,
                                                                     const Progress& progress);

/// Series of equal keys have the same table.
[[nodiscard]] std::string recipe_totals_key(const Measurement& measurement,
                                            const MeasuredSeries& series);

}  // namespace lamina::fit_detail
