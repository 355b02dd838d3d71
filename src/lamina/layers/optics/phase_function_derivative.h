// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/optics/phase_function.h"

namespace lamina {

/// Derivative of `legendre_moment` by the g of the Henyey-Greenstein lobes, all changed alike, the
/// weights of a mixture kept; 0 where there are none. l >= 0. For Henyey-Greenstein l g^(l - 1).
[[nodiscard]] double legendre_moment_by_g(const PhaseFunction& phase, int l);

}  // namespace lamina
