// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

// ICC profiles, made by LittleCMS.

namespace lamina {

/// Profile of RGB with these primaries (x, y of red, green and blue) under D65; a curve of sRGB
/// where the exponent is 0.
[[nodiscard]] std::vector<std::byte> rgb_profile(const std::array<double, 6>& primaries,
                                                 double exponent);
[[nodiscard]] std::vector<std::byte> p3_profile(double exponent = 0.0);
[[nodiscard]] std::vector<std::byte> grey_profile(double exponent);
[[nodiscard]] std::vector<std::byte> lab_profile();

/// Profile of tables: the values of 17^3 places go through the other profile, to Lab.
[[nodiscard]] std::vector<std::byte> table_profile(const std::vector<std::byte>& like);

}  // namespace lamina
