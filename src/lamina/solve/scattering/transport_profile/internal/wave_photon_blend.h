// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/solve/scattering/monte_carlo/ring_density.h"

namespace lamina::detail {

/// A profile on one side of a stack, as waves have it.
struct WaveCurve {
  std::span<const double> density, error;        ///< [radius] [1/mm²]
  std::vector<std::span<const double>> changes;  ///< [step of a refinement][radius] what it left
  double highest = 0.0;                          ///< spatial frequency that was solved [1/mm]
};

struct BlendedCurve {
  std::vector<double> density, error;  ///< [radius] [1/mm²], neither negative
};

/// Waves and photons together. Where photons know more, by the errors of both, the profile is
/// theirs; of the difference, taken apart by spatial frequency, that part stays which waves know
/// better: variance / (variance + error²), the least variance of two estimates of one number.
///
/// @param r        in a geometric series [mm].
/// @param known    [radius] light that the rings leave out [1/mm²].
/// @param unseen   by what fraction `known` may be wrong.
/// @param photons  as many as were traced.
[[nodiscard]] BlendedCurve blend(std::span<const double> r, const WaveCurve& waves,
                                 std::span<const double> known, double unseen,
                                 const RingFlux& rings, double photons);

}  // namespace lamina::detail
