// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace lamina {

inline constexpr float float_pi = std::numbers::pi_v<float>;

}  // namespace lamina
