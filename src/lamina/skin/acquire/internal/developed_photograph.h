// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/skin/acquire/calibration/develop.h"
#include "lamina/skin/acquire/develop_capture.h"

namespace lamina::acquire_detail {

struct DevelopedPhotograph {
  Developed developed;
  std::vector<double> errors;      ///< [channel] of the calibration, relative
  std::vector<std::string> notes;  ///< what was done, in sentences
};
/// @throws InvalidInput, which begins with a place
[[nodiscard]] DevelopedPhotograph develop_photograph(PhotographDescription photograph);

/// Excludes the pixels of a color chart, which are no skin.
void leave_out_chart(const ChartCorners& corners, PixelMask& mask);

/// Result of a function, whose refusals begin with a place.
template <class Function>
auto at_place(const std::string& place, const Function& function) {
  try {
    return function();
  } catch (const InvalidInput& error) {
    throw InvalidInput(place + ": " + error.what());
  }
}

}  // namespace lamina::acquire_detail
