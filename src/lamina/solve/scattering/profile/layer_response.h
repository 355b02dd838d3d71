// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/enum_names.h"

namespace lamina {

/// Light between two layers that counts.
enum class Interreflections {
  all,
  none,  ///< only what crosses the upper layer, turns round once in the lower one, and comes back
};

template <>
inline constexpr auto enum_names<Interreflections> = std::to_array<EnumName<Interreflections>>(
    {{"all", Interreflections::all}, {"none", Interreflections::none}});

/// Response of a layer to diffuse flux that enters as J0(k r), at one spatial frequency k: the
/// factors by which it comes out, still as J0(k r). At k = 0 they are fractions of the total flux.
/// In the symbols of [DonnerJensen2005] with the direction of the light added: R+, T+, R-, T-.
struct LayerResponse {
  double reflection_above = 0.0;
  double transmission_down = 1.0;
  double reflection_below = 0.0;
  double transmission_up = 1.0;  ///< the defaults: nothing there
};

/// Two layers on one another, with all the reflections between them.
///
/// Source: [DonnerJensen2005] Eqs. 21 and 22, which leave out the direction: what returns from
/// below meets the lower side of the upper layer. Without interreflections: Eqs. 17 and 18.
[[nodiscard]] inline LayerResponse stacked(
    const LayerResponse& upper, const LayerResponse& lower,
    Interreflections interreflections = Interreflections::all) {
  const double returns = interreflections == Interreflections::none
                             ? 1.0
                             : 1.0 / (1.0 - upper.reflection_below * lower.reflection_above);
  return {.reflection_above = upper.reflection_above + upper.transmission_down *
                                                           lower.reflection_above *
                                                           upper.transmission_up * returns,
          .transmission_down = upper.transmission_down * lower.transmission_down * returns,
          .reflection_below = lower.reflection_below + lower.transmission_up *
                                                           upper.reflection_below *
                                                           lower.transmission_down * returns,
          .transmission_up = lower.transmission_up * upper.transmission_up * returns};
}

}  // namespace lamina
