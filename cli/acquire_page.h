// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/io/json_output.h"
#include "lamina/skin/acquire/acquisition_check.h"

namespace lamina::cli {

/// A number of skin over the pixels that are skin.
struct NumberSummary {
  std::string name;
  double low = 0.0, median = 0.0, high = 0.0;    ///< 5th, 50th and 95th percentile
  double deviation = 0.0, high_deviation = 0.0;  ///< of the coordinate: median, 95th percentile
  bool is_relative = false;                      ///< the coordinate is a logarithm
  double prior_share = 1.0, within_share = 1.0;
};
[[nodiscard]] std::vector<NumberSummary> summaries_of(const AcquiredSkin& skin);

/// How many pixels are skin, and what the others are.
[[nodiscard]] std::string pixels_text(const Capture& capture, const AcquiredSkin& skin);

/// How much an error is, as people say it: "4 %" of a logarithm, ".3" of a logit.
[[nodiscard]] std::string deviation_text(double deviation, bool is_relative);

/// Chi squared of each band, and how much its errors have grown.
[[nodiscard]] std::string chi_squared_text(const Capture& capture, const AcquiredSkin& skin);

/// Shares of the prior in words: "told", "told in part", "differences only", "from the prior".
[[nodiscard]] std::string told_text(const NumberSummary& number);

/// An acquisition as one HTML page that needs nothing else: pictures of the capture, of what the
/// maps reflect, of maps and errors; what is told and what is not; what it hangs on.
/// @param command  as it was typed
/// @param file     text of the capture file; may be empty
[[nodiscard]] std::string acquire_page(const Capture& capture, const AcquiredSkin& skin,
                                       const AcquisitionCheck& check, const std::string& command,
                                       const std::string& file);

}  // namespace lamina::cli
