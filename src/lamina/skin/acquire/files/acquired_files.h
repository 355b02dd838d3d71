// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lamina/skin/acquire/acquired_skin.h"

namespace lamina {

/// Files of an acquisition.
struct AcquiredFiles {
  std::vector<std::filesystem::path> maps, deviations;  ///< [number]
  std::filesystem::path mask;                           ///< 1 where there is skin
  /// A flat scene of them, seen and lit askew; empty if the size of pixels is not known.
  std::filesystem::path scene;
  std::filesystem::path material;  ///< a material that uses the maps
  std::filesystem::path
      patch;  ///< a patch that uses them; empty if the size of pixels is not known
};

/// Writes maps (NAME.exr), their standard deviations (NAME.sd.exr), mask.exr, material.json and,
/// where the size of pixels is known, patch.json and scene.json into a folder. Each file says in
/// its header what its numbers are: "lamina.unit", "lamina.version", "lamina.capture" and others.
///
/// @param version  of lamina
/// @throws WriteError
AcquiredFiles save_acquired(const AcquiredSkin& skin, const Capture& capture,
                            const std::filesystem::path& folder, const std::string& version);

}  // namespace lamina
