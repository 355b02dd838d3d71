// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/image/image.h"

namespace lamina {

/// A photograph as the sensor saw it.
struct CameraRaw {
  /// Linear "R", "G", "B" of the sensor's own filters: less black, over its largest number, so that
  /// 1 is saturation; without white balance or color matrix, not turned upright.
  Image image;
  std::string camera;       ///< make and model, as the file has them
  double exposure_s = 0.0;  ///< [s]; 0: unknown, as for those below
  double iso = 0.0, f_number = 0.0;
};

/// Reconstruction of colors from the four pixels that see red, green, green, and blue.
enum class Demosaic {
  half_size,  ///< one pixel: noise stays independent
  bilinear,   ///< four, of which what a pixel does not see is the mean of its neighbours
};

/// Whether this build has libraw.
[[nodiscard]] bool reads_camera_raw();

/// Reads DNG, NEF, CR2, CR3, ARW, RAF, ORF, RW2 and others that libraw knows. load_image does so,
/// too, in full size.
/// @throws FileError if the file is missing, no such file, damaged, takes more memory than is left,
///         or this build has no libraw.
[[nodiscard]] CameraRaw load_camera_raw(const std::filesystem::path& file, Demosaic demosaic,
                                        MemoryBudget& memory);

}  // namespace lamina
