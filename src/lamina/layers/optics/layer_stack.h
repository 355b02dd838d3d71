// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/layers/optics/medium.h"
#include "lamina/layers/optics/phase_function.h"

namespace lamina {

enum class MicrofacetDistribution { beckmann, ggx };

template <>
inline constexpr auto enum_names<MicrofacetDistribution> =
    std::to_array<EnumName<MicrofacetDistribution>>({{"beckmann", MicrofacetDistribution::beckmann},
                                                     {"ggx", MicrofacetDistribution::ggx}});

/// The boundary between two media. The indices are those of the media that it parts.
struct Interface {
  double roughness = 0.0;  ///< microfacet alpha, in [0, 1]; 0 is smooth
  MicrofacetDistribution distribution = MicrofacetDistribution::beckmann;
  friend bool operator==(const Interface&, const Interface&) = default;
};

/// A plane slab at one wavelength.
struct Layer {
  Medium medium;
  double thickness = std::numeric_limits<double>::infinity();  ///< [mm], > 0
  Interface top;                                               ///< the layer's upper boundary
  std::optional<PhaseFunction> phase;  ///< absent: Henyey-Greenstein with medium.g
};

/// The layer's phase function; its mean cosine is medium.g.
[[nodiscard]] inline PhaseFunction phase_function(const Layer& layer) {
  return layer.phase.value_or(HenyeyGreenstein{layer.medium.g});
}

/// Scattering and absorption optical thickness together; infinite in a half-space that interacts.
[[nodiscard]] inline double optical_thickness(const Layer& layer) {
  const double extinction = sigma_t(layer.medium);
  return extinction > 0.0 ? extinction * layer.thickness : 0.0;
}

/// Ground under the last layer.
struct Ground {
  Interface top;             ///< the lower boundary of the last layer
  double reflectance = 0.0;  ///< of a Lambertian ground just under that boundary, in [0, 1]
};

/// Layers at one wavelength, from the lit surface downward. A LayerStack that exists is valid,
/// so no solver checks it again.
class LayerStack {
 public:
  /// @param layers     at least one; only the last may be infinitely thick.
  /// @param ior_above  refractive index of the half-space above, > 0.
  /// @param ior_below  the same below; equal to the last layer's if that is infinite.
  /// @throws InvalidInput naming the layer, the rule that it breaks and the value given.
  explicit LayerStack(std::vector<Layer> layers, double ior_above = 1.0, double ior_below = 1.0,
                      Ground ground = {});

  [[nodiscard]] std::span<const Layer> layers() const { return layers_; }
  [[nodiscard]] double ior_above() const { return ior_above_; }
  [[nodiscard]] double ior_below() const { return ior_below_; }
  [[nodiscard]] const Ground& ground() const { return ground_; }

 private:
  std::vector<Layer> layers_;
  double ior_above_, ior_below_;
  Ground ground_;
};

/// Whether the last layer is infinitely thick, so that nothing is transmitted.
[[nodiscard]] inline bool is_semi_infinite(const LayerStack& stack) {
  return stack.layers().back().thickness == std::numeric_limits<double>::infinity();
}

/// Whether every boundary is smooth.
[[nodiscard]] bool is_smooth(const LayerStack& stack);

/// Layers lit from below, top and bottom exchanged. The stack must be finite and have a
/// black ground.
[[nodiscard]] LayerStack flipped(const LayerStack& stack);

}  // namespace lamina
