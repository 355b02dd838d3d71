// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/skin/fit/measured/measurement.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/layer_derivatives.h"

namespace lamina::fit_detail {

/// Prediction of the points of one band of a series.
struct SeriesPrediction {
  std::vector<double> values;                              ///< [point]
  std::vector<std::vector<LayerDerivatives>> derivatives;  ///< [point][layer], if asked for
};

/// Whether `predict_quickly` can differentiate.
[[nodiscard]] bool has_derivatives(const LayerStack& stack, const MeasuredSeries& series);

/// Whether accurate predictions differ from quick ones by more than a factor that hardly changes:
/// of radial profiles, and where light is lost beside ports.
[[nodiscard]] bool corrects_derivatives(const MeasuredSeries& series);

/// On grids that are not refined: smooth functions of what the layers are made of, a percent or so
/// from the truth. A radial profile is that of diffusion, and right but for a factor; so are totals
/// in spheres, as if no light were lost.
[[nodiscard]] SeriesPrediction predict_quickly(const LayerStack& stack,
                                               const MeasuredSeries& series,
                                               std::span<const MeasuredPoint> points,
                                               bool with_derivatives);

/// By radiative transfer, refined until a tenth of the smallest error of the points is reached, or
/// what can be had. [point]
[[nodiscard]] std::vector<double> predict_accurately(const LayerStack& stack,
                                                     const MeasuredSeries& series,
                                                     std::span<const MeasuredPoint> points);

}  // namespace lamina::fit_detail
