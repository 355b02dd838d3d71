// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/skin_preview.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "lamina/base/image/resample.h"
#include "lamina/skin/patch/skin_patch.h"

namespace lamina {
namespace {

constexpr int side_of_numbers = 32;     // of a skin without maps [texel]
constexpr double far_apart_mm = 100.0;  // texels between which no light goes

Image fitted(const Image& image, int width, int height) {
  if (image.width == width && image.height == height) return image;
  return resampled(image, width, height);
}

}  // namespace

Image skin_preview(const EditableSkin& skin, int longest_side,
                   const std::optional<DiskCache>& cache, const Progress& progress) {
  SkinPatch patch;
  patch.skin = skin.skin;
  const Image* map = first_map(skin.skin);
  const int width = map ? map->width : side_of_numbers, height = map ? map->height : width;
  const double scale = std::min(1.0, static_cast<double>(longest_side) / std::max(width, height));
  patch.width = std::max(1, static_cast<int>(std::lround(scale * width)));
  patch.height = std::max(1, static_cast<int>(std::lround(scale * height)));
  patch.mm_per_texel = skin.width_mm > 0.0 ? skin.width_mm / patch.width : far_apart_mm;
  for (SkinMap& each : patch.skin.maps) {
    // Maps by band are for the bands of the file; here their mean has to do.
    const std::size_t channels = each.values.channel_count();
    if (channels > 1) {
      Image mean = make_image(each.values.width, each.values.height, {"Y"});
      for (std::size_t i = 0; i < each.values.pixels.size(); ++i)
        mean.pixels[i / channels] += each.values.pixels[i] / static_cast<float>(channels);
      each.values = std::move(mean);
    }
    each.values = fitted(each.values, patch.width, patch.height);
  }
  patch.skin.others.clear();
  patch.light = make_image(patch.width, patch.height, {"Y"});
  std::ranges::fill(patch.light.pixels, 1.0f);
  patch.totals = are_for_transfer_totals(skin.skin.constants) ? OperatorTotals::radiative_transfer
                                                              : OperatorTotals::diffusion;
  return rgb_image(render_skin_patch(patch, cache, progress).image);
}

Lab mean_lab(const Image& picture, const Image& mask) {
  const Image weights = mask.pixels.empty() ? Image{} : fitted(mask, picture.width, picture.height);
  LinearSrgb sum{};
  double all = 0.0;
  for (std::size_t i = 0; i < picture.pixels.size(); i += 3) {
    const double weight = weights.pixels.empty() ? 1.0 : static_cast<double>(weights.pixels[i / 3]);
    all += weight;
    for (std::size_t c = 0; c < 3; ++c)
      sum[c] += weight * static_cast<double>(picture.pixels[i + c]);
  }
  for (double& channel : sum) channel /= std::max(all, 1e-9);
  return lab(sum);
}

double typology_angle(const Lab& color) {
  return std::atan2(color.lightness - 50.0, color.b) * 180.0 / std::numbers::pi;
}

Image side_by_side(const Image& first, const Image& second) {
  assert(first.channels == second.channels);
  const Image left = fitted(first, second.width, second.height);
  Image both = make_image(left.width + second.width, left.height, left.channels);
  for (int y = 0; y < left.height; ++y) {
    std::copy_n(left.at(0, y), static_cast<std::size_t>(left.width) * left.channel_count(),
                both.at(0, y));
    std::copy_n(second.at(0, y), static_cast<std::size_t>(second.width) * second.channel_count(),
                both.at(left.width, y));
  }
  return both;
}

}  // namespace lamina
