// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/tables/mapped_stack.h"
#include "lamina/solve/scattering/heterogeneous/tables/state_lattice.h"

namespace lamina {

/// Corrects operators of light along the normal for light that arrives at an angle. Oblique light
/// scatters nearer to the surface, so more of it leaves again: of skin at 60 degrees 5 to 10 % more
/// of what entered. The gain of a texel is that factor in even light; light times gain, spread by
/// operators of normal incidence, leaves in the right amount. Where light goes sideways is still
/// that of normal incidence.
class ObliqueLight {
 public:
  /// @param stack       layers with the indices of refraction
  /// @param texels      [layer] states of the layers at each texel; kept by reference
  /// @param absorbance  [layer - 1] typical natural absorbance per crossing of the sheet above a
  ///                    layer, >= 0
  /// @param theta       angle of incidence [rad], in [0, pi/2); at 0 all gains are 1
  /// @throws InvalidInput as LayerStack.
  ObliqueLight(const MappedStack& stack, std::span<const LayerTexels> texels,
               std::span<const double> absorbance, double theta);

  /// Reflected fraction of what enters at the angle over that of what enters along the normal, both
  /// by adding–doubling. Exact at the middle of all states and, for each number that varies by
  /// itself, at the ends of its range; between them a parabola of the logarithm. What numbers do
  /// together is taken as the product.
  [[nodiscard]] double gain(std::size_t texel) const;

  /// Derivative of the logarithm of a texel's gain by the absorption of a layer [mm].
  [[nodiscard]] double log_gain_by_sigma_a(std::size_t layer, std::size_t texel) const;

  /// The gain of transmitted light over that of reflected light, at the middle of all states.
  [[nodiscard]] double transmission_over_reflection() const { return transmission_; }

  /// Whether the gain is the same at all texels.
  [[nodiscard]] bool is_even() const { return parabolas_.empty(); }

 private:
  /// Logarithm of the gain, over that at the middle, along one coordinate of a layer's state.
  struct Parabola {
    std::size_t layer, coordinate;
    double low, middle, high;
    double slope, curvature;  ///< of (x - middle) and its square
    [[nodiscard]] double within(double x) const;
  };

  std::span<const LayerTexels> texels_;
  double log_middle_ = 0.0, transmission_ = 1.0;
  std::vector<Parabola> parabolas_;
};

}  // namespace lamina
