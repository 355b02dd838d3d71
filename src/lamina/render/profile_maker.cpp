// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/profile_maker.h"

#include <utility>
#include <vector>

#include "lamina/optics/fresnel.h"
#include "lamina/scattering/diffusion_profile.h"
#include "lamina/scattering/dipole_profile.h"
#include "lamina/scattering/exact_profile_cache.h"

namespace lamina {
namespace {

std::vector<LayerStack> stacks_of(const Material& material) {
  std::vector<LayerStack> stacks;
  for (std::size_t band = 0; band < material.bands.size(); ++band)
    stacks.push_back(layer_stack(material, band));
  return stacks;
}

LayerStack smoothed(const LayerStack& stack) {
  std::vector<Layer> layers(stack.layers().begin(), stack.layers().end());
  for (Layer& layer : layers) layer.top.roughness = 0.0;
  Ground ground = stack.ground();
  ground.top.roughness = 0.0;
  return LayerStack(std::move(layers), stack.ior_above(), stack.ior_below(), ground);
}

}  // namespace

Profile exact_diffuse_profile(const Material& material, const std::optional<DiskCache>& cache,
                              const Progress& progress) {
  std::vector<LayerStack> stacks;
  std::vector<double> entry;
  for (const LayerStack& stack : stacks_of(material)) {
    stacks.push_back(smoothed(stack));
    entry.push_back(1.0 - fresnel_diffuse(stack.layers()[0].medium.ior / stack.ior_above()));
  }
  const auto [exact, was_cached] = cached_exact_profile(
      cache, stacks, {},
      {.accuracy = 0.02,
       .r_lowest = 0.02,
       .illumination = Illumination::diffuse,
       .progress = progress});
  return per_entered_flux(exact.profile, entry);
}

Profile diffusion_profile(const Material& material) {
  return make_diffusion_profile(stacks_of(material)).profile;
}

ProfileMaker profile_maker(RenderSettings::Profile profile, const Progress& progress) {
  switch (profile) {
    case RenderSettings::Profile::exact:
      return [progress](const Material& material) {
        return exact_diffuse_profile(material, user_cache(), progress);
      };
    case RenderSettings::Profile::dipole:
      return [](const Material& material) { return make_dipole_profile(stacks_of(material)); };
    case RenderSettings::Profile::multipole:
      break;
  }
  return diffusion_profile;
}

}  // namespace lamina
