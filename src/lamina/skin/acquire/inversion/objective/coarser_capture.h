// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/skin/acquire/inversion/objective/patch_maps.h"
#include "lamina/skin/acquire/inversion/texels/patch_capture.h"

namespace lamina::detail {

/// A capture of half the width and height, rounded up. Each texel is the mean of four, weighted by
/// what is known of them, and known if as much as half of it is.
[[nodiscard]] PatchCapture coarser_capture(const PatchCapture& capture);

/// Maps of the coarser capture on the texels of the finer one, bilinear.
[[nodiscard]] TexelMaps on_finer(const TexelMaps& coarse, const PatchCapture& fine);

}  // namespace lamina::detail
