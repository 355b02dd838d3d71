// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/film/film_accumulator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "lamina/spectrum/color.h"

namespace lamina {

FilmAccumulator::FilmAccumulator(int width, int height)
    : width_(width),
      height_(height),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

void FilmAccumulator::add(int x, int y, const CameraSample& sample) {
  Pixel& pixel = pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                         static_cast<std::size_t>(x)];
  pixel.beauty += sample.beauty;
  pixel.subsurface += sample.subsurface;
  pixel.specular += sample.specular;
  ++pixel.samples;
  const float value = luminance(sample.beauty), from_mean = value - pixel.luminance_mean;
  pixel.luminance_mean += from_mean / static_cast<float>(pixel.samples);
  pixel.luminance_spread += from_mean * (value - pixel.luminance_mean);
  if (!sample.is_hit) return;
  ++pixel.hits;
  pixel.subsurface_hits += sample.is_subsurface;
  pixel.normal += sample.normal;
  pixel.albedo += sample.albedo;
  pixel.depth += sample.depth;
}

float FilmAccumulator::variance_of_mean(const Pixel& pixel) {
  const float n = static_cast<float>(pixel.samples);
  return pixel.samples > 1 ? pixel.luminance_spread / (n * (n - 1.0f)) : 0.0f;
}

FilmAccumulator::Luminance FilmAccumulator::luminance_of(int x0, int y0, int x1, int y1) const {
  Luminance sum;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const Pixel& pixel = pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                   static_cast<std::size_t>(x)];
      sum.mean += static_cast<double>(pixel.luminance_mean);
      sum.variance += static_cast<double>(variance_of_mean(pixel));
    }
  const double count = static_cast<double>(x1 - x0) * static_cast<double>(y1 - y0);
  return {sum.mean / count, sum.variance / count};
}

void FilmAccumulator::restore(std::span<const std::byte> bytes) {
  static_assert(std::is_trivially_copyable_v<Pixel>);
  assert(bytes.size() == pixels_.size() * sizeof(Pixel));
  std::memcpy(pixels_.data(), bytes.data(), bytes.size());
}

Image FilmAccumulator::image() const {
  Image image =
      make_image(width_, height_,
                 {"R", "G", "B", "subsurface.R", "subsurface.G", "subsurface.B", "specular.R",
                  "specular.G", "specular.B", "albedo.R", "albedo.G", "albedo.B", "normal.X",
                  "normal.Y", "normal.Z", "depth.Z", "samples", "variance"});
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const Pixel& pixel = pixels_[i];
    float* out = image.pixels.data() + i * image.channel_count();
    const float n = static_cast<float>(std::max(pixel.samples, 1));
    const float hits = static_cast<float>(pixel.hits);
    const float normal_length = length(pixel.normal);
    for (const Vec3f& value :
         {pixel.beauty / n, pixel.subsurface / n, pixel.specular / n, pixel.albedo / n,
          normal_length > 0.0f ? pixel.normal / normal_length : Vec3f{}}) {
      *out++ = value.x;
      *out++ = value.y;
      *out++ = value.z;
    }
    *out++ = pixel.hits > 0 ? pixel.depth / hits : std::numeric_limits<float>::infinity();
    *out++ = static_cast<float>(pixel.samples);
    *out++ = variance_of_mean(pixel);
  }
  return image;
}

std::vector<bool> FilmAccumulator::measured_pixels() const {
  std::vector<bool> is_subsurface, is_surface;
  for (const Pixel& pixel : pixels_) {
    is_subsurface.push_back(pixel.samples > 0 && pixel.subsurface_hits == pixel.samples);
    is_surface.push_back(pixel.samples > 0 && pixel.hits == pixel.samples);
  }
  const bool has_subsurface = std::ranges::find(is_subsurface, true) != is_subsurface.end();
  return has_subsurface ? is_subsurface : is_surface;
}

double FilmAccumulator::mean_samples() const {
  double total = 0.0;
  for (const Pixel& pixel : pixels_) total += pixel.samples;
  return total / static_cast<double>(pixels_.size());
}

int FilmAccumulator::least_samples() const {
  return std::ranges::min(pixels_, {}, &Pixel::samples).samples;
}

}  // namespace lamina
