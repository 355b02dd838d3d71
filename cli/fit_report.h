// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lamina/base/io/json_output.h"
#include "lamina/base/plot/plot.h"
#include "lamina/skin/fit/measurement_fit.h"

namespace lamina::cli {

/// The numbers found for what is free, by band or one.
[[nodiscard]] std::vector<const FittedNumber*> numbers_of(const MeasurementFit& fit,
                                                          std::size_t free);

[[nodiscard]] JsonOutput fit_json(const Measurement& measurement, const MeasurementFit& fit);

[[nodiscard]] std::string fit_text(const Measurement& measurement, const MeasurementFit& fit);

/// Plot of measured values with their errors, predictions of the fit, and residuals.
[[nodiscard]] Plot fit_plot(const Measurement& measurement, const MeasurementFit& fit);

}  // namespace lamina::cli
