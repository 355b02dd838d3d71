// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/core/enum_names.h"
#include "lamina/scattering/heterogeneous/tables/state_lattice.h"

namespace lamina {

/// Whose absorption a profile is that of.
enum class ProfileAt {
  exit,  ///< the point where light comes out [Donner2008] eq. 5
  both   ///< the mean of where it enters and comes out, of absorption as its path meets it
};

template <>
inline constexpr auto enum_names<ProfileAt> =
    std::to_array<EnumName<ProfileAt>>({{"exit", ProfileAt::exit}, {"both", ProfileAt::both}});

/// How far around a point light meets the absorption of a layer, where nothing else varies. Light
/// is not absorbed at the ends of its path but along it: profiles that follow the absorption of a
/// point do so with that of a Gaussian around it. Its width is a part of the decay length of
/// diffuse light, 1 / sigma_tr, as it is between places that differ:
///
///     width = .38 / (sum over neighbors of |difference of sigma_a| sigma_tr / sum of |difference|)
///
/// The part is such that stripes and edges agree with photons, of melanin .003 to .08, at 470 to
/// 645 nm (tools/tables/heterogeneous_validation); source: lamina's own.
template <class T>
class PathAbsorption {
 public:
  /// @param sigma_a             [texel] [1/mm]; must outlive this
  /// @param reduced_scattering  of the layer [1/mm]
  PathAbsorption(std::span<const T> sigma_a, double reduced_scattering)
      : sigma_a_(sigma_a), reduced_scattering_(reduced_scattering) {}

  /// Two texels side by side.
  void add_neighbors(std::size_t one, std::size_t other);

  /// Standard deviation of the Gaussian [mm]; 0 where all neighbors are alike.
  [[nodiscard]] double width() const;

  /// Adds to derivatives by the absorption of two neighbors what the width brings to them.
  /// @param by_log_width  the derivative by the logarithm of the width
  void add_derivatives(std::size_t one, std::size_t other, double by_log_width,
                       std::span<T> by_sigma_a) const;

 private:
  std::span<const T> sigma_a_;
  double reduced_scattering_;
  double decays_ = 0.0, differences_ = 0.0;
};

/// Whether only absorption varies. Layers of which scattering or thickness vary, too, take profiles
/// of the exit: these return all light of surroundings that do not absorb.
[[nodiscard]] bool follows_absorption(const LayerTexels& texels);

/// sigma_s (1 - g) of a layer of which neither varies [1/mm].
[[nodiscard]] double reduced_scattering(const LayerTexels& texels);

/// The texels of such a layer with absorption as light on its way meets it.
///
/// @param for_neighbors  calls what it is given with each two cells side by side
/// @param blur           (standard deviation [mm]) -> the absorption, blurred by such a Gaussian
template <class ForNeighbors, class Blur>
[[nodiscard]] LayerTexels along_paths(const LayerTexels& texels, const ForNeighbors& for_neighbors,
                                      const Blur& blur) {
  PathAbsorption<float> absorption(texels.sigma_a, reduced_scattering(texels));
  for_neighbors([&](std::size_t one, std::size_t other) { absorption.add_neighbors(one, other); });
  const double width = absorption.width();
  if (width == 0.0) return texels;
  LayerTexels result = texels;
  result.sigma_a = blur(width);
  // A Gaussian of several scales may undershoot beside a sharp edge.
  const auto [least, most] = std::ranges::minmax(texels.sigma_a);
  for (float& value : result.sigma_a) value = std::clamp(value, least, most);
  return result;
}

}  // namespace lamina
