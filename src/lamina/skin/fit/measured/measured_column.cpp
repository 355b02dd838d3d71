// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/measured/measured_column.h"

#include <cmath>
#include <string>

namespace lamina::fit_detail {

MeasuredColumn read_column(const MeasuredTable& table, const JsonObject& entry,
                           MeasuredQuantity quantity, const MeasuredUnit& unit,
                           const NumberRange& range) {
  const std::string name(name_of(quantity));
  MeasuredColumn column{
      .values = table.numbers(
          name, closed_interval(range.low / unit.factor, range.high / unit.factor, unit.name)),
      .standard_deviations = {}};
  if (column.values.empty()) return column;
  column.standard_deviations =
      table.numbers(name + "_sd", {.low = 0.0, .includes_low = false, .unit = unit.name});
  if (column.standard_deviations.empty()) {
    const auto absolute = entry.optional("sd"), relative = entry.optional("relative_sd");
    if (!absolute && !relative)
      entry.value().fail("must say how well \"" + name + "\" is known: \"" + name +
                         "_sd\", \"sd\" or \"relative_sd\"");
    const double sd = absolute ? absolute->number(greater_than(0.0, unit.name)) : 0.0;
    const double share =
        relative ? relative->number({.low = 0.0, .high = 1.0, .includes_low = false}) : 0.0;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const double error = std::hypot(sd, share * column.values[row]);
      if (!(error > 0.0))
        table.fail(row, name, "is 0, of which \"relative_sd\" is no error; give \"sd\", too");
      column.standard_deviations.push_back(error);
    }
  }
  for (double& value : column.values) value *= unit.factor;
  for (double& sd : column.standard_deviations) sd *= unit.factor;
  return column;
}

}  // namespace lamina::fit_detail
