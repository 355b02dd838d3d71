// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>

#include "lamina/base/core/progress.h"
#include "lamina/skin/fit/measured/measurement.h"

namespace lamina {

namespace fit_detail {
class RecipeTotals;
}

/// Tables of totals that fits of the recipes of skin and leaves look up, where a solver would
/// take a hundred times as long: for many measurements of one kind.
class MeasurementTables {
 public:
  /// Makes the tables that a measurement asks for and that are not there yet. Not to be called
  /// while another thread uses them.
  /// @throws Interrupted if progress asks to stop.
  void prepare(const Measurement& measurement, const Progress& progress = {});

  /// Table of a series; null if it has none.
  [[nodiscard]] std::shared_ptr<const fit_detail::RecipeTotals> find(
      const Measurement& measurement, const MeasuredSeries& series) const;

 private:
  std::map<std::string, std::shared_ptr<const fit_detail::RecipeTotals>> tables_;
};

}  // namespace lamina
