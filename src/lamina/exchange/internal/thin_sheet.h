// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "lamina/exchange/export_format.h"

namespace lamina::detail {

/// A sheet without thickness that scatters evenly to both sides, with one color for both.
struct ThinSheet {
  std::vector<double> colors;  ///< [channel], of both sides together, in [0, 1]
  double forward = 0.0;        ///< in [-1, 1]; (1 + forward) / 2 of the light goes through
  std::vector<ChannelMisfit> misfits;
};

/// The part that goes through is that of all channels together.
/// @param enters  the part of diffuse light that the target's surface lets in, in (0, 1]
[[nodiscard]] ThinSheet make_thin_sheet(const ChannelLight& light, double enters);

/// @throws InvalidInput if channels are wavelengths, which `format` does not have.
void require_rgb(const ExportInput& input, std::string_view format);

}  // namespace lamina::detail
