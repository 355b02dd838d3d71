// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/io/json_output.h"
#include "lamina/exchange/export_format.h"

namespace lamina::detail {

/// Material as formats of ExportNeeds::walk state it: the medium below a boundary that does not
/// refract, or of sheets R and T alone.
struct WalkMedium {
  double g = 0.0;
  std::vector<double> albedo, mean_free_path;      ///< [channel], [mm]; empty of sheets
  std::vector<double> reflectance, transmittance;  ///< [channel], of diffuse light
  std::vector<ChannelMisfit> misfits;

  [[nodiscard]] bool is_sheet() const { return albedo.empty(); }
};

/// @throws InvalidInput if channels are not R, G, B.
[[nodiscard]] WalkMedium make_walk_medium(const ExportInput& input, std::string_view format);

/// With head_json, the surface and misfits.
[[nodiscard]] JsonOutput walk_medium_json(const ExportInput& input, std::string_view format,
                                          const WalkMedium& medium);

}  // namespace lamina::detail
