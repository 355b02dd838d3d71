// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/spatial_frequency/single_correction.h"

namespace lamina::detail {

/// Factor that corrects a flux that was found, where light is known to leave.
[[nodiscard]] inline double scale_to(double known, double found) {
  return known > 0.0 && found > 0.0 ? known / found : 1.0;
}

/// Responses on a grid of a few directions, which know less well how much light leaves than how it
/// spreads: times what makes them right without waves. Of a beam under a smooth top, what is
/// scattered once has more directions.
class ScaledSolver {
 public:
  /// @param flux  what leaves without waves, as `response` or `diffuse_responses` has it.
  ScaledSolver(const LayerStack& stack, int nodes, int modes, Illumination illumination,
               const FrequencyResponse& flux);

  /// [frequency]
  [[nodiscard]] std::vector<FrequencyResponse> at(std::span<const double> frequencies) const;

 private:
  FrequencySolver solver_;
  std::optional<SingleCorrection> single_;
  bool is_diffuse_;
  FrequencyResponse scale_{1.0, 1.0};
};

}  // namespace lamina::detail
