// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/internal/burley_profile.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace lamina::detail {
namespace {

void put(Profile& profile, std::size_t channel, double d) {
  const double total = profile.total_reflectance[channel];
  for (std::size_t i = 0; i < profile.r.size(); ++i) {
    const double r = profile.r[i], wide = std::exp(-r / (3.0 * d));
    profile.reflectance_profile[i * profile.bands + channel] =
        total * (wide * wide * wide + wide) / (8.0 * std::numbers::pi * d * r);
  }
}

}  // namespace

BurleyProfiles fit_burley(const ChannelLight& light) {
  BurleyProfiles result{.d = {}, .profile = light.profile};
  Profile& profile = result.profile;
  for (std::size_t c = 0; c < light.channels.size(); ++c) {
    // d is sqrt(<r^2> / 14) where the shape is right; the nearest is sought around that.
    double best = 0.5 * std::log(mean_square_radius(light.profile, c, true) / 14.0);
    double least = std::numeric_limits<double>::infinity();
    for (double step = 0.5; step > 0.004; step *= 0.5) {
      const double middle = best;
      for (int i = -4; i <= 4; ++i) {
        const double trial = middle + i * step;
        put(profile, c, std::exp(trial));
        const double value = profile_difference(light.profile, profile, c, true);
        if (value < least) {
          least = value;
          best = trial;
        }
      }
    }
    result.d.push_back(std::exp(best));
    put(profile, c, result.d.back());
  }
  return result;
}

double burley_mean_free_path_scale(double color) {
  const double from = std::abs(color - 0.8);
  return 1.85 - color + 7.0 * from * from * from;
}

}  // namespace lamina::detail
