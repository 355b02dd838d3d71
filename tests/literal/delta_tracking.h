// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "lamina/base/core/random.h"
#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/phase_function.h"
#include "lamina/solve/scattering/heterogeneous/tables/state_lattice.h"

namespace lamina::reference {

/// A body of one refractive index under air, of which anything else varies along x and with depth,
/// with a period in x: what photons find who know no layers.
struct VariedBody {
  double ior = 1.5;
  double period = 1.0;                                         ///< [mm]
  double thickness = std::numeric_limits<double>::infinity();  ///< over air [mm]
  std::function<LayerState(double x, double z)> medium;        ///< [mm]
  /// Depths from which on extinction is at most so much [mm, 1/mm], ascending from 0
  std::vector<std::pair<double, double>> majorants;
  std::function<bool(double x)> is_lit = [](double) { return true; };
};

struct VariedExitance {
  std::vector<double> reflected, transmitted;  ///< [texel] per flux that enters where it is lit
  std::vector<double> standard_error;          ///< of what is reflected
};

/// Photons by delta tracking [Woodcock 1965]: normal light, Fresnel's boundary above and below.
inline VariedExitance trace_varied_body(const VariedBody& body, std::size_t texels,
                                        std::uint64_t photons, std::uint64_t seed) {
  VariedExitance result{std::vector(texels, 0.0), std::vector(texels, 0.0),
                        std::vector(texels, 0.0)};
  const auto texel = [&](double x) {
    const double u = x / body.period - std::floor(x / body.period);
    return std::min(static_cast<std::size_t>(u * static_cast<double>(texels)), texels - 1);
  };
  for (std::uint64_t i = 0; i < photons; ++i) {
    Random random = make_random(seed, i);
    double x = random.uniform() * body.period, z = 0.0, weight = 1.0;
    if (!body.is_lit(x)) continue;
    Vec3 w{0.0, 0.0, 1.0};
    while (weight > 0.0) {
      std::size_t region = 0;
      while (region + 1 < body.majorants.size() &&
             (w.z > 0.0 ? z >= body.majorants[region + 1].first
                        : z > body.majorants[region + 1].first))
        ++region;
      const double majorant = body.majorants[region].second;
      const double upper = body.majorants[region].first;
      const double lower =
          region + 1 < body.majorants.size() ? body.majorants[region + 1].first : body.thickness;
      const double step = -std::log(1.0 - random.uniform()) / majorant;
      const double to_border = w.z > 0.0   ? (lower - z) / w.z
                               : w.z < 0.0 ? (upper - z) / w.z
                                           : std::numeric_limits<double>::infinity();
      if (step < to_border) {
        x += w.x * step, z += w.z * step;
        const LayerState at = body.medium(x - std::floor(x / body.period) * body.period, z);
        const double extinction = at.sigma_a + at.sigma_s;
        if (random.uniform() * majorant >= extinction) continue;
        weight *= at.sigma_s / extinction;
        const double u = random.uniform(), v = random.uniform();
        const double cosine = sample_cos_theta(HenyeyGreenstein{at.g}, u, v);
        const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
        const double phi = 2.0 * std::numbers::pi * random.uniform();
        w = normalize(make_frame(w).to_world({sine * std::cos(phi), sine * std::sin(phi), cosine}));
        if (weight < 0.05) weight = random.uniform() < weight / 0.1 ? 0.1 : 0.0;
        continue;
      }
      x += w.x * to_border;
      const bool is_top = w.z < 0.0 && region == 0;
      const bool is_bottom = w.z > 0.0 && lower == body.thickness;
      z = w.z > 0.0 ? lower : upper;
      if (!is_top && !is_bottom) continue;
      if (random.uniform() < fresnel(std::min(std::abs(w.z), 1.0), 1.0 / body.ior)) {
        w.z = -w.z;
        continue;
      }
      auto& sum = is_top ? result.reflected : result.transmitted;
      sum[texel(x)] += weight;
      if (is_top) result.standard_error[texel(x)] += weight * weight;
      weight = 0.0;
    }
  }
  const double per_texel = static_cast<double>(texels) / static_cast<double>(photons);
  for (std::size_t t = 0; t < texels; ++t) {
    result.reflected[t] *= per_texel, result.transmitted[t] *= per_texel;
    result.standard_error[t] = std::sqrt(result.standard_error[t]) * per_texel;
  }
  return result;
}

}  // namespace lamina::reference
