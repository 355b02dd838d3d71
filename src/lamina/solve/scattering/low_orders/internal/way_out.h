// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/low_orders/single_scattering_profile.h"

namespace lamina::detail {

inline double cos_of(double p, double ior) {
  return std::sqrt(std::max(0.0, (1.0 - p / ior) * (1.0 + p / ior)));
}

inline double tangent(double p, double ior) { return p / (ior * std::max(cos_of(p, ior), 1e-150)); }

/// Reflectance of interface q for light of this p, 1 if it exists on one side only.
inline double face_reflectance(const GridStack& stack, std::size_t q, double p) {
  const double near = stack.ior[q], far = stack.ior[q + 1];
  if (p >= near || p >= far) return near == far && p < near ? 0.0 : 1.0;
  return fresnel(std::min(1.0, cos_of(p, near)), far / near);
}

/// The widest p that gets straight out of a layer.
inline double widest_out(const GridStack& stack, std::size_t source, bool above) {
  const auto first = stack.ior.begin() + static_cast<std::ptrdiff_t>(above ? 0 : source + 1);
  const auto last =
      above ? stack.ior.begin() + static_cast<std::ptrdiff_t>(source + 2) : stack.ior.end();
  return *std::min_element(first, last);
}

/// How far to the side it goes in the layers that it crosses.
inline double aside(const GridStack& stack, const WayOut& way, double p) {
  double x = 0.0;
  for (std::size_t l = 0; l < way.crossings.size(); ++l)
    if (way.crossings[l] > 0)
      x += way.crossings[l] * stack.layers[l].thickness * tangent(p, stack.layers[l].ior);
  return x;
}

inline double power(double base, int exponent) {
  double result = 1.0;
  for (; exponent > 0; exponent /= 2, base *= base)
    if (exponent % 2 == 1) result *= base;
  return result;
}

/// Transmittance of the layers and interfaces that it crosses.
inline double through(const GridStack& stack, const WayOut& way, double p) {
  double optical_depth = 0.0;
  for (std::size_t l = 0; l < way.crossings.size(); ++l)
    if (way.crossings[l] > 0) {
      const GridLayer& layer = stack.layers[l];
      optical_depth += way.crossings[l] * layer.sigma_t * layer.thickness / cos_of(p, layer.ior);
    }
  double t = way.count * std::exp(-optical_depth);
  for (std::size_t q = 0; q < way.passages.size(); ++q) {
    if (way.passages[q] + way.reflections[q] == 0) continue;
    const double r = face_reflectance(stack, q, p);
    t *= power(1.0 - r, way.passages[q]) * power(r, way.reflections[q]);
  }
  return t;
}

}  // namespace lamina::detail
