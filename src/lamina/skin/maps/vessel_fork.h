// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <cmath>

#include "lamina/base/core/random.h"

namespace lamina {

/// The two vessels that a vessel splits into.
struct VesselFork {
  double wide, narrow;              ///< diameters, in the unit of that of the vessel before
  double wide_angle, narrow_angle;  ///< by which each turns away, to either side [rad], > 0
};

/// A vessel splits where blood gets through with the least work: what pumping takes and what
/// keeping the blood takes, together. The flow then goes with the cube of the diameter, and the
/// forces of three threads that are drawn with the squares of the diameters balance.
///
/// @param diameter  of the vessel that splits, > 0
/// @param share     of its flow that the narrower vessel takes, in (0, 0.5]
///
/// Source: [Murray1926] for diameters, d0^3 = d1^3 + d2^3; [Murray1926Angles] Eqs. 4 and 5.
[[nodiscard]] inline VesselFork split_vessel(double diameter, double share) {
  assert(diameter > 0.0 && 0.0 < share && share <= 0.5);
  const double wide = std::cbrt(1.0 - share), narrow = std::cbrt(share);
  const double wide4 = std::pow(wide, 4), narrow4 = std::pow(narrow, 4);
  return {.wide = diameter * wide,
          .narrow = diameter * narrow,
          .wide_angle = std::acos((1.0 + wide4 - narrow4) / (2.0 * wide * wide)),
          .narrow_angle = std::acos((1.0 + narrow4 - wide4) / (2.0 * narrow * narrow))};
}

/// A vessel splits by chance: a fifth to nearly half of the flow goes to the narrower one.
[[nodiscard]] inline VesselFork sample_fork(double diameter, Random& random) {
  return split_vessel(diameter, 0.2 + 0.25 * random.uniform());
}

/// How many branches a branch has, as it is shorter than the vessel of so many that it left.
[[nodiscard]] constexpr int branches_of_branch(int branches) { return (branches + 1) / 2; }

}  // namespace lamina
