// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/internal/color_statement.h"

#include <algorithm>
#include <array>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/image/files/internal/icc_transform.h"
#include "lamina/base/spectrum/rgb_space.h"

namespace lamina {
namespace {

constexpr RgbCurve srgb_curve{.kind = RgbCurve::Kind::srgb};

/// The matrix from these primaries; absent where there is nothing to do.
std::optional<Matrix3> to_rec709(const EncodedImage& file, const char* format,
                                 const RgbPrimaries& primaries) {
  const RgbPrimaries rec709 = rec709_primaries();
  if (are_alike(primaries, rec709)) return std::nullopt;
  try {
    return rgb_conversion(primaries, rec709);
  } catch (const InvalidInput& error) {
    fail_to_decode(file, format, error.what());
  }
}

}  // namespace

ColorReading::ColorReading(const EncodedImage& file, const char* format, const ColorStatement& said,
                           bool is_grey, bool is_float) {
  const auto follow = [&](const RgbEncoding& encoding) {
    (is_float ? float_curve_ : curve_) = encoding.curve;
    if (!is_grey) matrix_ = to_rec709(file, format, encoding.primaries);
  };
  if (const auto stated = stated_encoding(file.encoding)) {
    follow(*stated);
    return;
  }
  if (file.encoding == ColorEncoding::srgb_numbers && !is_float) curve_ = srgb_curve;
  if (!follows_statement(file.encoding)) return;
  const bool is_light = file.encoding == ColorEncoding::linear_colors;
  if (!said.refusal.empty() && !is_light) fail_to_decode(file, format, said.refusal);
  if (!said.icc.empty()) {
    try {
      icc_ = std::make_unique<IccTransform>(said.icc, is_grey);
    } catch (const InvalidInput& error) {
      if (!is_light) fail_to_decode(file, format, std::string("its ICC profile ") + error.what());
    }
    if (icc_ && is_light && !icc_->takes_light()) icc_.reset();
    return;
  }
  if (said.encoding && (!is_light || is_linear(said.encoding->curve)))
    follow(*said.encoding);
  else if (!is_light && !is_float)
    curve_ = srgb_curve;
}

ColorReading::~ColorReading() = default;

float ColorReading::number(std::uint32_t value, std::uint32_t largest) const {
  return static_cast<float>(
      linear_light(curve_, static_cast<double>(value) / static_cast<double>(largest)));
}

Image ColorReading::in_rec709(Image image) const {
  if (!icc_ && !matrix_ && is_linear(float_curve_)) return image;
  const std::size_t channels = image.channel_count();
  const std::size_t colors = image.channels[0] == "R" ? 3 : 1;
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<bool> was_negative;
  if (icc_) {
    was_negative.resize(image.pixels.size() / channels);
    for (std::size_t i = 0; i < was_negative.size(); ++i)
      was_negative[i] =
          std::any_of(&image.pixels[i * channels], &image.pixels[i * channels] + colors,
                      [](float number) { return number < 0.0f; });
    icc_->apply(image);
  }
  parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      float* const pixel = image.at(static_cast<int>(x), static_cast<int>(y));
      bool keeps = icc_ && was_negative[y * width + x];
      for (std::size_t c = 0; c < colors && !is_linear(float_curve_); ++c)
        pixel[c] = static_cast<float>(linear_light(float_curve_, static_cast<double>(pixel[c])));
      if (matrix_ && colors == 3) {
        std::array<double, 3> color{};
        for (std::size_t c = 0; c < 3; ++c) {
          color[c] = static_cast<double>(pixel[c]);
          keeps = keeps || color[c] < 0.0;
        }
        color = *matrix_ * color;
        for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<float>(color[c]);
      }
      for (std::size_t c = 0; c < colors && !keeps && (icc_ || matrix_); ++c)
        pixel[c] = std::max(pixel[c], 0.0f);
    }
  });
  return image;
}

}  // namespace lamina
