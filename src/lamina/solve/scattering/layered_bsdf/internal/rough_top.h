// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/layers/optics/rough/interface_reflectance.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"

namespace lamina::detail {

/// A stack under a rough top: light is reflected and refracted by facets, goes on below as under
/// any boundary, and leaves by facets again.
///
///     f = R f_s + (1 - R) f_v
///
/// Source: [HanrahanKrueger1993] §2, with the facets of RoughInterface in place of a smooth
/// surface. The direction of light that crosses is that of light which crosses one facet; the
/// amount is that of all light. Light that the top sends back inside keeps its angle: the amount is
/// right, its spread is not (nothing comes back to it in a half-space of one index).
struct RoughTop {
  RoughInterface<double> boundary;       ///< for light from above
  InterfaceReflectance one_facet;        ///< for light from above that meets one facet
  InterfaceReflectance outside, inside;  ///< of all light, for light from above and from within
  FirstOrderStack<double> below;         ///< what lies under the boundary, lit from within
  double ior_outside = 1.0, ior_inside = 1.0;
};

/// Whether the top of a stack is rough to any effect.
[[nodiscard]] bool has_rough_top(const LayerStack& stack);

/// @throws InvalidInput if a boundary below the top is rough.
[[nodiscard]] RoughTop make_rough_top(const LayerStack& stack);

/// Light of one direction above, by the facets through which it crosses; by reciprocity also the
/// way of light from within that leaves along the direction.
struct FacetBeams {
  Vec3 toward;  ///< away from the stack, above it
  std::vector<StackBeam<double>> beams;
  std::vector<double> weights;                ///< flux of each
  double reflected = 0.0, transmitted = 0.0;  ///< fractions of all light, whatever facets it meets
  double by_one_facet = 0.0;                  ///< of what is transmitted
};

/// Index of a direction in a pair. Together their facets are a lattice in four dimensions.
enum class OfPair { first, second };

/// @param toward  unit vector away from the stack, z > 0.
[[nodiscard]] FacetBeams cross_facets(const RoughTop& top, const Vec3& toward, OfPair which);

/// Turns the direction about the normal.
void turn(FacetBeams& light, double phi);

/// Light of a direction below the stack: toward.z < 0, for stacks that transmit.
[[nodiscard]] StackBeam<double> beam_from_below(const RoughTop& top, const Vec3& toward);

/// Radiance leaving per irradiance [1/sr] by the surface alone, whatever facets the light meets.
[[nodiscard]] double surface_brdf(const RoughTop& top, const FacetBeams& in, const FacetBeams& out);

/// BSDF of light that crosses the surface and is scattered once, or not at all. `in` is the
/// first of the pair.
[[nodiscard]] double volume_bsdf(const RoughTop& top, const FacetBeams& in, const FacetBeams& out);
[[nodiscard]] double volume_bsdf(const RoughTop& top, const FacetBeams& in,
                                 const StackBeam<double>& out);

/// Directions out, for integrals over both hemispheres.
struct Hemispheres {
  std::vector<double> weights;           ///< 2 pi cos(theta) dcos(theta)
  std::vector<FacetBeams> above;         ///< second of their pairs
  std::vector<StackBeam<double>> below;  ///< empty if nothing leaves there
};
[[nodiscard]] Hemispheres make_hemispheres(const RoughTop& top);

/// Flux of that light on each side of the stack, per arriving flux.
struct VolumeFlux {
  double back = 0.0, through = 0.0;
};
[[nodiscard]] VolumeFlux volume_flux(const RoughTop& top, const FacetBeams& in,
                                     const Hemispheres& directions);

}  // namespace lamina::detail
