// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/predicted/measurement_tables.h"

#include "lamina/skin/fit/predicted/recipe_totals.h"

namespace lamina {

void MeasurementTables::prepare(const Measurement& measurement, const Progress& progress) {
  for (const MeasuredSeries& series : measurement.series) {
    if (!fit_detail::has_recipe_totals(measurement, series)) continue;
    const std::string key = fit_detail::recipe_totals_key(measurement, series);
    if (!tables_.contains(key))
      tables_[key] = fit_detail::make_recipe_totals(measurement, series, progress);
  }
}

std::shared_ptr<const fit_detail::RecipeTotals> MeasurementTables::find(
    const Measurement& measurement, const MeasuredSeries& series) const {
  if (tables_.empty() || !fit_detail::has_recipe_totals(measurement, series)) return nullptr;
  const auto found = tables_.find(fit_detail::recipe_totals_key(measurement, series));
  return found == tables_.end() ? nullptr : found->second;
}

}  // namespace lamina
