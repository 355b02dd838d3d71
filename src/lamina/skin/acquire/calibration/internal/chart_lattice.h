// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "lamina/base/image/image.h"
#include "lamina/skin/acquire/calibration/color_chart.h"

namespace lamina {

/// The centres of the corner patches of a chart; absent if there is none.
/// @param rgb  linear, with channels "R", "G", "B"
[[nodiscard]] std::optional<ChartCorners> find_chart_corners(
    const Image& rgb, const std::array<LinearSrgb, chart_patches>& colors);

}  // namespace lamina
