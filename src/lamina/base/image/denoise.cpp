// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/denoise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"

namespace lamina {
namespace {

constexpr int band_height = 16;  ///< rows that one task does

/// One number per pixel.
struct Plane {
  int width = 0, height = 0;
  std::vector<float> values;

  Plane(int w, int h)
      : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  float* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
  const float* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

Plane channel_plane(const Image& image, std::size_t channel) {
  Plane plane(image.width, image.height);
  for (std::size_t i = 0; i < plane.values.size(); ++i)
    plane.values[i] = image.pixels[i * image.channel_count() + channel];
  return plane;
}

/// Averages over squares of half width `radius`, cut off at the borders.
Plane box_mean(const Plane& plane, int radius) {
  Plane mean(plane.width, plane.height);
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) {
      float sum = 0.0f;
      int count = 0;
      for (int v = std::max(y - radius, 0); v <= std::min(y + radius, plane.height - 1); ++v)
        for (int u = std::max(x - radius, 0); u <= std::min(x + radius, plane.width - 1);
             ++u, ++count)
          sum += plane.row(v)[u];
      mean.row(y)[x] = sum / static_cast<float>(count);
    }
  return mean;
}

/// A channel that tells surfaces apart, and how far it may differ on one and the same.
struct Feature {
  Plane values;
  Plane scale;  ///< [pixel], of its differences; to be squared
};

/// What differs along a slope is not another surface: the scale grows with the gradient.
Feature make_feature(const Image& image, std::size_t channel, float least, float per_gradient) {
  Feature feature{channel_plane(image, channel), Plane(image.width, image.height)};
  for (float& value : feature.values.values)
    if (!std::isfinite(value)) value = -1e6f;  // where nothing is
  const auto at = [&](int x, int y) {
    return feature.values.row(
        std::clamp(y, 0, image.height - 1))[std::clamp(x, 0, image.width - 1)];
  };
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto smaller = [](float a, float b) { return std::min(std::abs(a), std::abs(b)); };
      const float value = at(x, y);
      const float gradient = std::hypot(smaller(at(x + 1, y) - value, value - at(x - 1, y)),
                                        smaller(at(x, y + 1) - value, value - at(x, y - 1)));
      feature.scale.row(y)[x] = least + per_gradient * gradient;
    }
  return feature;
}

std::vector<Feature> find_features(const Image& image) {
  std::vector<Feature> features;
  const auto add = [&](const char* name, float least, float per_gradient) {
    if (const auto channel = channel_index(image, name))
      features.push_back(make_feature(image, *channel, least, per_gradient));
  };
  for (const char* name : {"albedo.R", "albedo.G", "albedo.B"}) add(name, 0.03f, 0.0f);
  for (const char* name : {"normal.X", "normal.Y", "normal.Z"}) add(name, 0.1f, 2.0f);
  add("depth.Z", 0.2f, 8.0f);
  return features;
}

/// Colors and their noise, as the filter takes them.
struct NoisyColors {
  std::array<Plane, 3> color;
  Plane luminance, variance;

  /// Makes luminance that of the colors.
  void find_luminance() {
    for (std::size_t i = 0; i < luminance.values.size(); ++i)
      luminance.values[i] = 0.2126f * color[0].values[i] + 0.7152f * color[1].values[i] +
                            0.0722f * color[2].values[i];
  }
};

/// A number of each of the eight pixels around one, fewer at a border, in rising order.
class Around {
 public:
  Around(const Plane& plane, int x, int y) {
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, plane.height - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, plane.width - 1); ++u)
        if (u != x || v != y) values_[count_++] = plane.row(v)[u];
    std::sort(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(count_));
  }
  [[nodiscard]] bool is_empty() const { return count_ == 0; }
  [[nodiscard]] float median() const { return values_[count_ / 2]; }
  /// Less than two of them: fireflies that touch do not hide each other.
  [[nodiscard]] float third_largest() const { return values_[count_ < 3 ? 0 : count_ - 3]; }

 private:
  std::array<float, 8> values_{};
  std::size_t count_ = 0;
};

/// Cuts fireflies to what is around them, in colors and in noise, before they are averaged: their
/// light would be spread over the window, where their noise makes all look alike.
///
/// A firefly stands out of its neighbours by no more than two of its own standard errors, though by
/// more than four of theirs: of n samples k alike give a standard error of 1 / sqrt(k) of their
/// mean, so that four samples at most make it. A small bright thing that all samples see stays. The
/// light that goes was right in the mean: pictures lose it where they are viewed only.
///
/// Fireflies are rare. Where more than one pixel in fifty stands out so, few samples find the light
/// itself, and all stay: a jade bust lit from behind by 16 samples of 97 % noise would lose two
/// thirds of its light.
void clamp_fireflies(NoisyColors& noisy) {
  constexpr int radius = 7;
  constexpr float most_in_window = 0.02f;
  const NoisyColors before = noisy;
  const int width = noisy.luminance.width, height = noisy.luminance.height;
  Plane stands_out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Around light(before.luminance, x, y);
      if (light.is_empty()) continue;
      const float excess = before.luminance.row(y)[x] - light.third_largest();
      const float square = excess * excess;
      if (excess > 0.0f && square < 4.0f * before.variance.row(y)[x] &&
          square > 16.0f * Around(before.variance, x, y).median())
        stands_out.row(y)[x] = 1.0f;
    }
  const Plane share = box_mean(stands_out, radius);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (stands_out.row(y)[x] == 0.0f || share.row(y)[x] > most_in_window) continue;
      for (std::size_t c = 0; c < 3; ++c)
        noisy.color[c].row(y)[x] =
            std::min(before.color[c].row(y)[x], Around(before.color[c], x, y).third_largest());
      noisy.variance.row(y)[x] = Around(before.variance, x, y).median();
    }
  noisy.find_luminance();
}

class Denoiser {
 public:
  Denoiser(const Image& render, const DenoiseOptions& options)
      : options_(options),
        noisy_{
            .color = {color_plane(render, "R"), color_plane(render, "G"), color_plane(render, "B")},
            .luminance = Plane(render.width, render.height),
            .variance = color_plane(render, "variance")},
        features_(find_features(render)),
        width_(render.width),
        height_(render.height) {
    noisy_.find_luminance();
    clamp_fireflies(noisy_);
    noisy_.variance = box_mean(noisy_.variance, 1);
  }

  /// Writes the rows [y0, y1) to the first three channels of `out` at `offset`.
  void filter(int y0, int y1, std::array<std::size_t, 3> channels, Image& out) const {
    const int rows = y1 - y0, margin = options_.patch;
    std::array<Plane, 3> sum{Plane(width_, rows), Plane(width_, rows), Plane(width_, rows)};
    Plane weights(width_, rows), difference(width_, rows + 2 * margin),
        patch_rows(width_, rows + 2 * margin);
    for (int dy = -options_.window; dy <= options_.window; ++dy)
      for (int dx = -options_.window; dx <= options_.window; ++dx) {
        find_differences(y0 - margin, dx, dy, difference);
        sum_rows(difference, patch_rows);
        for (int y = 0; y < rows; ++y) add_row(y0, y, dx, dy, patch_rows, sum, weights);
      }
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < width_; ++x)
        for (std::size_t c = 0; c < 3; ++c)
          out.at(x, y0 + y)[channels[c]] = sum[c].row(y)[x] / weights.row(y)[x];
  }

 private:
  static Plane color_plane(const Image& image, const char* name) {
    const auto channel = channel_index(image, name);
    if (!channel) throw InvalidInput(std::string("denoise: the image has no channel ") + name);
    return channel_plane(image, *channel);
  }

  int clamped_x(int x) const { return std::clamp(x, 0, width_ - 1); }
  int clamped_y(int y) const { return std::clamp(y, 0, height_ - 1); }

  /// Squared differences between pixels and those (dx, dy) away, less what noise makes of them and
  /// over their variance; rows from `top` on.
  void find_differences(int top, int dx, int dy, Plane& difference) const {
    const float k2 = static_cast<float>(options_.strength * options_.strength);
    for (int row = 0; row < difference.height; ++row) {
      const int y = clamped_y(top + row), there = clamped_y(top + row + dy);
      const float *a = noisy_.luminance.row(y), *b = noisy_.luminance.row(there),
                  *va = noisy_.variance.row(y), *vb = noisy_.variance.row(there);
      for (int x = 0; x < width_; ++x) {
        const int u = clamped_x(x + dx);
        const float apart = a[x] - b[u];
        difference.row(row)[x] =
            (apart * apart - (va[x] + std::min(va[x], vb[u]))) / (1e-12f + k2 * (va[x] + vb[u]));
      }
    }
  }

  /// Sums along rows, over the width of a patch.
  void sum_rows(const Plane& difference, Plane& sums) const {
    for (int y = 0; y < difference.height; ++y) {
      const float* in = difference.row(y);
      float* out = sums.row(y);
      double sum = 0.0;
      for (int x = -options_.patch - 1; x < options_.patch; ++x)
        sum += static_cast<double>(in[clamped_x(x)]);
      for (int x = 0; x < width_; ++x) {
        sum += static_cast<double>(in[clamped_x(x + options_.patch)]);
        sum -= static_cast<double>(in[clamped_x(x - options_.patch - 1)]);
        out[x] = static_cast<float>(sum);
      }
    }
  }

  void add_row(int y0, int y, int dx, int dy, const Plane& patch_rows, std::array<Plane, 3>& sum,
               Plane& weights) const {
    const int there = y0 + y + dy;
    if (there < 0 || there >= height_) return;
    const int side = 2 * options_.patch + 1;
    const float per_area = 1.0f / static_cast<float>(side * side);
    for (int x = std::max(0, -dx); x < std::min(width_, width_ - dx); ++x) {
      float difference = 0.0f;
      for (int v = 0; v < side; ++v) difference += patch_rows.row(y + v)[x];
      float exponent = std::max(0.0f, difference * per_area);
      for (const Feature& feature : features_) {
        const float apart = (feature.values.row(y0 + y)[x] - feature.values.row(there)[x + dx]) /
                            feature.scale.row(y0 + y)[x];
        exponent = std::max(exponent, apart * apart);
      }
      const float weight = exponent < 30.0f ? std::exp(-exponent) : 0.0f;
      weights.row(y)[x] += weight;
      for (std::size_t c = 0; c < 3; ++c)
        sum[c].row(y)[x] += weight * noisy_.color[c].row(there)[x + dx];
    }
  }

  const DenoiseOptions& options_;
  NoisyColors noisy_;
  std::vector<Feature> features_;
  int width_, height_;
};

}  // namespace

Image denoise(const Image& render, const DenoiseOptions& options) {
  const Denoiser denoiser(render, options);
  std::vector<std::string> names = render.channels;
  for (const char* name : {"noisy.R", "noisy.G", "noisy.B"}) names.emplace_back(name);
  Image out = make_image(render.width, render.height, names);
  std::array<std::size_t, 3> color{};
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = *channel_index(render, std::array{"R", "G", "B"}[c]);
  for (int y = 0; y < render.height; ++y)
    for (int x = 0; x < render.width; ++x) {
      float* pixel = std::copy_n(render.at(x, y), render.channel_count(), out.at(x, y));
      for (const std::size_t channel : color) *pixel++ = render.at(x, y)[channel];
    }
  const int bands = (render.height + band_height - 1) / band_height;
  parallel_for(static_cast<std::size_t>(bands), [&](std::size_t band) {
    const int y0 = static_cast<int>(band) * band_height;
    denoiser.filter(y0, std::min(y0 + band_height, render.height), color, out);
  });
  return out;
}

}  // namespace lamina
