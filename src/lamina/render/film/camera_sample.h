// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lamina/base/core/vec.h"

namespace lamina {

/// Radiance and other values of one camera ray, in linear Rec.709.
struct CameraSample {
  Vec3f beauty, subsurface, specular;    ///< subsurface and specular: parts at the first surface
  Vec3f normal, albedo;                  ///< of the first surface
  float depth = 0.0f;                    ///< distance to it [mm]
  std::uint32_t mesh = 0, material = 0;  ///< of it, indices into the scene
  bool is_subsurface = false;
  bool is_hit = false;
};

}  // namespace lamina
