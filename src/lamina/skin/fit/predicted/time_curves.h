// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/skin/fit/measured/measurement.h"

namespace lamina::fit_detail {

/// Light over time at one place, by its logarithm at equal steps of the logarithm of time; none
/// before the first.
struct TimeCurve {
  double first_time = 1.0;  ///< [ps]
  double log_step = 0.1;
  std::vector<double> log_light;  ///< of 1/(mm² ps)

  [[nodiscard]] double at(double t) const;
  [[nodiscard]] double end() const;  ///< [ps]
};

/// Correction of diffusion by photons around one radius: the logarithm of light over that of
/// diffusion, as a polynomial in the time that light needs to get there at least over the time of
/// flight; and how well it is known, which is never worse than what is known of diffusion
/// beforehand.
struct PhotonCorrection {
  static constexpr std::size_t terms = 6;
  std::array<double, terms> power = {};                     ///< of 1, u ... u⁵
  std::array<std::array<double, terms>, terms> noise = {};  ///< L of its covariance L L^T

  [[nodiscard]] double log_factor(double u) const;
};

/// Light over time that a ring catches, of diffusion at some radii within it.
struct RingCurves {
  struct Part {
    double weight = 1.0;
    double least_time = 0.0;  ///< that light needs to get there [ps]
    TimeCurve curve;
  };
  std::vector<Part> parts;

  /// @param correction  or null
  [[nodiscard]] double at(double t, const PhotonCorrection* correction) const;
};

/// By diffusion, of rings of some width around radii, all to the same last time [r].
[[nodiscard]] std::vector<RingCurves> diffusion_curves(const LayerStack& stack,
                                                       std::span<const double> r, double width,
                                                       double last_time);

/// Traces photons, seed 1, and compares them with diffusion [r].
/// @param width    of the detectors [mm]; rings in which photons are counted are not narrower than
/// a
///                 tenth of their radius.
/// @param photons  how many.
/// @throws Interrupted if progress asks to stop.
[[nodiscard]] std::vector<PhotonCorrection> correct_by_photons(const LayerStack& stack,
                                                               std::span<const double> r,
                                                               double width, double last_time,
                                                               double photons,
                                                               const Progress& progress);

/// The part of arriving light that leaves in the rings that photons are counted in, by diffusion
/// [r]: how many of them there will be.
[[nodiscard]] std::vector<double> light_in_rings(const LayerStack& stack, std::span<const double> r,
                                                 double width, double last_time);

/// Later than this there is no light at a radius that counts, whatever the layers absorb and
/// scatter [ps].
[[nodiscard]] double longest_time(const LayerStack& stack, double r);

/// The time by which almost all light that gets to a radius has left [ps].
[[nodiscard]] double time_of_almost_all(const LayerStack& stack, double r);

}  // namespace lamina::fit_detail
