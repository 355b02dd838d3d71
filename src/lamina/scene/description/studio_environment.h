// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/image/image.h"

namespace lamina {

/// A photographer's studio as a latitude-longitude image, for when no photographed one is at hand:
/// a large warm soft box before the subject, to the left and above; narrow strips behind it on both
/// sides that draw its outline; a wide dim reflector to the right; a box overhead; walls that grow
/// darker downward, and a dark floor.
///
/// The subject stands at the origin, +y is up and the camera is on the side of +z. A white diffuse
/// surface that faces the key light has about radiance 1.
///
/// @param height  of the image, half of its width, > 0.
[[nodiscard]] Image make_studio_environment(int height = 256);

}  // namespace lamina
