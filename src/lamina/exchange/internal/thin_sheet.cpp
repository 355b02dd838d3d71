// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/internal/thin_sheet.h"

#include <algorithm>

#include "lamina/base/core/error.h"

namespace lamina::detail {

ThinSheet make_thin_sheet(const ChannelLight& light, double enters) {
  ThinSheet sheet;
  const Profile& profile = light.profile;
  double reflected = 0.0, transmitted = 0.0;
  for (std::size_t c = 0; c < light.channels.size(); ++c) {
    reflected += std::max(profile.total_reflectance[c], 0.0);
    transmitted += std::max(profile.total_transmittance[c], 0.0);
  }
  sheet.forward = (transmitted - reflected) / (transmitted + reflected);
  for (std::size_t c = 0; c < light.channels.size(); ++c) {
    const double total = profile.total_reflectance[c] + profile.total_transmittance[c];
    sheet.colors.push_back(std::clamp(total / enters, 0.0, 1.0));
    const double obtained = sheet.colors.back() * enters;
    sheet.misfits.push_back(
        {.channel = light.channels.names[c],
         .reflectance = {.wanted_total = profile.total_reflectance[c],
                         .obtained_total = obtained * 0.5 * (1.0 - sheet.forward),
                         .spread = {}},
         .transmittance = LightMisfit{.wanted_total = profile.total_transmittance[c],
                                      .obtained_total = obtained * 0.5 * (1.0 + sheet.forward),
                                      .spread = {}}});
  }
  return sheet;
}

void require_rgb(const ExportInput& input, std::string_view format) {
  if (!input.channels.wavelengths.empty())
    throw InvalidInput(std::string(format) + ": channels must be R, G, B, but are wavelengths");
}

}  // namespace lamina::detail
