// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/scattering/profile/profile.h"

namespace lamina {

/// Which of a profile's two tables to follow.
enum class ProfileSide { reflectance, transmittance, both };

/// Distances from the beam drawn by a profile, one set for all bands. The density follows, at each
/// radius, the band that has the largest part of its flux there: a weight profile(r) 2 pi r /
/// pdf_radius(r) is then at most `weight_bound` times the band's total, in every band, and images
/// have no grain of colour.
struct RadialSampler {
  std::vector<double> r;            ///< where pieces of the density meet [mm]
  std::vector<double> height;       ///< flux density at the start of each piece [1/mm²]
  std::vector<double> power;        ///< of r in each piece: before, between, beyond the radii
  std::vector<double> flux_within;  ///< [i] fraction drawn nearer than r[i]
  double weight_bound = 1.0;        ///< from 1 for alike bands to the number of bands
};

/// @param profile  at least two radii, and some flux on the chosen side in one band.
/// @throws InvalidInput if no band has flux there.
[[nodiscard]] RadialSampler make_radial_sampler(const Profile& profile, ProfileSide side);

/// A distance from the beam [mm], > 0 and unbounded.
///
/// @param u  uniform in [0, 1).
[[nodiscard]] double sample_radius(const RadialSampler& sampler, double u);

/// Density of sample_radius over r [1/mm]; over the plane it is pdf / (2 pi r).
[[nodiscard]] double pdf_radius(const RadialSampler& sampler, double r);

/// Fraction of the samples nearer than r [mm]: the inverse of sample_radius.
[[nodiscard]] double fraction_within(const RadialSampler& sampler, double r);

}  // namespace lamina
