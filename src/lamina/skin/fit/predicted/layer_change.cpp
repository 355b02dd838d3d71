// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/predicted/layer_change.h"

#include <cmath>

namespace lamina::fit_detail {
namespace {

double difference(double a, double b) { return std::isfinite(a) && std::isfinite(b) ? b - a : 0.0; }

}  // namespace

std::optional<std::vector<LayerChange>> change_between(const LayerStack& a, const LayerStack& b) {
  if (a.layers().size() != b.layers().size() || a.ior_above() != b.ior_above() ||
      a.ior_below() != b.ior_below() || a.ground().reflectance != b.ground().reflectance ||
      a.ground().top != b.ground().top)
    return std::nullopt;
  std::vector<LayerChange> changes;
  for (std::size_t k = 0; k < a.layers().size(); ++k) {
    const Layer &from = a.layers()[k], &to = b.layers()[k];
    const double g = to.medium.g - from.medium.g;
    // A phase function that is no single lobe may change with its mean cosine kept, but not here:
    // lobes are of parts of different g.
    const bool has_lobes = from.phase.has_value() || to.phase.has_value();
    if (from.medium.ior != to.medium.ior || from.top != to.top ||
        std::isfinite(from.thickness) != std::isfinite(to.thickness) ||
        (has_lobes && std::abs(g) > 1e-14))
      return std::nullopt;
    changes.push_back({difference(from.medium.sigma_a, to.medium.sigma_a),
                       difference(from.medium.sigma_s, to.medium.sigma_s), g,
                       difference(from.thickness, to.thickness)});
  }
  return changes;
}

double derivative_along(const std::vector<LayerDerivatives>& derivatives,
                        const std::vector<LayerChange>& change) {
  double sum = 0.0;
  for (std::size_t k = 0; k < change.size(); ++k)
    sum += derivatives[k].by_sigma_a * change[k].sigma_a +
           derivatives[k].by_sigma_s * change[k].sigma_s + derivatives[k].by_g * change[k].g +
           derivatives[k].by_thickness * change[k].thickness;
  return sum;
}

}  // namespace lamina::fit_detail
