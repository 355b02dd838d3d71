// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/multipole.h"
#include "lamina/solve/scattering/layered_bsdf/layered_bsdf.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

int main() {
  const lamina::LayerStack stack = lamina::layer_stack(lamina::find_material("jade"), 0);
  const lamina::SlabTotals totals = lamina::adding_doubling(stack, {}).totals;
  const auto photons = lamina::trace_photons(stack, {.photons = 1000});
  std::printf("%.2f of light, %zu photons\n", totals.diffuse_reflectance,
              static_cast<std::size_t>(photons.photons));
}
