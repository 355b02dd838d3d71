// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints a table of docs/heterogeneous_skin.md: freckled and veined skin by the eight default
// wavelengths against 151, of Fitzpatrick I to VI.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "lamina/base/io/json_input.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/layers/materials/material.h"
#include "lamina/skin/maps/files/skin_features_file.h"
#include "lamina/skin/maps/files/skin_maps_file.h"
#include "lamina/skin/maps/skin_features.h"
#include "lamina/skin/patch/skin_patch.h"

namespace {

using namespace lamina;

SkinParameters built_in(const std::string& name) {
  const JsonDocument document = parse_json(builtin_material_text(name), name);
  return decode_skin_maps(*document.root().peek("skin")).skin;
}

/// The maps of examples/skin/freckles.json on another skin, at a fourth of their resolution.
SkinPatch freckled(const SkinParameters& skin, const BandSet& bands) {
  SkinMapRecipe recipe = load_skin_map_recipe(std::filesystem::path(LAMINA_SOURCE_DIR) /
                                              "examples/skin/freckles.json");
  recipe.width = recipe.height = 128;
  recipe.mm_per_texel = 0.2;
  recipe.base.skin = skin;
  SkinPatch patch;
  patch.width = patch.height = recipe.width;
  patch.mm_per_texel = recipe.mm_per_texel;
  patch.bands = bands;
  patch.skin = recipe.base;
  patch.skin.maps = make_skin_maps(recipe);
  patch.light = make_image(patch.width, patch.height, {"Y"});
  std::ranges::fill(patch.light.pixels, 1.0f);
  return patch;
}

std::vector<LinearSrgb> colors(const Image& image) {
  const std::size_t first = *channel_index(image, "R");
  std::vector<LinearSrgb> result;
  for (std::size_t i = 0; i < image.pixels.size(); i += image.channel_count())
    result.push_back(
        {image.pixels[i + first], image.pixels[i + first + 1], image.pixels[i + first + 2]});
  return result;
}

/// The same bands with weights that know nothing of skin.
std::vector<LinearSrgb> plain_colors(const Image& image, const BandSet& bands) {
  const BandWeights weights = make_band_weights(bands);
  std::vector<LinearSrgb> result;
  for (std::size_t i = 0; i < image.pixels.size(); i += image.channel_count())
    result.push_back(linear_srgb(
        weights,
        std::vector<double>(image.pixels.begin() + static_cast<std::ptrdiff_t>(i),
                            image.pixels.begin() + static_cast<std::ptrdiff_t>(i + bands.size()))));
  return result;
}

struct Difference {
  std::array<double, 3> rms;   ///< of a channel, over its mean
  double largest;              ///< of any pixel and channel, over that pixel's value
  double within;               ///< share of the pixels that differ by 1 % at most in all channels
  double mean_de, largest_de;  ///< CIEDE2000
};

Difference difference(const std::vector<LinearSrgb>& seen, const std::vector<LinearSrgb>& wanted) {
  Difference result{};
  std::array<double, 3> sum{};
  const auto count = static_cast<double>(wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    double worst = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double error = seen[i][c] - wanted[i][c];
      result.rms[c] += error * error / count;
      sum[c] += wanted[i][c] / count;
      worst = std::max(worst, std::abs(error) / wanted[i][c]);
    }
    result.largest = std::max(result.largest, worst);
    if (worst <= 0.01) result.within += 1.0 / count;
    const double de = color_difference(lab(seen[i]), lab(wanted[i]));
    result.mean_de += de / count;
    result.largest_de = std::max(result.largest_de, de);
  }
  for (std::size_t c = 0; c < 3; ++c) result.rms[c] = std::sqrt(result.rms[c]) / sum[c];
  return result;
}

}  // namespace

int main() {
  std::vector<double> fine;
  for (int nm = 400; nm <= 700; nm += 2) fine.push_back(nm);
  std::printf(
      "| skin | red | green | blue | pixels within 1 %% | worst | ΔE00, mean | largest | green, "
      "weights for any "
      "color |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string name :
       {"skin_type_1", "skin_type_2", "skin_type_3", "skin_type_4", "skin_type_5", "skin_type_6"}) {
    const SkinParameters skin = built_in(name);
    const auto wanted = colors(render_skin_patch(freckled(skin, BandSet(fine))).image);
    const SkinPatch few = freckled(skin, default_spectral_bands());
    const Image image = render_skin_patch(few).image;
    const Difference ours = difference(colors(image), wanted);
    const Difference plain = difference(plain_colors(image, few.bands), wanted);
    std::printf(
        "| `%s` | %.2f %% | %.2f %% | %.2f %% | %.1f %% | %.1f %% | %.2f | %.2f | %.1f %% |\n",
        name.c_str(), 100.0 * ours.rms[0], 100.0 * ours.rms[1], 100.0 * ours.rms[2],
        100.0 * ours.within, 100.0 * ours.largest, ours.mean_de, ours.largest_de,
        100.0 * plain.rms[1]);
    std::fflush(stdout);
  }
}
