// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/base/core/estimate.h"

namespace lamina {

/// Light around a point, counted in rings of equal width in log r.
struct RingFlux {
  double first_radius = 0.0;   ///< where the first ring begins [mm], > 0
  double log_width = 0.0;      ///< of each ring, in log r, > 0
  std::vector<Estimate> flux;  ///< [ring]
  Estimate nearer, farther;    ///< flux beside the rings

  [[nodiscard]] double begin_of(std::size_t ring) const;  ///< [mm]; of flux.size(): the end
};

/// The density at distances r [mm], ascending, that such flux is of, with its standard error
/// [1/mm²]: the likeliest exponential of a parabola in log r over rings nearby. Of several widths
/// of what is nearby the widest counts whose answer agrees with those of all narrower ones, so that
/// where the density is smooth many rings speak together. Nearer than a few hundred photons reach,
/// it goes on as a power of r; where nothing was counted it is 0, and its error infinite.
///
/// Source: [Loader1996] for local likelihood, [GoldenshlugerNemirovski1997] for the width.
[[nodiscard]] std::vector<Estimate> density_of_rings(const RingFlux& rings,
                                                     std::span<const double> r);

}  // namespace lamina
