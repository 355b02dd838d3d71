// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/map_example.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "lamina/base/core/random.h"
#include "lamina/base/core/smooth_step.h"
#include "lamina/base/image/blur.h"

namespace lamina {
namespace {

constexpr double fine_transition = 0.1;  // from tile to tile, in tiles
constexpr double coarse_detail = 0.3;    // spread of the blur that parts the bands, in tiles

double normal_share_below(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

/// The deviates of which shares of (i + 1/2) / count of a normal distribution lie below.
std::vector<float> normal_deviates(std::size_t count) {
  std::vector<float> result(count);
  // Newton's method from the middle down, each from the one before; above it they mirror.
  double z = 0.0;
  for (std::size_t i = count / 2; i-- > 0;) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    for (int step = 0; step < 6; ++step) {
      const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
      const double change = (normal_share_below(z) - share) / density;
      z -= change;
      if (std::abs(change) < 1e-7) break;
    }
    result[i] = static_cast<float>(z);
    result[count - 1 - i] = static_cast<float>(-z);
  }
  return result;
}

/// The value of which a share of all values lies below.
double value_at(std::span<const float> sorted, double share) {
  const double place = std::clamp(share * static_cast<double>(sorted.size()) - 0.5, 0.0,
                                  static_cast<double>(sorted.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(place), sorted.size() - 2);
  const double t = place - static_cast<double>(i);
  return (1.0 - t) * static_cast<double>(sorted[i]) + t * static_cast<double>(sorted[i + 1]);
}

std::vector<float> ascending(std::vector<float> values) {
  std::ranges::sort(values);
  return values;
}

/// Normal deviates of the ranks of values. Of equal values those are lower that lie among lower
/// ones, so that the deviates of a plain region are smooth.
std::vector<float> deviates(const std::vector<float>& values, int width, int height,
                            double spread) {
  const std::vector<float> around = blurred(values, width, height, spread);
  std::vector<std::uint32_t> order(values.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    if (values[a] != values[b]) return values[a] < values[b];
    return around[a] != around[b] ? around[a] < around[b] : a < b;
  });
  const std::vector<float> normal = normal_deviates(values.size());
  std::vector<float> result(values.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) result[order[rank]] = normal[rank];
  return result;
}

/// The mean of each two by two texels.
Image halved(const Image& image) {
  Image half = make_image(image.width / 2, image.height / 2, image.channels);
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x)
      *half.at(x, y) = 0.25f * (*image.at(2 * x, 2 * y) + *image.at(2 * x + 1, 2 * y) +
                                *image.at(2 * x, 2 * y + 1) + *image.at(2 * x + 1, 2 * y + 1));
  return half;
}

}  // namespace

MapExample::MapExample(std::vector<SkinMap> maps, double mm_per_texel, double tile)
    : maps_(std::move(maps)), tile_(tile) {
  const int width = maps_.front().values.width, height = maps_.front().values.height;
  assert(std::min(width, height) >= least_side && maps_.size() <= most_maps);
  int levels = 1;
  while (levels < 4 && std::min(width, height) >> levels >= least_side) ++levels;
  std::vector<Image> values;
  for (SkinMap& map : maps_) {
    const std::vector<float>& pixels = map.values.pixels;
    means_.push_back(std::accumulate(pixels.begin(), pixels.end(), 0.0) /
                     static_cast<double>(pixels.size()));
    values.push_back(std::move(map.values));
  }
  for (double mm = mm_per_texel; levels > 0; --levels, mm *= 2.0) {
    levels_.push_back(make_level(values, mm));
    for (Image& image : values) image = halved(image);
  }
}

MapExample::Level MapExample::make_level(const std::vector<Image>& values, double mm) const {
  Level level{.width = values.front().width, .height = values.front().height, .mm = mm};
  const std::size_t maps = values.size(), texels = values.front().pixels.size();
  level.fine.resize(maps * texels);
  level.coarse.resize(maps * texels);
  for (std::size_t m = 0; m < maps; ++m) {
    const double spread = coarse_detail * tile_ / mm;
    const std::vector<float> all = deviates(values[m].pixels, level.width, level.height, spread);
    const std::vector<float> coarse = blurred(all, level.width, level.height, spread);
    double shared = 0.0;
    for (std::size_t i = 0; i < texels; ++i) {
      level.coarse[i * maps + m] = coarse[i];
      level.fine[i * maps + m] = all[i] - coarse[i];
      shared += static_cast<double>(coarse[i] * (all[i] - coarse[i]));
    }
    level.shared.push_back(shared / static_cast<double>(texels));
    level.sorted.push_back(ascending(values[m].pixels));
  }
  return level;
}

MapExample::Shift MapExample::shift_of(std::uint64_t seed, std::uint64_t tile) const {
  Random random = make_random(seed, tile);
  const Level& level = levels_.front();
  // Well away from the edges, so that mirror images seldom show.
  const auto within = [&](int side) {
    const double length = side * level.mm, edge = std::min(0.4 * tile_, 0.25 * length);
    return edge + random.uniform() * (length - 2.0 * edge);
  };
  const Vec2 middle = {within(level.width), within(level.height)};
  const double turn = 2.0 * std::numbers::pi * random.uniform();
  return {middle, std::cos(turn), std::sin(turn), random.uniform() < 0.5};
}

Vec2 MapExample::place_of(const Shift& shift, const Vec2& offset) {
  const double x = shift.is_mirrored ? -offset.x : offset.x;
  return shift.middle +
         Vec2{shift.cos * x - shift.sin * offset.y, shift.sin * x + shift.cos * offset.y};
}

void MapExample::values_at(std::span<const Tile> tiles, double width,
                           std::span<double> values) const {
  const double place = std::clamp(std::log2(std::max(width, 1e-9) / levels_.front().mm), 0.0,
                                  static_cast<double>(levels_.size() - 1));
  const auto finer = static_cast<std::size_t>(place);
  level_values(levels_[finer], tiles, values);
  const double part = place - static_cast<double>(finer);
  if (!(part > 0.0)) return;
  std::array<double, most_maps> store;
  const std::span<double> coarser(store.data(), values.size());
  level_values(levels_[finer + 1], tiles, coarser);
  for (std::size_t m = 0; m < values.size(); ++m) values[m] += part * (coarser[m] - values[m]);
}

void MapExample::level_values(const Level& level, std::span<const Tile> tiles,
                              std::span<double> values) const {
  const std::size_t maps = values.size();
  double nearest = tiles.front().distance;
  for (const Tile& tile : tiles) nearest = std::min(nearest, tile.distance);
  std::array<double, most_maps> fine{}, coarse{};
  double fine2 = 0.0, coarse2 = 0.0, both = 0.0;  // sums of products of weights
  for (const Tile& tile : tiles) {
    const double further = (tile.distance - nearest) / tile_;
    const double coarse_weight = smooth_step(1.0 - further);
    const double fine_weight = smooth_step(1.0 - further / fine_transition);
    if (!(coarse_weight > 0.0)) continue;
    fine2 += fine_weight * fine_weight;
    coarse2 += coarse_weight * coarse_weight;
    both += fine_weight * coarse_weight;
    // Between the four texels around the place.
    const double x = tile.place.x / level.mm - 0.5, y = tile.place.y / level.mm - 0.5;
    const double left = std::floor(x), top = std::floor(y);
    for (int corner = 0; corner < 4; ++corner) {
      const int i = corner & 1, j = corner >> 1;
      const double share = (i ? x - left : 1.0 - (x - left)) * (j ? y - top : 1.0 - (y - top));
      const std::size_t texel = maps * (mirrored_index(static_cast<int>(top) + j, level.height) *
                                            static_cast<std::size_t>(level.width) +
                                        mirrored_index(static_cast<int>(left) + i, level.width));
      for (std::size_t m = 0; m < maps; ++m) {
        coarse[m] += share * coarse_weight * static_cast<double>(level.coarse[texel + m]);
        fine[m] += share * fine_weight * static_cast<double>(level.fine[texel + m]);
      }
    }
  }
  const double fine_length = std::sqrt(fine2), coarse_length = std::sqrt(coarse2);
  const double alike = both / (fine_length * coarse_length);
  for (std::size_t m = 0; m < maps; ++m) {
    // Where the bands are of different tiles in part, they share less.
    const double variance = 1.0 - 2.0 * level.shared[m] * (1.0 - alike);
    const double sum = (fine[m] / fine_length + coarse[m] / coarse_length) / std::sqrt(variance);
    values[m] = value_at(level.sorted[m], normal_share_below(sum));
  }
}

}  // namespace lamina
