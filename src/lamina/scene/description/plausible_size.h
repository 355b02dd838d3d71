// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lamina/scene/description/scene.h"

namespace lamina {

/// A length for people: 20 m, 183 mm, 1.2 mm.
[[nodiscard]] std::string length_text(double mm);

/// A sentence if a translucent thing of that size is likely a mistake of units: under 3 mm or over
/// 3 m.
/// @param longest_mm   its longest side
/// @param mm_per_unit  that it was told; 0: none
[[nodiscard]] std::optional<std::string> implausible_size(const std::string& name,
                                                          double longest_mm, double mm_per_unit);

/// Warnings of implausible sizes of the translucent meshes of a scene.
[[nodiscard]] std::vector<std::string> implausible_sizes(const Scene& scene);

}  // namespace lamina
