// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/profile_maker.h"

#include <utility>
#include <vector>

#include "lamina/reflectance/material_totals.h"
#include "lamina/scattering/diffusion/diffuse_boundary.h"
#include "lamina/scattering/diffusion/diffusion_profile.h"
#include "lamina/scattering/diffusion/dipole_profile.h"
#include "lamina/scattering/transport_profile/transfer_profile_cache.h"
#include "lamina/scene/skin_totals.h"

namespace lamina {

Profile diffuse_transfer_profile(std::span<const LayerStack> bands,
                                 const std::optional<DiskCache>& cache, const Progress& progress) {
  std::vector<LayerStack> stacks;
  std::vector<double> entry;
  for (const LayerStack& band : bands) {
    const LayerStack& stack = stacks.emplace_back(with_smooth_bottom(band));
    entry.push_back(1.0 - diffuse_reflectance_outside(stack.layers()[0].top, stack.ior_above(),
                                                      stack.layers()[0].medium.ior));
  }
  const auto [transfer, was_cached] =
      cached_transfer_profile(cache, stacks, {},
                              {.accuracy = 0.02,
                               .r_lowest = 0.02,
                               .illumination = Illumination::diffuse,
                               .progress = progress});
  return per_entered_flux(transfer.profile, entry);
}

Profile diffusion_profile(const Material& material) {
  return make_diffusion_profile(layer_stacks(material)).profile;
}

ProfileMaker profile_maker(const RenderSettings& settings, const Progress& progress) {
  if (settings.profile == RenderSettings::Profile::radiative_transfer)
    return [progress](const Material&, std::span<const LayerStack> bands) {
      return diffuse_transfer_profile(bands, user_cache(), progress);
    };
  return [settings](const Material& material, std::span<const LayerStack> bands) {
    Profile profile = settings.profile == RenderSettings::Profile::dipole
                          ? make_dipole_profile(bands)
                          : make_diffusion_profile(bands).profile;
    return takes_material_totals(material, settings)
               ? with_material_totals(std::move(profile), bands)
               : profile;
  };
}

}  // namespace lamina
