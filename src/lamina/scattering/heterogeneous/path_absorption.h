// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

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
class PathAbsorption {
 public:
  /// @param texels  whose absorption varies, and nothing else
  explicit PathAbsorption(const LayerTexels& texels);

  /// Two texels side by side.
  void add_neighbors(std::size_t one, std::size_t other);

  /// Standard deviation of the Gaussian [mm]; 0 where all neighbors are alike.
  [[nodiscard]] double width() const;

 private:
  const std::vector<float>& sigma_a_;
  double reduced_scattering_;
  double decays_ = 0.0, differences_ = 0.0;
};

/// Whether only absorption varies. Layers of which scattering or thickness vary, too, take profiles
/// of the exit: these return all light of surroundings that do not absorb.
[[nodiscard]] bool follows_absorption(const LayerTexels& texels);

}  // namespace lamina
