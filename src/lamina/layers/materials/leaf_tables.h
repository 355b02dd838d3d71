// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/materials/chromophore_tables.h"

namespace lamina {

/// Specific absorption of what leaves hold, 400-1000 nm, natural: of chlorophyll a and b,
/// carotenoids and anthocyanins [cm²/µg], brown pigments (arbitrary), water [1/cm] and dry matter
/// [cm²/g]. Tables that end at 800 nm stay as they are there: pigments are clear, and dry matter
/// absorbs alike.
extern const EvenTable chlorophyll_absorption;
extern const EvenTable carotenoid_absorption;
extern const EvenTable anthocyanin_absorption;
extern const EvenTable brown_absorption;
extern const EvenTable leaf_water_absorption;
extern const EvenTable dry_matter_absorption;

}  // namespace lamina
