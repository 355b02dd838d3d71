// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lamina/base/core/vec.h"
#include "lamina/base/spectrum/color.h"

namespace lamina {

/// Where a plane's point is seen in a picture.
[[nodiscard]] Vec2 seen_at(const Matrix3& homography, Vec2 point);

/// The homography that takes points of a plane nearest to their places in a picture, in the
/// algebraic sense, of 4 points or more, not 3 of 4 on a line. Source: [HartleyZisserman2004] §4.1.
[[nodiscard]] Matrix3 fit_homography(std::span<const Vec2> plane, std::span<const Vec2> picture);

}  // namespace lamina
