// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/spatial_frequency/ray_fresnel.h"
#include "lamina/solve/scattering/spatial_frequency/top_passage.h"

namespace lamina::detail {

/// Whether light leaves at the bottom unchanged.
inline bool has_open_bottom(const GridStack& stack) {
  return !stack.is_semi_infinite && stack.ground_reflectance == 0.0;
}

/// The straight way between one side of the stack and a depth inside a layer.
struct Leg {
  const GridStack* stack;
  std::size_t layer;
  bool is_above;                    ///< whether it starts at the top
  double z;                         ///< [mm] inside the layer, from the face nearer to the start
  const TopPassage* top = nullptr;  ///< if it is rough

  [[nodiscard]] std::size_t first() const { return is_above ? 0 : layer + 1; }
  [[nodiscard]] std::size_t last() const { return is_above ? layer : stack->layers.size(); }
  template <class Term>
  [[nodiscard]] double sum(const Term& term) const {
    double total = term(stack->layers[layer], z);
    for (std::size_t l = first(); l < last(); ++l)
      total += term(stack->layers[l], stack->layers[l].thickness);
    return total;
  }
  [[nodiscard]] double aside(double p) const {
    return sum([&](const GridLayer& l, double d) { return d * p / (l.ior * ray_cos(p, l.ior)); });
  }
  [[nodiscard]] double slope(double p) const {
    return sum([&](const GridLayer& l, double d) {
      const double cos = ray_cos(p, l.ior);
      return d / (l.ior * cos * cos * cos);
    });
  }
  [[nodiscard]] double through(double p) const {
    double t = std::exp(-sum([&](const GridLayer& l, double d) {
      return l.sigma_t > 0.0 ? l.sigma_t * d / ray_cos(p, l.ior) : 0.0;
    }));
    for (std::size_t q = first(); q <= last(); ++q)
      t *= q > 0 || top == nullptr ? 1.0 - interface_reflectance(*stack, q, p) : top->out_at(p);
    return t;
  }
  /// The widest p that gets through.
  [[nodiscard]] double widest() const {
    double p = stack->ior[layer + 1];
    for (std::size_t q = first(); q <= last(); ++q)
      if (q > 0 || top == nullptr) p = std::min({p, stack->ior[q], stack->ior[q + 1]});
    return p;
  }
  [[nodiscard]] double depth() const {
    return sum([](const GridLayer&, double d) { return d; });
  }
  /// p of the ray that goes `a` aside; Newton's steps, bisection where they leave the bracket.
  [[nodiscard]] double p_at(double a, double highest) const {
    double low = 0.0, high = highest;
    double p = std::min(stack->layers[layer].ior * a / std::hypot(a, depth()), 0.999 * highest);
    for (int step = 0; step < 40; ++step) {
      const double off = aside(p) - a;
      (off > 0.0 ? high : low) = p;
      const double next = p - off / slope(p);
      const double moved = next > low && next < high ? next : 0.5 * (low + high);
      if (std::abs(moved - p) < 1e-11 * highest) return moved;
      p = moved;
    }
    return p;
  }
};

}  // namespace lamina::detail
