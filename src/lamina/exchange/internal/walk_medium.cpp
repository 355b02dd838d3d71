// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/internal/walk_medium.h"

#include <algorithm>

#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/thin_sheet.h"
#include "lamina/exchange/misfit_json.h"

namespace lamina::detail {

WalkMedium make_walk_medium(const ExportInput& input, std::string_view format) {
  require_rgb(input, format);
  WalkMedium medium;
  const Profile& profile = input.light->profile;
  const auto clamped = [](std::vector<double> totals) {
    for (double& total : totals) total = std::clamp(total, 0.0, 1.0);
    return totals;
  };
  medium.reflectance = clamped(profile.total_reflectance);
  if (input.fit) {
    medium.g = input.fit->g();
    for (const Medium& of_channel : input.fit->media) {
      medium.albedo.push_back(albedo(of_channel));
      medium.mean_free_path.push_back(mfp(of_channel));
    }
    medium.misfits = input.fit->misfits;
    return medium;
  }
  medium.transmittance = clamped(profile.total_transmittance);
  for (std::size_t c = 0; c < input.channels.size(); ++c)
    medium.misfits.push_back(
        {.channel = input.channels.names[c],
         .reflectance = {.wanted_total = profile.total_reflectance[c],
                         .obtained_total = medium.reflectance[c],
                         .spread = {}},
         .transmittance = LightMisfit{.wanted_total = profile.total_transmittance[c],
                                      .obtained_total = medium.transmittance[c],
                                      .spread = {}}});
  return medium;
}

JsonOutput walk_medium_json(const ExportInput& input, std::string_view format,
                            const WalkMedium& medium) {
  JsonOutput json = head_json(input, format);
  json["ior"] = input.surface_ior;
  json["roughness"] = input.surface.roughness;
  json["reflectance"] = medium.reflectance;
  if (medium.is_sheet()) {
    json["transmittance"] = medium.transmittance;
  } else {
    json["g"] = medium.g;
    json["albedo"] = medium.albedo;
    json["mean_free_path_mm"] = medium.mean_free_path;
  }
  json["misfit"] = misfit_json(medium.misfits);
  return json;
}

}  // namespace lamina::detail
