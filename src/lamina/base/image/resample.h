// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/image/image.h"

namespace lamina {

/// An image in another size, all of it. Bilinear between texel centres where it grows; where it
/// shrinks, the mean over a tent as wide as two new texels, so that nothing is lost between them.
/// A constant stays one.
[[nodiscard]] Image resampled(const Image& image, int width, int height);

}  // namespace lamina
