// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/enum_names.h"
#include "lamina/base/spectrum/color.h"

namespace lamina {

/// Linear RGB that pictures are written in.
enum class RgbSpace {
  rec709,  ///< of sRGB too. Source: [IEC61966-2-1] §4.1
  acescg,  ///< AP1, of ACES. Source: [S-2014-004] §4.2
};

template <>
inline constexpr auto enum_names<RgbSpace> =
    std::to_array<EnumName<RgbSpace>>({{"rec709", RgbSpace::rec709}, {"acescg", RgbSpace::acescg}});

[[nodiscard]] RgbPrimaries primaries_of(RgbSpace space);

/// ACES2065-1 (AP0), in which others meet. Source: [S-2008-001] §4.1.
[[nodiscard]] RgbPrimaries aces2065_primaries();

/// Whether two differ by less than files round to: 1e-4 in every chromaticity.
[[nodiscard]] bool are_alike(const RgbPrimaries& a, const RgbPrimaries& b);

/// Turns linear RGB of one space into that of another; (1, 1, 1) stays. Whites are adapted by
/// Bradford's transform.
/// @throws InvalidInput as rgb_to_xyz
[[nodiscard]] Matrix3 rgb_conversion(const RgbPrimaries& from, const RgbPrimaries& to);

}  // namespace lamina
