// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints a table of docs/heterogeneous_skin.md: how far few bounces of light that goes to and fro
// are from many, on freckled and veined skin.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "lamina/skin/maps/files/skin_features_file.h"
#include "lamina/skin/maps/skin_features.h"
#include "lamina/skin/patch/skin_patch.h"

namespace {

using namespace lamina;

/// Root mean square over the mean.
double difference(const Plane& a, const Plane& b) {
  double square = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    const double d = static_cast<double>(a.values[i]) - static_cast<double>(b.values[i]);
    square += d * d;
    sum += static_cast<double>(b.values[i]);
  }
  const double size = static_cast<double>(a.values.size());
  return std::sqrt(square / size) / (sum / size);
}

}  // namespace

int main() {
  const SkinMapRecipe recipe = load_skin_map_recipe(std::filesystem::path(LAMINA_SOURCE_DIR) /
                                                    "examples/skin/freckles.json");
  SkinPatch patch;
  patch.width = recipe.width, patch.height = recipe.height;
  patch.skin = recipe.base;
  patch.skin.maps = make_skin_maps(recipe);
  const PatchMaterial made_of = material_of(patch);
  const Plane light = make_plane(recipe.width, recipe.height, 1.0f);
  std::printf("| nm | 1 bounce | 2 bounces | 3 bounces | 4 bounces |\n|---|---|---|---|---|\n");
  for (std::size_t b = 0; b < patch.bands.size(); ++b) {
    const double wavelength = patch.bands.wavelengths()[b];
    const BandTexels texels = band_texels(made_of.material, made_of.maps, light.values.size(), b);
    const StackTables tables =
        make_stack_tables(mapped_stack(made_of.material, b, texels),
                          OperatorTotals::radiative_transfer, reference_absorptions(texels));
    const HeterogeneousLayers layers = make_heterogeneous_layers(
        tables, recipe.width, recipe.height, texels.layers,
        {make_plane(recipe.width, recipe.height, texels.absorbance[0][0])}, recipe.mm_per_texel);
    const Plane many = transport(layers, light, {.interlayer_bounces = 7}).reflected;
    std::printf("| %.0f |", wavelength);
    for (const int bounces : {1, 2, 3, 4})
      std::printf(
          " %.2f %% |",
          100.0 * difference(transport(layers, light, {.interlayer_bounces = bounces}).reflected,
                             many));
    std::printf("\n");
  }
}
