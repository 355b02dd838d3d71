// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"
#include "lamina/skin/fit/slab/slab_measurement.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina::fit_detail {

/// Coefficients of a sample.
struct SampleCoefficients {
  double sigma_a = 0.0, sigma_s_prime = 0.0, g = 0.0;
};

/// The ranges of g that samples may have.
inline constexpr double least_g = -0.99, largest_g = 0.999;

/// The measured totals of a stack by what one of its layers, the sample, is made of: reflectance,
/// transmittance, and the logarithm of the unscattered transmittance, which is nearly linear in the
/// extinction. On grids of directions that are not refined.
class SampleModel {
 public:
  /// @param has_unscattered  whether the unscattered transmittance is among the numbers.
  SampleModel(const LayerStack& stack, std::size_t sample, const SlabMeasurement& measurement,
              const Incidence& incidence, bool has_unscattered);

  [[nodiscard]] FitData data() const;

  /// Not finite where g is that of no phase function.
  [[nodiscard]] std::vector<double> predict(const SampleCoefficients& is, int nodes) const;

  /// By sigma_a, sigma_s and g, [prediction][coefficient].
  [[nodiscard]] DenseMatrix derivatives(const SampleCoefficients& is, int nodes) const;

  [[nodiscard]] LayerStack stack_of(const SampleCoefficients& is) const;

 private:
  const LayerStack& stack_;
  std::size_t sample_;
  const SlabMeasurement& measurement_;
  Incidence incidence_;
  bool has_unscattered_;
};

}  // namespace lamina::fit_detail
