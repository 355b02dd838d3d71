// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
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

/// Where maps of leaves lie.
struct LeafFiles {
  std::vector<std::filesystem::path> maps, deviations;  ///< [map]
  std::filesystem::path mask;                           ///< 1 where there is leaf
  std::filesystem::path material;                       ///< a leaf that uses the maps
  std::filesystem::path patch;  ///< a patch of it; empty if the size of pixels is not known
};

/// Writes maps (NAME.exr), their standard deviations (NAME.sd.exr), mask.exr, material.json and,
/// where the size of pixels is known, patch.json into a folder. Where there is no leaf maps have
/// their median.
/// @param version  of lamina
/// @throws WriteError
LeafFiles save_leaf(const LeafMaps& leaf, const Capture& capture,
                    const std::filesystem::path& folder, const std::string& version);

}  // namespace lamina
