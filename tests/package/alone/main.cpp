// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>

#include "lamina/layers/materials/material.h"
#include "lamina/skin/acquire/inversion/patch_inversion.h"
#include "lamina/skin/acquire/skin_acquisition.h"
#include "lamina/skin/fit/measurement_fit.h"
#include "lamina/skin/maps/edits/skin_edits.h"
#include "lamina/skin/patch/skin_patch.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"

namespace {

/// Skin of some melanin in two bands, and what its photographs are inverted to.
double melanin_found(double melanin) {
  lamina::SkinPatch patch{.width = 8,
                          .height = 8,
                          .mm_per_texel = 0.5,
                          .bands = lamina::BandSet({550.0, 650.0}),
                          .totals = lamina::OperatorTotals::diffusion};
  patch.skin.skin.melanin = melanin;
  patch.light = lamina::make_image(8, 8, {"Y"});
  for (float& light : patch.light.pixels) light = 1.0f;
  const lamina::Image seen = lamina::render_skin_patch(patch).image;
  lamina::PatchCapture capture{.width = 8,
                               .height = 8,
                               .mm_per_texel = patch.mm_per_texel,
                               .wavelengths = {550.0, 650.0},
                               .lights = {lamina::make_plane(8, 8, 1.0f)}};
  for (std::size_t b = 0; b < 2; ++b) {
    lamina::PatchImage image{.reflected = lamina::make_plane(8, 8),
                             .deviation = lamina::make_plane(8, 8, 1e-3f),
                             .sensor = {b == 0 ? 1.0 : 0.0, b == 1 ? 1.0 : 0.0}};
    for (std::size_t i = 0; i < image.reflected.values.size(); ++i)
      image.reflected.values[i] = seen.pixels[i * seen.channel_count() + b];
    capture.images.push_back(std::move(image));
  }
  const lamina::InversionModel model{
      .numbers = {"melanin"}, .skin = {}, .totals = lamina::OperatorTotals::diffusion};
  const lamina::InversionResult found = lamina::invert_patch(
      capture, lamina::make_inversion_tables(capture, model), {.smoothness = {1.0}});
  return static_cast<double>(found.numbers[0].value.values[0]);
}

}  // namespace

int main() {
  const lamina::LayerStack skin =
      lamina::layer_stack(lamina::find_material("donner_jensen_skin"), 0);
  const double reflected = lamina::adding_doubling(skin, {}).totals.diffuse_reflectance;
  const lamina::DiffusionProfile profile = lamina::make_diffusion_profile({&skin, 1});
  const double near = profile.profile.reflectance_at(profile.profile.r.size() / 2, 0);
  const double melanin = melanin_found(0.06);
  // What is only linked: acquisition, edits, fits.
  const bool has_all = &lamina::acquire_skin && &lamina::edited_skin && &lamina::fit_measurement;
  std::printf("R %.3f, profile %.3g, melanin %.4f\n", reflected, near, melanin);
  return has_all && reflected > 0.1 && near > 0.0 && std::abs(melanin - 0.06) < 0.003 ? 0 : 1;
}
