// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lamina/base/core/progress.h"
#include "lamina/base/image/image.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/base/spectrum/color.h"
#include "lamina/skin/maps/edits/editable_skin.h"

namespace lamina {

/// Skin in even white light (D65) from above, without what its surface mirrors: "R", "G", "B",
/// linear. Light spreads over the patch as in `lamina patch` with totals of radiative transfer;
/// where the width of the maps is not known each texel is seen by itself.
///
/// @param longest_side  of the picture [texel], which has the proportions of the first map
/// @param cache         keeps tables; absent: none
/// @throws Interrupted if progress asks to stop; InvalidInput as render_skin_patch.
[[nodiscard]] Image skin_preview(const EditableSkin& skin, int longest_side,
                                 const std::optional<DiskCache>& cache = {},
                                 const Progress& progress = {});

/// The mean color of a picture, or of its part that a mask weights.
[[nodiscard]] Lab mean_lab(const Image& picture, const Image& mask = {});

/// Individual typology angle, arctan((L* - 50) / b*) [degree]: above 55 very light skin, below -30
/// dark. Source: [Chardon1991]
[[nodiscard]] double typology_angle(const Lab& color);

/// Two pictures side by side, the first in the size of the second.
[[nodiscard]] Image side_by_side(const Image& first, const Image& second);

}  // namespace lamina
