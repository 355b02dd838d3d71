// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lamina/skin/fit/measurement_fit.h"

namespace lamina::cli {

/// How a fit was made.
struct FitMaking {
  std::vector<std::string> arguments;  ///< of lamina, those that the result depends on
  std::string file;                    ///< text of the measurement file; may be empty
};

/// A fit as one HTML page that needs nothing else: what was measured and assumed, what was found
/// and how well, residuals, correlations, notes in full.
[[nodiscard]] std::string fit_page(const Measurement& measurement, const MeasurementFit& fit,
                                   const FitMaking& making);

/// A file of a batch.
struct BatchRow {
  std::string name;
  const MeasurementFit* fit = nullptr;  ///< none if it was refused
  std::string refusal;
};

/// A batch as such a page, with a row for each file.
[[nodiscard]] std::string batch_page(std::span<const BatchRow> rows, const FitMaking& making);

}  // namespace lamina::cli
