// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace lamina::cli {

inline constexpr double degree =
    std::numbers::pi / 180.0;  ///< [rad]; users state angles in degrees

}  // namespace lamina::cli
