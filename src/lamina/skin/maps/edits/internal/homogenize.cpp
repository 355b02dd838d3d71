// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/internal/homogenize.h"

#include <algorithm>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel_chunks.h"
#include "lamina/skin/maps/edits/internal/pigment_statistics.h"

namespace lamina::skin_edits {
namespace {

/// The pigments of a skin as coordinates on one grid, that of the largest map.
struct Pigments {
  std::vector<SkinNumber> numbers;
  std::vector<std::vector<float>> coordinates;  ///< [number][texel], or of one texel
  int width = 1, height = 1;
};

Pigments pigments_of(const SkinMaps& skin, int least_width, int least_height) {
  Pigments result{.numbers = {}, .coordinates = {}, .width = least_width, .height = least_height};
  std::vector<Image> images;
  for (const char* name : pigments) {
    result.numbers.push_back(find_number(skin, name));
    images.push_back(values_of(skin, result.numbers.back()));
    if (images.back().width <= result.width) continue;
    result.width = images.back().width;
    result.height = images.back().height;
  }
  for (std::size_t k = 0; k < images.size(); ++k) {
    if (images[k].pixels.size() > 1) images[k] = in_size(images[k], result.width, result.height);
    result.coordinates.push_back(coordinates_of(result.numbers[k], images[k]).pixels);
  }
  return result;
}

}  // namespace

void homogenize(Course& course) {
  const Image* grid = first_map(course.skin());
  if (!grid) grid = course.has_mask() ? &course.edit.mask : nullptr;
  const Pigments own = pigments_of(course.skin(), grid ? grid->width : 1, grid ? grid->height : 1);
  const Pigments other = pigments_of(course.edit.reference.skin, 1, 1);
  // The strength is how far the edit goes, not what it looks at.
  const std::vector<float> area = area_of(course, own.width, own.height);
  const Image& skin_of_other = course.edit.reference.mask;
  const std::vector<float> other_area =
      skin_of_other.pixels.empty() || other.width == 1
          ? std::vector<float>()
          : in_size(skin_of_other, other.width, other.height).pixels;
  const auto is_empty = [](const std::vector<float>& weights) {
    return !weights.empty() && std::ranges::all_of(weights, [](float w) { return w <= 0.0f; });
  };
  if (is_empty(area)) return;
  if (is_empty(other_area)) throw InvalidInput("the other maps have no skin in their mask");
  const auto from = statistics_of(own.coordinates, area);
  const auto to = statistics_of(other.coordinates, other_area);
  if (from.mean == to.mean && from.covariance.values == to.covariance.values) return;
  const DenseMatrix transport = transport_between(from.covariance, to.covariance);
  const std::size_t n = own.numbers.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::vector<float>& mine = own.coordinates[k];
    const bool is_number = mine.size() == 1;
    Image wanted = make_image(is_number ? 1 : own.width, is_number ? 1 : own.height, {"Y"});
    parallel_chunks(mine.size(), chunk, [&](std::size_t i) {
      double sum = to.mean[k];
      for (std::size_t j = 0; j < n && !is_number; ++j) {
        const std::vector<float>& each = own.coordinates[j];
        sum +=
            transport(k, j) * (static_cast<double>(each[each.size() == 1 ? 0 : i]) - from.mean[j]);
      }
      wanted.pixels[i] = static_cast<float>(sum);
    });
    const Image before = values_of(course.skin(), own.numbers[k]);
    put_coordinates(course, own.numbers[k], on_the_grid(course, before),
                    on_the_grid(course, std::move(wanted)));
  }
}

}  // namespace lamina::skin_edits
