// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/skin/fit/measured/measurement.h"
#include "lamina/skin/fit/predicted/time_curves.h"

namespace lamina::fit_detail {

/// The points of a series over time or frequency in one band, as a function of the layers:
/// diffusion, corrected by photons. Points count by their logarithms where the model says so. A
/// factor that is not known is the one that makes the prediction nearest to what was measured.
class TimedPrediction {
 public:
  /// @param is_logarithmic  [point]
  TimedPrediction(const MeasuredSeries& series, std::vector<MeasuredPoint> points,
                  std::vector<bool> is_logarithmic);

  /// [point] The logarithm where it is asked for.
  [[nodiscard]] std::vector<double> predict(const LayerStack& stack) const;

  /// From now on with what photons say at these layers. That is kept while layers change by less
  /// than half a percent, and after three times.
  void correct(const LayerStack& stack, const Progress& progress);

  /// How the noise of photons goes through all points: [point][independent part], of a standard
  /// deviation of 1 each. No columns before `correct`.
  [[nodiscard]] DenseMatrix noise(const LayerStack& stack) const;

  [[nodiscard]] std::size_t unknown_factors() const;
  [[nodiscard]] double photons() const { return photons_; }

 private:
  [[nodiscard]] std::vector<double> rows_of(const std::vector<RingCurves>& curves,
                                            std::span<const PhotonCorrection> corrections) const;
  [[nodiscard]] double last_time(const LayerStack& stack) const;
  void scale(std::vector<double>& rows, std::span<const std::size_t> of_curve) const;

  const MeasuredSeries& series_;
  std::vector<MeasuredPoint> points_;
  std::vector<bool> is_logarithmic_;
  std::vector<double> radii_;                        ///< ascending
  std::vector<std::vector<std::size_t>> at_radius_;  ///< [radius] points
  std::optional<LayerStack> traced_;
  std::vector<PhotonCorrection> corrections_;  ///< [radius]
  double photons_ = 0.0;                       ///< traced last
  int traces_ = 0;
};

}  // namespace lamina::fit_detail
