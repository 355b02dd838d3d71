// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// Radiance towards the eye per flux per area that leaves the inside [1/sr].
///
/// @param is_printed  RenderSettings::ExitAngle::printed
[[nodiscard]] inline float leaving_fraction(const ExitPoint& exit, bool is_printed) {
  return is_printed ? (1.0f - reflectance(exit.boundary, exit.cos_o)) / std::numbers::pi_v<float>
                    : exit_distribution(exit.boundary, exit.cos_o);
}

}  // namespace lamina
