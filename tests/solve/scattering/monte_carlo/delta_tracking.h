// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/medium.h"

namespace lamina {

/// Tissue at a place: its number and its coefficients.
struct Tissue {
  std::size_t number;
  Medium medium;
};

/// Photons in a box of one index that know no surfaces: free paths are those of the largest
/// extinction, and a collision is one of the place at hand with the ratio of extinctions
/// (Woodcock's delta tracking). Photons are absorbed whole.
///
/// @param majorant   no place has a larger extinction [1/mm]
/// @param tissue_at  (place) -> Tissue
/// @param start      (random) -> place
/// @return           [tissue] absorbed fraction; the last one: what left the box
template <class TissueAt, class Start>
std::vector<double> absorbed_by_tissues(const Vec3& box, std::size_t tissues, double majorant,
                                        const TissueAt& tissue_at, const Start& start,
                                        std::uint64_t photons, std::uint64_t seed) {
  constexpr std::size_t parts = 16;
  std::vector<std::vector<double>> counts(parts, std::vector<double>(tissues + 1, 0.0));
  parallel_for(parts, [&](std::size_t part) {
    for (std::uint64_t i = part; i < photons; i += parts) {
      Random random = make_random(seed, i);
      Vec3 at = start(random), w = {0.0, 0.0, 1.0};
      for (;;) {
        const double path = -std::log(1.0 - random.uniform()) / majorant;
        at = at + path * w;
        if (!(at.x >= 0.0 && at.x < box.x && at.y >= 0.0 && at.y < box.y && at.z >= 0.0 &&
              at.z < box.z)) {
          counts[part][tissues] += 1.0;
          break;
        }
        const Tissue tissue = tissue_at(at);
        double u = random.uniform() * majorant;
        if (u < tissue.medium.sigma_a) {
          counts[part][tissue.number] += 1.0;
          break;
        }
        if (u >= tissue.medium.sigma_a + tissue.medium.sigma_s) continue;
        // Henyey and Greenstein's cosine, in closed form.
        const double g = tissue.medium.g;
        const double ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * random.uniform());
        const double mu = (1.0 + g * g - ratio * ratio) / (2.0 * g);
        const double phi = 2.0 * std::numbers::pi * random.uniform();
        const double sine = std::sqrt(std::fmax(0.0, 1.0 - mu * mu));
        w = normalize(make_frame(w).to_world({sine * std::cos(phi), sine * std::sin(phi), mu}));
      }
    }
  });
  std::vector<double> fractions(tissues + 1, 0.0);
  for (const auto& part : counts)
    for (std::size_t t = 0; t <= tissues; ++t)
      fractions[t] += part[t] / static_cast<double>(photons);
  return fractions;
}

}  // namespace lamina
