// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lamina {

/// How the method `hierarchy` has sampled the light on a material.
struct LightSamples {
  std::uint32_t material = 0;  ///< index into those of the scene
  double spacing = 0.0;        ///< [mm]
  std::size_t count = 0;
  int estimates = 0;             ///< of the light, at random, at each that the camera may see
  std::optional<double> change;  ///< of the light that leaves, from twice the spacing: root mean
                                 ///< square over that of the light. Absent without refinement
};

/// How random walks corrected the light of a planar method on a material.
struct LightCorrection {
  std::uint32_t material = 0;  ///< index into those of the scene
  std::size_t walks = 0;
  double change = 0.0;      ///< of the light that leaves: root mean square over that of the light
  double error_left = 0.0;  ///< the same of what is still wrong, as far as halves of the walks tell
  double share = 1.0;       ///< of the walks that were wanted: fewer after an early stop
};

/// Notes and costs of a method's preparation.
struct PreparationReport {
  std::vector<LightSamples> light_samples;
  std::vector<LightCorrection> corrections;
  std::vector<std::string> warnings;  ///< one line each
};

}  // namespace lamina
