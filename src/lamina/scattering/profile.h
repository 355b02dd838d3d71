// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace lamina {

/// The flux that a profile is a fraction of.
enum class ProfilePer {
  entered_flux,   ///< what has passed the surface: the convention of the diffusion papers
  arriving_flux,  ///< what arrives outside: exact and Monte Carlo profiles
};

/// Diffuse light around a normally incident pencil beam, all bands of a material on one radius grid.
/// Any solver makes one; plots, fits and renderers take it without asking which solver it was.
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

}  // namespace lamina
