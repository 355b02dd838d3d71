// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "lamina/scene/description/scene.h"

namespace lamina {

/// The size of the bodies of a material, and how far light goes in them in the band where it goes
/// farthest.
struct OpticalSize {
  double size = 0.0;            ///< mean chord [mm]
  double mean_free_path = 0.0;  ///< transport mean free path along it, 1 / (sigma_a + sigma_s (1 -
                                ///< g)), mean over the layers that it passes [mm]; may be infinite
  [[nodiscard]] double in_mean_free_paths() const { return size / mean_free_path; }
};

/// Optical size of the closed bodies of a translucent material; absent if any of them is open, or
/// if its layers end.
///
/// The mean chord of a body is 4 V / S (Cauchy): two thirds of the diameter of a ball, twice the
/// thickness of a sheet. So it is small for thin bodies however wide they are, and small parts of
/// large ones count by their surface. It is also how far light goes in the mean inside a body that
/// does not absorb, however it scatters: [BlancoFournier2003].
[[nodiscard]] std::optional<OpticalSize> optical_size(const Scene& scene, std::uint32_t material);

}  // namespace lamina
