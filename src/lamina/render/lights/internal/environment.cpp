// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/lights/internal/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/float_pi.h"

namespace lamina {
namespace {

/// The segment that x lies in, and its place between its ends.
std::pair<int, float> find_segment(const SegmentSearch& search, std::span<const float> ends,
                                   float x) {
  const std::size_t i = search.find(ends, x);
  const float low = i > 0 ? ends[i - 1] : 0.0f, size = ends[i] - low;
  return {static_cast<int>(i),
          size > 0.0f ? std::clamp((x - low) / size, 0.0f, 0x1.fffffep-1f) : 0.5f};
}

/// Draws x in [0, 1] with a density proportional to a + (b - a) x.
float sample_linear(float a, float b, float u) {
  if (!(a + b > 0.0f)) return u;
  const float root = std::sqrt(a * a + u * (b * b - a * a));
  return std::clamp(u * (a + b) / std::max(a + root, 1e-30f), 0.0f, 1.0f);
}

}  // namespace

Environment::Environment(const Vec3f& radiance)
    : texels_{{radiance, 0.0f}},
      row_scale_{1.0f, 1.0f},
      mean_(radiance),
      greatest_brightness_(mean_of_channels(radiance)) {}

Environment::Environment(const Image& image, const Vec3f& scale, float rotation)
    : width_(image.width),
      height_(image.height),
      cos_rotation_(std::cos(rotation)),
      sin_rotation_(std::sin(rotation)) {
  const auto channel = [&](const char* name, std::size_t otherwise) {
    const auto at = std::find(image.channels.begin(), image.channels.end(), name);
    if (at != image.channels.end()) return static_cast<std::size_t>(at - image.channels.begin());
    return image.channel_count() < 3 ? std::size_t{0} : otherwise;
  };
  const std::array<std::size_t, 3> channels = {channel("R", 0), channel("G", 1), channel("B", 2)};
  texels_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  double sum[3] = {}, sum_of_solid_angles = 0.0;
  for (int y = 0; y < height_; ++y) {
    const double solid_angle =
        std::sin(std::numbers::pi * (y + 0.5) / static_cast<double>(height_));
    for (int x = 0; x < width_; ++x) {
      Vec3f color;
      for (int c = 0; c < 3; ++c) {
        const float value = image.at(x, y)[channels[static_cast<std::size_t>(c)]];
        color[c] = value > 0.0f ? std::min(value, 1e9f) * scale[c] : 0.0f;
        sum[c] += solid_angle * static_cast<double>(color[c]);
      }
      sum_of_solid_angles += solid_angle;
      texels_.push_back({color, 0.0f});
    }
  }
  for (int c = 0; c < 3; ++c) mean_[c] = static_cast<float>(sum[c] / sum_of_solid_angles);
  const float even_part = mean_of_channels(mean_);
  for (Texel& texel : texels_) {
    texel.weight = std::max(0.0f, mean_of_channels(texel.radiance) - even_part);
    greatest_brightness_ = std::max(greatest_brightness_, mean_of_channels(texel.radiance));
  }

  const int rows = height_ + 1;
  std::vector<double> row_total(static_cast<std::size_t>(rows));
  column_ends_.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(width_));
  for (int row = 0; row < rows; ++row) {
    const double theta0 = std::numbers::pi * std::max(row - 0.5, 0.0) / height_;
    const double theta1 =
        std::numbers::pi * std::min(row + 0.5, static_cast<double>(height_)) / height_;
    const double band = std::cos(theta0) - std::cos(theta1);
    row_scale_.push_back(static_cast<float>(band / (theta1 - theta0)));
    float* ends = &column_ends_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_)];
    double total = 0.0;
    std::vector<double> running(static_cast<std::size_t>(width_));
    for (int column = 0; column < width_; ++column) {
      total += 0.25 * static_cast<double>(
                          corner(column, row - 1).weight + corner(column + 1, row - 1).weight +
                          corner(column, row).weight + corner(column + 1, row).weight);
      running[static_cast<std::size_t>(column)] = total;
    }
    for (int column = 0; column < width_; ++column)
      ends[column] =
          static_cast<float>(total > 0.0 ? running[static_cast<std::size_t>(column)] / total : 0.0);
    row_total[static_cast<std::size_t>(row)] = total * band * 2.0 * std::numbers::pi / width_;
    total_ += row_total[static_cast<std::size_t>(row)];
  }
  double running = 0.0;
  for (const double row : row_total) {
    running += row;
    row_ends_.push_back(static_cast<float>(total_ > 0.0 ? running / total_ : 0.0));
  }
  row_search_.emplace_back(row_ends_);
  for (int row = 0; row <= height_; ++row) column_search_.emplace_back(ends_of_row(row));
}

std::span<const float> Environment::ends_of_row(int row) const {
  const auto width = static_cast<std::size_t>(width_);
  return std::span(column_ends_).subspan(static_cast<std::size_t>(row) * width, width);
}

const Environment::Texel& Environment::corner(int column, int row) const {
  const int x = column >= width_ ? column - width_ : column;
  const int y = std::clamp(row, 0, height_ - 1);
  return texels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                 static_cast<std::size_t>(x)];
}

Environment::Texel Environment::interpolate(int column, int row, float fx, float fy) const {
  const Texel &a = corner(column, row - 1), &b = corner(column + 1, row - 1);
  const Texel &c = corner(column, row), &d = corner(column + 1, row);
  const float wa = (1.0f - fx) * (1.0f - fy), wb = fx * (1.0f - fy), wc = (1.0f - fx) * fy,
              wd = fx * fy;
  return {wa * a.radiance + wb * b.radiance + wc * c.radiance + wd * d.radiance,
          wa * a.weight + wb * b.weight + wc * c.weight + wd * d.weight};
}

float Environment::density(const Texel& texel, int row, float sin_theta) const {
  if (!(total_ > 0.0)) return 0.0f;
  return texel.weight * row_scale_[static_cast<std::size_t>(row)] /
         (std::max(sin_theta, 1e-6f) * static_cast<float>(total_));
}

float Environment::mean_sampled() const {
  return static_cast<float>(total_ / (4.0 * std::numbers::pi));
}

Environment::Seen Environment::evaluate(const Vec3f& direction) const {
  if (texels_.size() == 1) return {texels_[0].radiance, 0.0f};
  const float dx = cos_rotation_ * direction.x - sin_rotation_ * direction.z;
  const float dz = sin_rotation_ * direction.x + cos_rotation_ * direction.z;
  const float dy = std::clamp(direction.y, -1.0f, 1.0f);
  float x = (0.5f + std::atan2(dx, -dz) / (2.0f * float_pi)) * static_cast<float>(width_) - 0.5f;
  if (x < 0.0f) x += static_cast<float>(width_);
  const float y = std::acos(dy) / float_pi * static_cast<float>(height_) + 0.5f;
  const int column = std::min(static_cast<int>(x), width_ - 1);
  const int row = std::min(static_cast<int>(y), height_);
  const Texel texel =
      interpolate(column, row, x - static_cast<float>(column), y - static_cast<float>(row));
  return {texel.radiance, density(texel, row, std::sqrt(std::max(0.0f, 1.0f - dy * dy)))};
}

Environment::Sample Environment::sample(Vec2f u) const {
  const auto [row, v] = find_segment(row_search_.front(), row_ends_, u.y);
  const auto [column, h] =
      find_segment(column_search_[static_cast<std::size_t>(row)], ends_of_row(row), u.x);
  const float a = corner(column, row - 1).weight, b = corner(column + 1, row - 1).weight;
  const float c = corner(column, row).weight, d = corner(column + 1, row).weight;
  float fy = sample_linear(a + b, c + d, v);
  if (row == 0) fy = 0.5f + 0.5f * fy;  // the half row below the upper pole
  if (row == height_) fy = 0.5f * fy;
  const float fx = sample_linear(a + fy * (c - a), b + fy * (d - b), h);
  const float theta =
      float_pi * (static_cast<float>(row) + fy - 0.5f) / static_cast<float>(height_);
  const float phi = 2.0f * float_pi *
                    ((static_cast<float>(column) + fx + 0.5f) / static_cast<float>(width_) - 0.5f);
  const float sin_theta = std::sin(theta);
  const float dx = sin_theta * std::sin(phi), dz = -sin_theta * std::cos(phi);
  const Texel texel = interpolate(column, row, fx, fy);
  return {{cos_rotation_ * dx + sin_rotation_ * dz, std::cos(theta),
           -sin_rotation_ * dx + cos_rotation_ * dz},
          {texel.radiance, density(texel, row, sin_theta)}};
}

}  // namespace lamina
