// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/progress.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/skin/acquire/acquired_skin.h"
#include "lamina/skin/acquire/acquisition_check.h"
#include "lamina/skin/acquire/capture.h"
#include "lamina/skin/acquire/patch_acquisition.h"

namespace lamina {

/// How light of one pixel counts for others.
enum class LateralLight {
  automatic,  ///< transport where the size of pixels is known and the capture is no texture
  none,       ///< each pixel by itself
  transport   ///< light travels sideways in the skin
};

template <>
inline constexpr auto enum_names<LateralLight> =
    std::to_array<EnumName<LateralLight>>({{"auto", LateralLight::automatic},
                                           {"none", LateralLight::none},
                                           {"transport", LateralLight::transport}});

/// How a capture of skin is solved.
struct AcquisitionPlan {
  bool has_transport = false;
  bool has_table = false;  ///< of the fits of all colors; else all pixels together
};

/// Plans what a capture leaves open. Without a table only concentrations can be told:
/// unless the file says which numbers are wanted, the others are taken out of the capture.
[[nodiscard]] AcquisitionPlan plan_acquisition(Capture& capture, LateralLight lateral);

/// Maps of skin, and how they hold against what was photographed.
struct SkinAcquisition {
  AcquiredSkin skin;
  AcquisitionCheck check;
  std::vector<std::string> notes;  ///< on what the maps leave, in sentences
};

/// Solves a capture of skin by its plan. The deviations have the errors of gains that are not
/// known.
///
/// @param options   of a plan without a table; the plan says whether there is transport
/// @param progress  asked to stop, the best so far is handed over where all pixels are solved
///                  together
/// @throws as acquire_pixels and acquire_patch.
[[nodiscard]] SkinAcquisition acquire_skin(const Capture& capture, const AcquisitionPlan& plan,
                                           PatchAcquisitionOptions options,
                                           const std::optional<DiskCache>& cache = {},
                                           const Progress& progress = {});

}  // namespace lamina
