// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/skin/fit/predicted/measurement_model.h"

namespace lamina {

/// Expects the derivatives of a model to be those of differences of its predictions.
inline void expect_derivatives_of_predictions(const fit_detail::MeasurementModel& model,
                                              std::span<const double> at, double absolute) {
  const DenseMatrix derivatives = model.derivatives(at);
  for (std::size_t u = 0; u < at.size(); ++u) {
    std::vector<double> below(at.begin(), at.end()), above = below;
    const double h = 3e-4 * at[u];
    below[u] -= h;
    above[u] += h;
    const auto low = model.predict(below), high = model.predict(above);
    for (std::size_t i = 0; i < derivatives.rows; ++i) {
      const double expected = (high[i] - low[i]) / (2.0 * h);
      EXPECT_NEAR(derivatives(i, u), expected, 2e-5 * std::abs(expected) + absolute)
          << "point " << i << " by " << model.parameters()[u].name;
    }
  }
}

}  // namespace lamina
