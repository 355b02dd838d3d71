// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/estimate.h"
#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/rough/gaussian_surface.h"

namespace lamina {

/// Cells of exit directions on each side: even in the angle theta from the normal of the side, [0,
/// 90] degrees, and in the azimuth from the plane of incidence, [0, 180] degrees for both of its
/// halves. Azimuth 0 is forward: mirrored and refracted light leaves near it, and 180 is that of
/// wi.
struct ExitCells {
  int thetas = 45;
  int phis = 18;
};

/// Where light from one direction goes at a rough surface. All vectors are [theta * phis + phi].
struct RoughSurfaceScattering {
  ExitCells cells;
  std::vector<double> brdf, btdf;                ///< mean over the cell, light of all orders [1/sr]
  std::vector<double> brdf_error, btdf_error;    ///< standard errors, 0 for the analytic method
  std::vector<double> single_brdf, single_btdf;  ///< of light that met one facet
  Estimate reflectance, transmittance;           ///< fractions of the arriving flux, all orders
  Estimate single_reflectance, single_transmittance;
  Estimate start_weight;  ///< mean weight that light starts with; 1 if the method keeps its energy
  double given_up = 0.0;  ///< fraction of light not followed to its end
};

/// The model of [XuSun2008] Eq. 25 and its reflection counterpart: order 1 alone.
///
/// @param surface  smoothness in [0.01, 10000], eta > 0 and not 1: here and below.
/// @param theta_i  angle of incidence, in [0, pi/2) [rad].
/// @throws InvalidInput if an argument is out of its range; so do the other methods.
[[nodiscard]] RoughSurfaceScattering analytic_scattering(const GaussianSurface& surface,
                                                         double theta_i, ExitCells cells = {});

/// How likely a facet is seen from a direction; both fall from 1 to 0 with its angle.
enum class FacetVisibility {
  xu_sun,  ///< [XuSun2008] Eq. 24 at all heights: Lambda = tan/s exp(-s^2 / (4 tan^2)); loses
           ///< energy
  smith    ///< [Smith1967]: the Lambda that fits the slopes; conserves energy
};

template <>
inline constexpr auto enum_names<FacetVisibility> = std::to_array<EnumName<FacetVisibility>>(
    {{"xu_sun", FacetVisibility::xu_sun}, {"smith", FacetVisibility::smith}});

struct WalkOptions {
  std::int64_t rays = 1'000'000;
  std::uint64_t seed = 0;
  FacetVisibility visibility = FacetVisibility::xu_sun;
  ExitCells cells;
  Progress progress;
};

/// The Monte Carlo simulation of [XuSun2008] §4: a height and a slope by their densities, the
/// weight V(height) cos(alpha) / cos(theta_n), then reflections and refractions until the light
/// leaves.
///
/// One branch is followed, chosen by Fresnel's law, in place of both. The paper does not say where
/// a blocked ray meets the surface next; here the height follows from the same visibility, and the
/// facet is one that faces the ray.
[[nodiscard]] RoughSurfaceScattering simulate_scattering(const GaussianSurface& surface,
                                                         double theta_i,
                                                         const WalkOptions& options);

struct HeightFieldOptions {
  std::int64_t rays = 1'000'000;  ///< over all realizations
  int realizations = 8;           ///< >= 2; their scatter gives the standard errors
  std::uint64_t seed = 0;
  ExitCells cells;
  Progress progress;
};

inline constexpr double widest_in_height_fields = 89.0 * std::numbers::pi / 180.0 + 1e-12;

/// The truth: rays traced through generated height fields of the surface's statistics. theta_i is
/// 89 degrees at most.
[[nodiscard]] RoughSurfaceScattering trace_height_fields(const GaussianSurface& surface,
                                                         double theta_i,
                                                         const HeightFieldOptions& options);

/// How far two results differ in their transmitted light of all orders: half the sum over cells of
/// 6 x 30 degrees of |flux of one - flux of the other|, as a fraction of the arriving flux. Light
/// that goes elsewhere counts fully, light that is missing by half.
///
/// Both must have the same cells, of numbers that 15 and 6 divide.
[[nodiscard]] double misplaced_transmission(const RoughSurfaceScattering& one,
                                            const RoughSurfaceScattering& other);

}  // namespace lamina
