// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/base/spectrum/band_values.h"
#include "lamina/layers/materials/material.h"
#include "lamina/render/subsurface/hierarchy/internal/irradiance_tree.h"

namespace lamina {

/// A medium as diffusion sees it, all bands side by side.
template <int N>
struct DiffusionMedium {
  BandValues<N> sigma_tr;         ///< [1/mm]
  BandValues<N> diffusion;        ///< D = mfp' / 3 [mm]
  BandValues<N> mfp;              ///< reduced: the depth at which light starts to diffuse [mm]
  BandValues<N> height_of_image;  ///< of the mirror image of the surface, over the depth of its
                                  ///< source: 4 A D [mm]
  BandValues<N> mirrored;         ///< fraction of diffuse light that the surface reflects inside
};

/// Diffusion medium of the last layer, which fills the object.
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
/// Light starts one mean free path below where it enters. The surface of the translucent object is
/// in the equation, too, if patches about as wide as a mean free path cover it: as one that absorbs
/// what it lets out. Then the fluence there with the objects over that without is the fraction
/// left. Else, in large objects, the surface counts as flat where light enters and leaves,
/// elsewhere as not there, so that light that would be lost through it is taken for light that is
/// stopped. What light comes there is only compared with and without the objects, by the same
/// approximations, so that much of their error cancels.
///
/// Source: [Hery2003] §5.2 for samples on objects inside whose light is taken from the rest;
/// there their strength is left open. [FuchsSutugin1971] for what a small ball absorbs.
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
    float radius = std::numeric_limits<float>::infinity();  ///< of a ball as large as the object
  };
  static constexpr std::size_t most_patches = 800;  ///< that one solution is made for

  InnerBlockers() = default;
  /// @param patches  of objects inside
  /// @param outer    of the translucent object itself, normals outward, or none; together with
  ///                 those at most most_patches
  /// @param light    that enters the translucent object
  /// @param error    solid angle up to which samples of light are summed as one [sr]
  InnerBlockers(std::span<const Patch> patches, std::span<const Patch> outer,
                const DiffusionMedium<N>& medium, const IrradianceTree<N>& light, float error);

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
  /// @param has_images  of the sources, above the surface
  [[nodiscard]] Bands fluence(const Vec3f& position, const IrradianceTree<N>& light,
                              bool has_images) const;
  [[nodiscard]] Bands leaving(const Vec3f& to_source, const Vec3f& normal, const Bands& depth,
                              float least2) const;
  /// A patch in the integral equation.
  struct Wall {
    Vec3f position, normal;
    float area;
    Bands loss;               ///< share of the fluence that it absorbs per area
    float own_dipole = 0.0f;  ///< what it sends to itself, being curved
  };
  [[nodiscard]] std::vector<Bands> solve(std::span<const Wall> patches,
                                         std::vector<Bands> fluences) const;
  static void find_own_dipoles(std::span<Wall> surface, float sum);
  void solve_with_surface(std::span<const Wall> inner, std::span<const Patch> outer,
                          const IrradianceTree<N>& light);

  DiffusionMedium<N> medium_;
  float error_ = 0.0f, support_radius_ = 0.0f;
  std::vector<Source> sources_;
  /// A place of the surface of the translucent object, and the fraction of light left there.
  struct Left {
    Vec3f position, normal;
    Bands fraction;
  };
  std::vector<Left> left_;
  float left_spacing_ = 0.0f;  ///< [mm]
  Vec3f box_low_, box_high_;   ///< around all patches [mm]
};

}  // namespace lamina
