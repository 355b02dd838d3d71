// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lamina/skin/acquire/capture.h"
#include "lamina/skin/acquire/leaf/leaf_pixels.h"

namespace lamina {

/// Files of maps of leaves.
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
