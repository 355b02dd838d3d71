// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// Why no albedo texture can stand for freckles [Donner2008, Figure 3]. Above fully lit skin, below
// the same under strips of light: uniform skin, freckled skin, and uniform skin times the texture
// that makes the upper pictures alike.   04_heterogeneous_skin [IMAGE.png [SIDE]]
#include <algorithm>
#include <string>

#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/skin/maps/skin_features.h"
#include "lamina/skin/patch/skin_patch.h"

namespace {

using namespace lamina;

Image rendered(const SkinPatch& patch) {
  return rgb_image(render_skin_patch(patch, user_cache()).image);
}

/// Strips of brighter light, two thirds dark.
SkinPatch in_strips(SkinPatch patch) {
  for (int y = 0; y < patch.height; ++y)
    for (int x = 0; x < patch.width; ++x)
      *patch.light.at(x, y) = (x + y / 3) % (patch.width / 4) > patch.width / 12 ? 0.0f : 2.0f;
  return patch;
}

void put(Image& sheet, const Image& picture, int column, int row) {
  for (int y = 0; y < picture.height; ++y)
    std::copy_n(picture.at(0, y), 3 * picture.width,
                sheet.at(column * (picture.width + 8), row * (picture.height + 8) + y));
}

}  // namespace

int main(int argc, char** argv) {
  const int side = argc > 2 ? std::stoi(argv[2]) : 256;
  SkinMapRecipe recipe;
  recipe.width = recipe.height = side;
  recipe.mm_per_texel = 12.8 / side;
  recipe.seed = 7;
  recipe.base.skin.melanin = 0.01;
  recipe.features = {Unevenness{}, Veins{.count = 1}, MelaninSpots{.density = 14}};

  SkinPatch freckled;
  freckled.width = freckled.height = side;
  freckled.mm_per_texel = recipe.mm_per_texel;
  freckled.skin.skin = recipe.base.skin;
  freckled.skin.maps = make_skin_maps(recipe);
  freckled.light = make_image(side, side, {"Y"});
  std::ranges::fill(freckled.light.pixels, 1.0f);
  SkinPatch uniform = freckled;
  uniform.skin.maps.clear();
  for (const SkinMap& map : freckled.skin.maps) {  // the mean of each map
    double sum = 0.0;
    for (const float value : map.values.pixels) sum += static_cast<double>(value);
    uniform.skin.skin.*map.parameter = sum / static_cast<double>(map.values.pixels.size());
  }

  Image sheet = make_image(3 * side + 16, 2 * side + 8, {"R", "G", "B"});
  std::ranges::fill(sheet.pixels, 1.0f);
  const Image flat = rendered(uniform), spotted = rendered(freckled);
  const Image flat_strips = rendered(in_strips(uniform));
  Image textured = flat_strips;
  for (std::size_t i = 0; i < textured.pixels.size(); ++i)
    textured.pixels[i] *= spotted.pixels[i] / flat.pixels[i];
  put(sheet, flat, 0, 0);
  put(sheet, spotted, 1, 0);
  put(sheet, spotted, 2, 0);
  put(sheet, flat_strips, 0, 1);
  put(sheet, rendered(in_strips(freckled)), 1, 1);
  put(sheet, textured, 2, 1);
  save_png(sheet, argc > 1 ? argv[1] : "heterogeneous_skin.png");
}
