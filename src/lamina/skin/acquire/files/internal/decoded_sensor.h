// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lamina/base/io/json_input.h"

namespace lamina::acquire_detail {

/// Sensitivity of one channel of a photograph: weights of a spectrum at wavelengths [nm].
using BandWeightsOverWavelengths = std::vector<std::array<double, 2>>;  ///< [][nm, weight], sum 1

struct DecodedSensor {
  std::vector<std::string> names;  ///< of the bands: "R", "420nm"
  std::vector<BandWeightsOverWavelengths> bands;
};

/// Decodes what the channels of an image see: "srgb", or an object with "wavelength_nm" and
/// "width_nm", or with "curves", "columns" and "illuminant".
/// @param channels  of the image, as many as the sensor must have
[[nodiscard]] DecodedSensor decode_sensor(const JsonInput& value,
                                          const std::vector<std::string>& channels);

}  // namespace lamina::acquire_detail
