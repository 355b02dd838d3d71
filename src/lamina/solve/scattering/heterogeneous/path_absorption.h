// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/solve/scattering/heterogeneous/tables/state_lattice.h"

namespace lamina {

/// Place whose absorption a profile is of.
enum class ProfileAt {
  exit,  ///< the point where light comes out [Donner2008] eq. 5
  both   ///< the mean of where it enters and comes out, of absorption as its path meets it
};

template <>
inline constexpr auto enum_names<ProfileAt> =
    std::to_array<EnumName<ProfileAt>>({{"exit", ProfileAt::exit}, {"both", ProfileAt::both}});

/// How far around a point light meets the absorption of a layer, where nothing else varies. Light
/// is not absorbed at the ends of its path but along it: profiles that follow the absorption of a
/// point do so with its mean around it, by the Gaussians of path_variances. These are as wide as
/// parts of the decay length of diffuse light, 1 / sigma_tr, as it is between places that differ:
///
///     length = 1 / (sum over neighbors of |difference of sigma_a| sigma_tr / sum of |difference|)
template <class T>
class PathAbsorption {
 public:
  /// @param sigma_a             [texel] [1/mm]; must outlive this
  /// @param reduced_scattering  of the layer [1/mm]
  PathAbsorption(std::span<const T> sigma_a, double reduced_scattering)
      : sigma_a_(sigma_a), reduced_scattering_(reduced_scattering) {}

  /// Two texels side by side.
  void add_neighbors(std::size_t one, std::size_t other);

  /// [mm]; 0 where all neighbors are alike.
  [[nodiscard]] double decay_length() const;

  /// Adds to derivatives by the absorption of two neighbors what the length brings to them.
  /// @param by_log_length  the derivative by its logarithm
  void add_derivatives(std::size_t one, std::size_t other, double by_log_length,
                       std::span<T> by_sigma_a) const;

 private:
  std::span<const T> sigma_a_;
  double reduced_scattering_;
  double decays_ = 0.0, differences_ = 0.0;
};

/// Variances of the Gaussians around a point [mm²]: of seven tenths .5 of the decay length wide,
/// for light that is diffuse; of the rest .05, for light that scatters a few times and comes out
/// close by. So waves of melanin show as they do to photons, of .2 to 20 /mm at 470 to 645 nm, to
/// .017 of the mean (tools/tables/heterogeneous_truths); source: lamina's own.
[[nodiscard]] std::array<double, 2> path_variances(double decay_length);

/// Weights of scales of these Gaussians, [Gaussian][scale], to those of their sum by shares.
[[nodiscard]] std::vector<double> sum_by_shares(const std::array<std::vector<double>, 2>& scales);

/// Whether only absorption varies. Layers of which scattering or thickness vary, too, take profiles
/// of the exit: these return all light of surroundings that do not absorb.
[[nodiscard]] bool follows_absorption(const LayerTexels& texels);

/// sigma_s (1 - g) of a layer of which neither varies [1/mm].
[[nodiscard]] double reduced_scattering(const LayerTexels& texels);

/// The texels of such a layer with absorption as light on its way meets it.
///
/// @param for_neighbors  calls what it is given with each two cells side by side
/// @param blur           (decay length [mm]) -> the absorption, blurred by path_variances
template <class ForNeighbors, class Blur>
[[nodiscard]] LayerTexels along_paths(const LayerTexels& texels, const ForNeighbors& for_neighbors,
                                      const Blur& blur) {
  PathAbsorption<float> absorption(texels.sigma_a, reduced_scattering(texels));
  for_neighbors([&](std::size_t one, std::size_t other) { absorption.add_neighbors(one, other); });
  const double length = absorption.decay_length();
  if (length == 0.0) return texels;
  LayerTexels result = texels;
  result.sigma_a = blur(length);
  // A Gaussian of several scales may undershoot beside a sharp edge.
  const auto [least, most] = std::ranges::minmax(texels.sigma_a);
  for (float& value : result.sigma_a) value = std::clamp(value, least, most);
  return result;
}

}  // namespace lamina
