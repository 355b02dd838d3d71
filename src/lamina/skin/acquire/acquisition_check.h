// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/skin/acquire/acquired_skin.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"

namespace lamina {

/// Comparison of acquired maps with what was photographed, and how far they hang on the
/// calibration.
struct AcquisitionCheck {
  Image measured;                ///< [y][x][band] every picture_step-th pixel of the capture
  Image predicted;               ///< what the maps reflect there
  std::vector<bool> is_skin;     ///< [y][x] of both, where that is worked out
  std::vector<double> residual;  ///< [band] root of the mean squared relative difference over skin
  /// CIEDE2000 between both over skin, mean and 95th percentile; of bands that are sRGB
  std::optional<double> mean_difference, high_difference;
  /// Change of each number's coordinate if a band were 2 % brighter, at the median color of skin;
  /// [band][number]
  DenseMatrix by_calibration;
  DenseMatrix correlation;  ///< of the numbers' coordinates there
};

/// @param table  over the wavelengths of the capture
/// @throws Interrupted if progress asks to stop
[[nodiscard]] AcquisitionCheck check_acquisition(const Capture& capture, const AcquiredSkin& skin,
                                                 const SkinReflectanceTable& table,
                                                 const Progress& progress = {});

/// Sentences on bands of which the maps leave more than their errors, as they are stated, allow:
/// chi squared above `chi_squared_of_note`, or residuals of more than five times the error.
[[nodiscard]] std::vector<std::string> notes_of_misfit(const Capture& capture,
                                                       const AcquiredSkin& skin,
                                                       const AcquisitionCheck& check);

/// Adds errors of gains that are not known to the deviations of maps: by how far numbers move with
/// bands at the median color, and at most the prior's.
void add_gain_errors(const Capture& capture, const AcquisitionCheck& check, AcquiredSkin& skin);

}  // namespace lamina
