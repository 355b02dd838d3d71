// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace lamina {

/// Place where a falling function crosses 0, and the function there.
struct BracketedRoot {
  double place;
  double value;
};

/// Finds the root of a function that falls over [low, high].
///
/// @param tolerance  of the function: |value| at the place is at most that, but for functions whose
///                   steps there are larger.
/// @return  the end of the bracket nearest to the root if the function does not cross 0.
///
/// Source: false position, where an end that stays twice counts half (the Illinois rule)
/// [Press2007] §9.2; places are halved between where that does not shorten the bracket.
template <class Function>
[[nodiscard]] BracketedRoot falling_root(const Function& function, double low, double high,
                                         double tolerance) {
  double at_low = function(low), at_high = function(high);
  if (at_low <= 0.0) return {low, at_low};
  if (at_high >= 0.0) return {high, at_high};
  double weight_low = at_low, weight_high = at_high;
  BracketedRoot root{low, at_low};
  for (int step = 0; step < 200 && std::abs(root.value) > tolerance; ++step) {
    const double secant = (low * weight_high - high * weight_low) / (weight_high - weight_low);
    const bool is_between = low < secant && secant < high;
    const double place = is_between && step % 8 != 7 ? secant : 0.5 * (low + high);
    if (place == low || place == high) break;  // neighbours
    const double last = root.value;
    root = {place, function(place)};
    const bool is_same_side = step > 0 && root.value * last > 0.0;
    if (root.value > 0.0) {
      low = place, weight_low = root.value;
      if (is_same_side) weight_high *= 0.5;
    } else {
      high = place, weight_high = root.value;
      if (is_same_side) weight_low *= 0.5;
    }
  }
  return root;
}

}  // namespace lamina
