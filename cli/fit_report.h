// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lamina/fit/measurement_fit.h"
#include "lamina/io/json_output.h"
#include "lamina/plot/plot.h"

namespace lamina::cli {

[[nodiscard]] JsonOutput fit_json(const Measurement& measurement, const MeasurementFit& fit);

[[nodiscard]] std::string fit_text(const Measurement& measurement, const MeasurementFit& fit);

/// What was measured with its errors, what the fit predicts, and what is left.
[[nodiscard]] Plot fit_plot(const Measurement& measurement, const MeasurementFit& fit);

}  // namespace lamina::cli
