// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/solve/scattering/spatial_frequency/frequency_derivatives.h"
#include "lamina/solve/scattering/spatial_frequency/single_correction.h"

namespace lamina::detail {

/// Derivatives of what ScaledSolver finds: of doubling and of the factor exactly, of the little
/// that light scattered once adds, which is in closed form, by differences.
class ScaledDerivatives {
 public:
  /// @param stack  with smooth boundaries.
  /// @param flux   what leaves without waves, with its derivatives.
  ScaledDerivatives(const LayerStack& stack, int nodes, int modes, Illumination illumination,
                    FrequencyDerivatives flux);

  [[nodiscard]] FrequencyDerivatives at(double k) const;

 private:
  /// Corrections of the stack changed a little: the sum of them times their weights is a
  /// derivative.
  struct Difference {
    struct Term {
      double weight;
      SingleCorrection correction;
    };
    std::size_t layer;
    double LayerDerivatives::*by;
    std::vector<Term> terms;
  };

  [[nodiscard]] FrequencyDerivatives unscaled(double k) const;

  DifferentiatedSolver solver_;
  Illumination illumination_;
  std::vector<SingleCorrection> single_;  ///< one, or none
  std::vector<Difference> differences_;
  FrequencyDerivatives flux_, without_waves_;
};

}  // namespace lamina::detail
