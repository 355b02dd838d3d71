// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "lamina/core/vec.h"
#include "lamina/materials/material.h"
#include "lamina/render/subsurface/hierarchy/internal/irradiance_tree.h"
#include "lamina/spectrum/band_values.h"

namespace lamina {

/// A medium as diffusion sees it, all bands side by side.
template <int N>
struct DiffusionMedium {
  BandValues<N> sigma_tr;         ///< [1/mm]
  BandValues<N> diffusion;        ///< D = mfp' / 3 [mm]
  BandValues<N> mfp;              ///< reduced: the depth at which light starts to diffuse [mm]
  BandValues<N> height_of_image;  ///< of the mirror image of the surface, over the depth of its
                                  ///< source: 4 A D [mm]
};

/// That of the last layer: what fills the object.
template <int N>
[[nodiscard]] DiffusionMedium<N> make_diffusion_medium(const Material& material);

/// Opaque objects inside a translucent one: what fraction of the light they leave.
///
/// With them the fluence at a point is, by Green's second identity, that without them and an
/// integral over their surface of sources and dipoles whose strength is the fluence there; what the
/// surface absorbs ties both. The integral equation is solved once, for patches of the surface.
/// Since objects reflect nothing through themselves, light from behind is stopped; it bends around
/// them as far as it diffuses.
///
/// Light starts one mean free path below where it enters; where it enters and where it leaves the
/// surface counts as flat, elsewhere as not there. What light comes there is only compared with
/// and without the objects, by the same approximations, so that much of their error cancels.
///
/// Source: [Hery2003] §5.2 for samples on objects inside whose light is taken from the rest;
/// there their strength is left open.
template <int N>
class InnerBlockers {
 public:
  using Bands = BandValues<N>;

  /// A patch of an opaque surface.
  struct Patch {
    Vec3f position;     ///< [mm]
    Vec3f normal;       ///< into the translucent medium, unit length
    float area = 0.0f;  ///< [mm²]
    Bands reflectance;  ///< in [0, 1]
  };
  static constexpr std::size_t most_patches = 800;  ///< that one solution is made for

  InnerBlockers() = default;
  /// @param patches  at most most_patches
  /// @param light    that enters the translucent object
  /// @param error    solid angle up to which samples of light are summed as one [sr]
  InnerBlockers(std::span<const Patch> patches, const DiffusionMedium<N>& medium,
                const IrradianceTree<N>& light, float error);

  /// Light that leaves at a point of the surface over what would without the objects, >= 0: more
  /// than 1 above a bright one.
  ///
  /// @param normal  outward, unit length
  [[nodiscard]] Bands unblocked_fraction(const Vec3f& position, const Vec3f& normal,
                                         const IrradianceTree<N>& light) const;

  [[nodiscard]] bool empty() const { return sources_.empty(); }

  /// Whether an object may lie within the radius [mm] of light that leaves at a position [mm].
  [[nodiscard]] bool may_reach(const Vec3f& position, float radius) const {
    float distance2 = 0.0f;
    for (int k = 0; k < 3; ++k) {
      const float apart = std::max({box_low_[k] - position[k], position[k] - box_high_[k], 0.0f});
      distance2 += apart * apart;
    }
    return !empty() && distance2 <= radius * radius;
  }

 private:
  /// Two sources of fluence, apart along the normal of a patch: together its source and dipole.
  struct Source {
    Vec3f inner, outer;  ///< [mm]
    Bands power_inner, power_outer;
    float least2 = 0.0f;  ///< squared distance below which a patch is not a point [mm²]
  };
  [[nodiscard]] Bands fluence(const Vec3f& position, const IrradianceTree<N>& light) const;
  [[nodiscard]] Bands leaving(const Vec3f& to_source, const Vec3f& normal, const Bands& depth,
                              float least2) const;
  [[nodiscard]] std::vector<Bands> solve(std::span<const Patch> patches,
                                         const IrradianceTree<N>& light) const;

  DiffusionMedium<N> medium_;
  float error_ = 0.0f, support_radius_ = 0.0f;
  std::vector<Source> sources_;
  Vec3f box_low_, box_high_;  ///< around all patches [mm]
};

}  // namespace lamina
