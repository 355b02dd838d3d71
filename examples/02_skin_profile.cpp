// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// How wrong is diffusion for skin? Prints R(r) of radiative transfer beside that of layered
// diffusion.
#include <cstdio>
#include <vector>

#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

int main() {
  const lamina::Material skin = lamina::find_material("donner_jensen_skin");
  std::vector<lamina::LayerStack> bands;
  for (std::size_t band = 0; band < skin.bands.size(); ++band)
    bands.push_back(lamina::layer_stack(skin, band));
  const lamina::RadialGrid grid{.first = 0.01, .last = 3.0, .size = 6};
  const lamina::Profile transfer = lamina::transfer_profile(bands, grid).profile;
  // Diffusion counts light that entered, transfer light that arrived: 1 - F at normal incidence.
  const std::vector<double> entry(bands.size(), lamina::entry_transmittance(bands[0], {}));
  const lamina::Profile diffusion =
      lamina::per_arriving_flux(lamina::make_diffusion_profile(bands, {}, grid).profile, entry);
  std::puts("r [mm]   R(r) of red light [1/mm2]   diffusion / transfer");
  for (std::size_t i = 0; i < transfer.r.size(); ++i)
    std::printf("%6.3f   %25.3e   %17.2f\n", transfer.r[i], transfer.reflectance_at(i, 0),
                diffusion.reflectance_at(i, 0) / transfer.reflectance_at(i, 0));
}
