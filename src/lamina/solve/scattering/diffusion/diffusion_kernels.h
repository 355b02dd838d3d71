// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/solve/scattering/diffusion/layered_diffusion.h"

// The loop in which profiles by diffusion spend their time, compiled for each instruction set and
// chosen at run time. Results differ between processors by rounding only.

namespace lamina {

/// The response of a stack from above, [k].
struct StackSpectrum {
  std::vector<double> reflection_above, transmission_down;
};

/// `response(model, k)` at many frequencies k > 0 [1/mm]; to 1e-14 of the value at k = 0.
[[nodiscard]] StackSpectrum stack_spectrum(const LayeredDiffusion& model,
                                           std::span<const double> k);

}  // namespace lamina
