// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/skin/acquire/inversion/objective/inversion_options.h"
#include "lamina/skin/acquire/inversion/objective/map_smoothness.h"
#include "lamina/skin/acquire/inversion/objective/patch_light.h"
#include "lamina/skin/fit/least_squares/band_misfit.h"

namespace lamina::detail {

/// Coordinates of skin, the images that they make, and how well these meet the photographs.
struct PatchState {
  TexelMaps coordinates, images;
  double objective = 0.0;
  double residual = 0.0, in_deviations = 0.0;  ///< as in InversionStep
};

/// Objective of an inversion (patch_inversion.h), its gradient and the matrix of its
/// Gauss-Newton steps.
class PatchObjective {
 public:
  /// All must outlive this.
  PatchObjective(const PatchCapture& capture, const InversionTables& tables,
                 const InversionOptions& options, PatchLight& light);

  /// How smooth maps are, [number].
  void set_smoothness(std::vector<MapSmoothness> smoothness);
  [[nodiscard]] const std::vector<MapSmoothness>& smoothness() const { return smoothness_; }
  [[nodiscard]] GridSize size() const { return {capture_.width, capture_.height}; }

  [[nodiscard]] PatchState state(TexelMaps coordinates) const;
  /// State with images that are known.
  [[nodiscard]] PatchState state(TexelMaps coordinates, TexelMaps images) const;
  /// The state's objective, with other smoothness than it was made with.
  void weigh_again(PatchState& state) const { state.objective = objective(state); }

  /// Gradient of the state that was made last.
  [[nodiscard]] TexelMaps gradient(const PatchState& state) const;
  /// Takes a state, which is made last, as the one whose matrix is asked for.
  void linearize(const PatchState& state);
  /// The matrix of second derivatives, of first ones of the light alone, times a change.
  [[nodiscard]] TexelMaps times_matrix(const TexelMaps& change) const;

  /// Measured images, [image]; 0 where not known.
  [[nodiscard]] const TexelMaps& measured() const { return measured_; }
  /// Inverse covariance of the prior as each texel has it: smoothness ties texels to one skin, of
  /// which the prior then is as a whole.
  [[nodiscard]] const DenseMatrix& prior_precision() const { return prior_precision_; }
  /// Factors of the errors that were stated, [image]; 1 at first.
  void set_error_growth(const std::vector<double>& growth);
  [[nodiscard]] const std::vector<double>& error_growth() const { return growth_; }
  /// Misfit of a state to each image. @param leverage  of all its texels together, [image]
  [[nodiscard]] std::vector<BandMisfit> misfit(const PatchState& state,
                                               const std::vector<double>& leverage) const;

  /// 1 / deviation of texels that are known, else 0, [image].
  [[nodiscard]] const TexelMaps& weights() const { return weights_; }
  /// Part of its square that a residual counts by (Huber), [image]; of the last linearize.
  [[nodiscard]] const TexelMaps& shares() const { return shares_; }
  /// How many numbers of images are known and lit.
  [[nodiscard]] double known() const { return known_; }
  [[nodiscard]] const PatchCapture& capture() const { return capture_; }
  [[nodiscard]] const InversionTables& tables() const { return tables_; }
  [[nodiscard]] PatchLight& light() const { return light_; }

 private:
  [[nodiscard]] double objective(const PatchState& state) const;
  /// Part of its square that a residual in standard deviations counts by. Source: [Huber1964].
  [[nodiscard]] double share_of(double miss) const;
  /// Adds what smoothness and prior make of a change.
  void add_prior_matrix(const TexelMaps& change, TexelMaps& sum) const;
  [[nodiscard]] TexelMaps off_prior(const TexelMaps& coordinates) const;

  const PatchCapture& capture_;
  const InversionTables& tables_;
  PatchLight& light_;
  double robust_limit_;
  std::vector<MapSmoothness> smoothness_;
  DenseMatrix prior_precision_;
  TexelMaps measured_, weights_, shares_;  ///< 0 where not known
  std::vector<double> means_;              ///< of what was measured, [image]
  std::vector<double> growth_;             ///< [image]
  double known_ = 0.0;
};

}  // namespace lamina::detail
