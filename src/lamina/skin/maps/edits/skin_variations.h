// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/materials/skin.h"
#include "lamina/skin/fit/skin/skin_population.h"
#include "lamina/skin/maps/edits/skin_edits.h"

namespace lamina {

/// The maps of a skin on someone else: the mean coordinate of each number that a population knows
/// (its logarithm or logit, as in skin_fit_numbers) becomes that of a person; what differs from
/// place to place stays. Bounds hold, as of edits.
///
/// @param person  one of draw_skins
[[nodiscard]] EditedSkin skin_of_person(EditableSkin skin, const SkinParameters& person);

}  // namespace lamina
