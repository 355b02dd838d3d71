// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace lamina {

/// Whether light passes from one medium to another as if nothing were between them. Indices nearer
/// than this, as means over bands in single precision may be, mirror 1e-11 of a normal beam and
/// turn back what is within .3 degrees of grazing.
[[nodiscard]] inline bool is_same_ior(float a, float b) { return std::abs(a - b) < 1e-5f; }

}  // namespace lamina
