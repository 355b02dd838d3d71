// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/base/core/enum_names.h"

namespace lamina {

/// The flux that a profile is a fraction of.
enum class ProfilePer {
  entered_flux,   ///< what has passed the surface: the convention of the diffusion papers
  arriving_flux,  ///< what arrives outside: radiative transfer and Monte Carlo
};

template <>
inline constexpr auto enum_names<ProfilePer> = std::to_array<EnumName<ProfilePer>>(
    {{"entered_flux", ProfilePer::entered_flux}, {"arriving_flux", ProfilePer::arriving_flux}});

/// Diffuse light around a normally incident pencil beam, all bands of a material on one radius
/// grid. Any solver makes one; plots, fits and renderers take it without asking which solver it
/// was.
struct Profile {
  ProfilePer per = ProfilePer::entered_flux;
  std::size_t bands = 0;
  std::vector<double> r;                      ///< [i] [mm], ascending, > 0
  std::vector<double> reflectance_profile;    ///< [i][band] [1/mm²]
  std::vector<double> transmittance_profile;  ///< [i][band] [1/mm²]; all 0 for a half-space
  std::vector<double> total_reflectance;      ///< [band], with the tail beyond the grid
  std::vector<double> total_transmittance;    ///< [band]

  [[nodiscard]] double reflectance_at(std::size_t i, std::size_t band) const {
    return reflectance_profile[i * bands + band];
  }
  [[nodiscard]] double transmittance_at(std::size_t i, std::size_t band) const {
    return transmittance_profile[i * bands + band];
  }
};

/// Diffuse reflectance per unit area at any distance r > 0 [mm] from the beam [1/mm²]: monotone
/// between the profile's radii, without a corner in log-log axes. Nearer than the first radius it
/// follows the first two as a power of r, no steeper than 1/r; beyond the last, no flatter than
/// r^-3, the law of a half-space without absorption.
///
/// Source: [FritschButland1984] for the slopes at the radii.
[[nodiscard]] double reflectance_profile(const Profile& profile, double r, std::size_t band);

/// Profile of the light that leaves at the bottom.
[[nodiscard]] double transmittance_profile(const Profile& profile, double r, std::size_t band);

/// How the flux of a profile adds up from the beam outward.
struct FluxCurve {
  std::vector<double> within;  ///< flux that leaves within profile.r[i] of the beam
  double beyond = 0.0;         ///< flux beyond the last radius, by the law given above
};

/// Flux by radius; within.back() + beyond is the total up to the errors of the profile.
[[nodiscard]] FluxCurve reflected_flux(const Profile& profile, std::size_t band);
[[nodiscard]] FluxCurve transmitted_flux(const Profile& profile, std::size_t band);

/// The profile per arriving flux.
///
/// @param profile             per either flux.
/// @param entry_transmittance  fraction of the arriving light that enters, in (0, 1], [band].
[[nodiscard]] Profile per_arriving_flux(Profile profile,
                                        std::span<const double> entry_transmittance);

/// The profile per entered flux.
[[nodiscard]] Profile per_entered_flux(Profile profile,
                                       std::span<const double> entry_transmittance);

}  // namespace lamina
