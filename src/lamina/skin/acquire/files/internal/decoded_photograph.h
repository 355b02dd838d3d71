// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/json_input.h"
#include "lamina/skin/acquire/develop_capture.h"
#include "lamina/skin/acquire/files/internal/decoded_sensor.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina::acquire_detail {

/// One entry of "images", how its channels see, and its light.
struct DecodedPhotograph {
  PhotographDescription photograph;
  DecodedSensor sensor;
  Image light;             ///< its pattern, "Y"; empty: even
  std::string light_file;  ///< that it is from
};
/// @param incidence  of the light on the white
[[nodiscard]] DecodedPhotograph decode_photograph(const JsonInput& value,
                                                  const Incidence& incidence);

/// An image without infinities and NaN.
[[nodiscard]] Image load_finite(const JsonInput& file, ColorEncoding encoding);

/// Corners in pixels from the upper left corner. @param fewest,most  of them
[[nodiscard]] std::vector<Vec2> decode_corners(const JsonInput& value, std::size_t fewest,
                                               std::size_t most);

}  // namespace lamina::acquire_detail
