// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"

namespace lamina::detail {

/// Correction of the response to a beam under a smooth top on a grid of a few directions, of the
/// light that is scattered once: that of many directions less that of the grid.
class SingleCorrection {
 public:
  /// @param nodes, modes  of the grid.
  SingleCorrection(const LayerStack& stack, int nodes, int modes);

  [[nodiscard]] FrequencyResponse at(double k) const;

 private:
  FrequencySolver many_, few_;  ///< of mode 0, which light that is scattered once comes from
};

}  // namespace lamina::detail
