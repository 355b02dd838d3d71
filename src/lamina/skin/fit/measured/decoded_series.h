// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/base/io/json_input.h"
#include "lamina/skin/fit/measured/measurement.h"

namespace lamina::fit_detail {

/// An entry of "measured", its bands not yet known.
struct DecodedSeries {
  MeasuredSeries series;
  std::vector<double> wavelengths;  ///< [point]; empty without
};

/// @throws InvalidInput naming file, line and field, or column.
[[nodiscard]] DecodedSeries decode_series(const JsonInput& value);

}  // namespace lamina::fit_detail
