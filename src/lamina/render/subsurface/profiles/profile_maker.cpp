// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/profile_maker.h"

#include <utility>
#include <vector>

#include "lamina/optics/fresnel.h"
#include "lamina/reflectance/material_totals.h"
#include "lamina/scattering/diffusion/diffusion_profile.h"
#include "lamina/scattering/diffusion/dipole_profile.h"
#include "lamina/scattering/transport_profile/transfer_profile_cache.h"
#include "lamina/scene/skin_totals.h"

namespace lamina {
namespace {

std::vector<LayerStack> stacks_of(const Material& material) {
  std::vector<LayerStack> stacks;
  for (std::size_t band = 0; band < material.bands.size(); ++band)
    stacks.push_back(layer_stack(material, band));
  return stacks;
}

}  // namespace

Profile diffuse_transfer_profile(const Material& material, const std::optional<DiskCache>& cache,
                                 const Progress& progress) {
  std::vector<LayerStack> stacks;
  std::vector<double> entry;
  for (std::size_t band = 0; band < material.bands.size(); ++band) {
    const LayerStack& stack = stacks.emplace_back(stack_with_smooth_ends(material, band));
    entry.push_back(1.0 - fresnel_diffuse(stack.layers()[0].medium.ior / stack.ior_above()));
  }
  const auto [exact, was_cached] = cached_transfer_profile(cache, stacks, {},
                                                           {.accuracy = 0.02,
                                                            .r_lowest = 0.02,
                                                            .illumination = Illumination::diffuse,
                                                            .progress = progress});
  return per_entered_flux(exact.profile, entry);
}

Profile diffusion_profile(const Material& material) {
  return make_diffusion_profile(stacks_of(material)).profile;
}

ProfileMaker profile_maker(const RenderSettings& settings, const Progress& progress) {
  if (settings.profile == RenderSettings::Profile::exact)
    return [progress](const Material& material) {
      return diffuse_transfer_profile(material, user_cache(), progress);
    };
  return [settings](const Material& material) {
    Profile profile = settings.profile == RenderSettings::Profile::dipole
                          ? make_dipole_profile(stacks_of(material))
                          : diffusion_profile(material);
    return takes_exact_totals(material, settings) ? with_exact_totals(std::move(profile), material)
                                                  : profile;
  };
}

}  // namespace lamina
