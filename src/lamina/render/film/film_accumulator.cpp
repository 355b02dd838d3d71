// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/film/film_accumulator.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "lamina/base/core/vec.h"

namespace lamina {
namespace {

/// As luminance() in color.h; linear but for the rounding of doubles, so that the luminance of a
/// sum is the sum of luminances.
double exact_luminance(const Vec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

/// Of the mean of a pixel, if its samples were independent.
double variance_of_mean(const FilmPixel& pixel) {
  if (pixel.samples < 2) return 0.0;
  const double n = static_cast<double>(pixel.samples), sum = exact_luminance(pixel.beauty.value());
  const double squares = pixel.luminance_square.value();
  const double spread = squares - sum * sum / n;  // about the mean
  const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * squares;
  return spread > rounding ? spread / (n * (n - 1.0)) : 0.0;
}

}  // namespace

FilmAccumulator::FilmAccumulator(int width, int height)
    : width_(width),
      height_(height),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

void FilmAccumulator::add(int x, int y, const CameraSample& sample) {
  FilmPixel& pixel = pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                             static_cast<std::size_t>(x)];
  pixel.beauty.add(sample.beauty);
  pixel.subsurface.add(sample.subsurface);
  pixel.specular.add(sample.specular);
  ++pixel.samples;
  const double value = exact_luminance(to_double(sample.beauty));
  pixel.luminance_square.add(value * value);
  if (!sample.is_hit) return;
  ++pixel.hits;
  pixel.subsurface_hits += sample.is_subsurface;
  pixel.normal.add(sample.normal);
  pixel.albedo.add(sample.albedo);
  pixel.depth.add(static_cast<double>(sample.depth));
}

FilmAccumulator::Luminance FilmAccumulator::luminance_of(int x0, int y0, int x1, int y1) const {
  Luminance sum;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const FilmPixel& pixel =
          pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                  static_cast<std::size_t>(x)];
      if (pixel.samples > 0)
        sum.mean += exact_luminance(pixel.beauty.value()) / static_cast<double>(pixel.samples);
      sum.variance += variance_of_mean(pixel);
    }
  const double count = static_cast<double>(x1 - x0) * static_cast<double>(y1 - y0);
  return {sum.mean / count, sum.variance / count};
}

Image FilmAccumulator::image(bool has_alpha) const {
  std::vector<std::string> channels = {
      "R",          "G",          "B",          "subsurface.R", "subsurface.G", "subsurface.B",
      "specular.R", "specular.G", "specular.B", "albedo.R",     "albedo.G",     "albedo.B",
      "normal.X",   "normal.Y",   "normal.Z",   "depth.Z",      "samples",      "variance"};
  if (has_alpha) channels.emplace_back("A");
  Image image = make_image(width_, height_, std::move(channels));
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const FilmPixel& pixel = pixels_[i];
    float* out = image.pixels.data() + i * image.channel_count();
    const double n = static_cast<double>(std::max<std::int64_t>(pixel.samples, 1));
    const Vec3 normal = pixel.normal.value();
    const double normal_length = length(normal);
    for (const Vec3& value :
         {pixel.beauty.value() / n, pixel.subsurface.value() / n, pixel.specular.value() / n,
          pixel.albedo.value() / n, normal_length > 0.0 ? normal / normal_length : Vec3{}}) {
      *out++ = static_cast<float>(value.x);
      *out++ = static_cast<float>(value.y);
      *out++ = static_cast<float>(value.z);
    }
    *out++ = pixel.hits > 0 ? static_cast<float>(pixel.depth.value() / pixel.hits)
                            : std::numeric_limits<float>::infinity();
    *out++ = static_cast<float>(pixel.samples);
    *out++ = static_cast<float>(variance_of_mean(pixel));
    if (has_alpha) *out++ = static_cast<float>(pixel.hits / n);
  }
  return image;
}

std::vector<PixelCover> FilmAccumulator::covers() const {
  std::vector<PixelCover> covers;
  covers.reserve(pixels_.size());
  for (const FilmPixel& pixel : pixels_)
    covers.push_back(pixel.samples == 0                       ? PixelCover::mixed
                     : pixel.subsurface_hits == pixel.samples ? PixelCover::translucent_surface
                     : pixel.hits == pixel.samples            ? PixelCover::surface
                                                              : PixelCover::mixed);
  return covers;
}

std::vector<bool> measured_pixels(std::span<const PixelCover> covers) {
  const bool has_translucent =
      std::ranges::find(covers, PixelCover::translucent_surface) != covers.end();
  std::vector<bool> is_measured;
  is_measured.reserve(covers.size());
  for (const PixelCover cover : covers)
    is_measured.push_back(cover == PixelCover::translucent_surface ||
                          (!has_translucent && cover == PixelCover::surface));
  return is_measured;
}

double FilmAccumulator::mean_samples() const {
  double total = 0.0;
  for (const FilmPixel& pixel : pixels_) total += static_cast<double>(pixel.samples);
  return total / static_cast<double>(pixels_.size());
}

int FilmAccumulator::least_samples() const {
  return static_cast<int>(std::ranges::min(pixels_, {}, &FilmPixel::samples).samples);
}

}  // namespace lamina
