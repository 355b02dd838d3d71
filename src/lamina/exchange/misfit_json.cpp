// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/misfit_json.h"

namespace lamina {
namespace {

JsonOutput light_json(const LightMisfit& misfit) {
  JsonOutput json = {{"wanted_total", misfit.wanted_total},
                     {"obtained_total", misfit.obtained_total}};
  if (misfit.spread) {
    json["wanted_mean_square_radius_mm2"] = misfit.spread->wanted_mean_square_radius;
    json["obtained_mean_square_radius_mm2"] = misfit.spread->obtained_mean_square_radius;
    json["profile_rms"] = misfit.spread->profile_rms;
  }
  return json;
}

}  // namespace

JsonOutput misfit_json(std::span<const ChannelMisfit> misfits) {
  JsonOutput json = JsonOutput::array();
  for (const ChannelMisfit& misfit : misfits) {
    json.push_back({{"channel", misfit.channel}, {"reflectance", light_json(misfit.reflectance)}});
    if (misfit.transmittance) json.back()["transmittance"] = light_json(*misfit.transmittance);
  }
  return json;
}

}  // namespace lamina
