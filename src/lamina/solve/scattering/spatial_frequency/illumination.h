// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lamina {

/// How light arrives at the point r = 0.
enum class Illumination {
  normal_beam,  ///< along the normal
  diffuse       ///< equal radiance from the whole hemisphere
};

}  // namespace lamina
