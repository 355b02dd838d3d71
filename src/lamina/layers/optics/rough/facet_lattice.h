// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/optics/rough/microfacet.h"

namespace lamina::detail {

/// Calls visit(normal, weight) for a lattice of facets as seen from wi; the weights add up to 1, so
/// that the weighted sum of a function is its mean over visible facets.
///
/// A Fibonacci lattice in the unit square of the sampler. t^2 (3 - 2t) makes the integrand
/// periodic, so that only its kinks cost accuracy: total reflection, and directions that cross the
/// horizon.
/// @tparam points, step  consecutive Fibonacci numbers. With 2584 means are good to 7e-4 at the
/// edge of
///                       total reflection and 1e-5 elsewhere, with 28657 to 1e-4.
template <int points = 2584, int step = 1597, class Visit>
void for_each_visible_facet(const Microfacets<double>& facets, const Vec3& wi, const Visit& visit) {
  double total = 0.0;
  for (int k = 0; k < points; ++k) {
    const double t1 = (k + 0.5) / points;
    const double t2 = std::fmod(static_cast<double>(k) * step + 0.5, points) / points;
    total += t1 * (1.0 - t1) * t2 * (1.0 - t2);
  }
  for (int k = 0; k < points; ++k) {
    const double t1 = (k + 0.5) / points;
    const double t2 = std::fmod(static_cast<double>(k) * step + 0.5, points) / points;
    visit(sample_visible_normal(facets, wi, t1 * t1 * (3.0 - 2.0 * t1), t2 * t2 * (3.0 - 2.0 * t2)),
          t1 * (1.0 - t1) * t2 * (1.0 - t2) / total);
  }
}

}  // namespace lamina::detail
