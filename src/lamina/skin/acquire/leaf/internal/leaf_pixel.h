// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/base/core/small_matrix.h"
#include "lamina/skin/acquire/leaf/internal/leaf_light.h"
#include "lamina/skin/acquire/leaf/leaf_pixels.h"

namespace lamina::detail {

/// Free numbers of a pixel: those of the leaf, illumination and gloss.
inline constexpr std::size_t most_leaf_numbers = 11;
using LeafCoordinates = SmallVector<most_leaf_numbers>;
using LeafMatrix = SmallMatrix<most_leaf_numbers>;

/// All that pixels have alike.
struct LeafPixelModel {
  std::vector<LeafSpectrum> spectra;  ///< [band]
  LeafParameters leaf;
  std::vector<double LeafParameters::*> values;       ///< of the numbers of the leaf
  std::vector<FitParameter> parameters;               ///< those, illumination and gloss
  LeafCoordinates prior, prior_deviation, low, high;  ///< of the coordinates
  LeafLight light;
  std::vector<double> ground, deviation, missed;  ///< [band]

  [[nodiscard]] std::size_t size() const { return parameters.size(); }
};

/// Prediction of a pixel with these coordinates.
struct LeafPrediction {
  std::vector<double> reflectance;             ///< [band]
  std::vector<LeafCoordinates> by_coordinate;  ///< [band]
};
void predict_leaf(const LeafPixelModel& model, const LeafCoordinates& at, LeafPrediction& result);

struct LeafFit {
  LeafCoordinates coordinates;
  LeafMatrix covariance;
};

/// The coordinates of the least squares of residuals and priors, by Levenberg and Marquardt's
/// steps. `prediction` is that there, afterwards.
[[nodiscard]] LeafFit fit_leaf(const LeafPixelModel& model, std::span<const double> measured,
                               LeafPrediction& prediction);

}  // namespace lamina::detail
