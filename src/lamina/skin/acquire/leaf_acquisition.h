// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/skin/acquire/capture.h"
#include "lamina/skin/acquire/leaf/leaf_pixels.h"

namespace lamina {

/// Each pixel of a capture of leaves on its own, by fit_leaf_pixels. Bands count as their middle.
/// @throws as fit_leaf_pixels
[[nodiscard]] LeafMaps acquire_leaf(const Capture& capture, const Progress& progress = {});

/// Sentences on bands whose chi squared is above `chi_squared_of_note`.
[[nodiscard]] std::vector<std::string> notes_of_misfit(const Capture& capture,
                                                       const LeafMaps& leaf);

}  // namespace lamina
