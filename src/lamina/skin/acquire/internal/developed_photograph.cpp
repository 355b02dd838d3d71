// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/internal/developed_photograph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lamina/base/core/number_text.h"
#include "lamina/skin/acquire/calibration/color_correction.h"
#include "lamina/skin/acquire/calibration/gray_card.h"
#include "lamina/skin/acquire/calibration/light_window.h"

namespace lamina::acquire_detail {
namespace {

/// Reflectances of skin lie far within; what is beyond has another unit.
constexpr float lowest_reflectance = -0.05f, highest_reflectance = 4.0f;

void require_reflectances(const Image& image) {
  const std::size_t bands = image.channel_count();
  const auto width = static_cast<std::size_t>(image.width);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (!(lowest_reflectance <= image.pixels[i] && image.pixels[i] <= highest_reflectance))
      throw InvalidInput(
          "must hold fractions of what white reflects, in [-0.05, 4] (\"white\" divides), but "
          "pixel " +
          std::to_string(i / bands % width) + ", " + std::to_string(i / bands / width) + " has " +
          image.channels[i % bands] + " = " +
          printf_text("%.4g", static_cast<double>(image.pixels[i])));
}

/// Develops images of one entry of a capture by its white and dark, which the last one takes.
class Developer {
 public:
  explicit Developer(PhotographDescription& photograph)
      : photograph_(photograph),
        left_(1 + (photograph.parallel ? 1 : 0) +
              (photograph.chart && photograph.chart->image ? 1 : 0)) {}

  [[nodiscard]] Developed operator()(Image image, PixelMask mask) {
    --left_;
    return std::holds_alternative<PhotographDescription::White>(photograph_.white)
               ? by_image(std::move(image), mask)
               : by_numbers(std::move(image), std::move(mask));
  }

 private:
  [[nodiscard]] Image taken(Image& image) const { return left_ == 0 ? std::move(image) : image; }

  /// By an image of a white reference.
  Developed by_image(Image raw, const PixelMask& mask) {
    auto& white = std::get<PhotographDescription::White>(photograph_.white);
    Photographs photographs{
        .raw = std::move(raw), .white = taken(white.image), .dark = {}, .white_count = white.count};
    if (Image* const dark = std::get_if<Image>(&photograph_.dark))
      photographs.dark = taken(*dark);
    else
      photographs.black = std::get<double>(photograph_.dark);
    DevelopOptions options{.white_reflectance = white.reflectance,
                           .exposure_ratio = {white.exposure_ratio}};
    if (!photograph_.saturation.empty()) options.saturation = photograph_.saturation[0];
    return at_place(white.place, [&] { return develop(photographs, mask, options); });
  }

  /// White in the numbers of an image, [channel].
  [[nodiscard]] std::vector<double> white_of(const Image& image) const {
    if (const auto* const numbers = std::get_if<std::vector<double>>(&photograph_.white))
      return *numbers;
    const auto& card = std::get<PhotographDescription::Card>(photograph_.white);
    return at_place(card.place, [&] {
      return white_level(
          read_card(image, mask_from_image(polygon_image(card.corners, image.width, image.height)),
                    *std::ranges::min_element(photograph_.saturation), "the card"),
          card.reflectance);
    });
  }

  /// By what the image holds where white is; the errors are stated.
  Developed by_numbers(Image image, PixelMask mask) {
    const std::size_t bands = image.channel_count();
    if (const Image* const dark = std::get_if<Image>(&photograph_.dark)) {
      for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] -= dark->pixels[i];
    } else {
      const auto black = static_cast<float>(std::get<double>(photograph_.dark));
      for (float& pixel : image.pixels) pixel -= black;
    }
    const std::vector<double> white = white_of(image);
    Developed developed{.reflectance = std::move(image), .mask = std::move(mask)};
    developed.deviation = developed.reflectance;
    for (std::size_t i = 0; i < developed.reflectance.pixels.size(); ++i) {
      float& pixel = developed.reflectance.pixels[i];
      if (static_cast<double>(pixel) >= photograph_.saturation[i % bands])
        developed.mask.mark(i / bands, PixelFault::saturated);
      pixel = static_cast<float>(static_cast<double>(pixel) / white[i % bands]);
      developed.deviation.pixels[i] =
          static_cast<float>(photograph_.errors[i % bands]) * std::abs(pixel);
    }
    at_place(photograph_.place, [&] { require_reflectances(developed.reflectance); });
    return developed;
  }

  PhotographDescription& photograph_;
  int left_;  ///< images that are still to be developed
};

/// Mean over what is used, [channel].
std::array<double, 3> mean_color(const Developed& developed) {
  std::array<double, 3> mean = {};
  double used = 0.0;
  for (std::size_t i = 0; i < developed.mask.faults.size(); ++i)
    if (developed.mask.faults[i] == 0) {
      ++used;
      for (std::size_t c = 0; c < 3; ++c)
        mean[c] += static_cast<double>(developed.reflectance.pixels[3 * i + c]);
    }
  for (double& channel : mean) channel /= std::max(used, 1.0);
  return mean;
}

/// Corrects colors to those of a chart.
/// @param own  image of the chart; absent: it lies in the photograph
void correct_by_chart(const PhotographDescription::Chart& chart, const std::optional<Image>& own,
                      DevelopedPhotograph& photograph) {
  Developed& developed = photograph.developed;
  const ChartOptions options{.edition = chart.edition};
  const Image& image = own ? *own : developed.reflectance;
  const std::vector<Vec2>& corners = chart.corners;
  const ChartReading reading =
      corners.empty() ? find_color_chart(image, "the image", options)
                      : read_color_chart(image, {corners[0], corners[1], corners[2], corners[3]},
                                         "the image", options);
  if (!own) leave_out_chart(reading.corners, developed.mask);
  const ColorCorrection correction = fit_color_correction(color_samples(reading, options.edition));
  const std::array<double, 3> mean = mean_color(developed);
  CorrectedImage corrected =
      corrected_colors(developed.reflectance, developed.deviation, correction.matrix);
  developed.reflectance = std::move(corrected.color);
  developed.deviation = std::move(corrected.deviation);
  const Matrix3 covariance = correction_covariance(correction, mean);
  const std::array<double, 3> color = correction.matrix * mean;
  for (std::size_t c = 0; c < 3; ++c)
    photograph.errors[c] =
        std::hypot(photograph.errors[c],
                   std::sqrt(std::max(covariance[c][c], 0.0)) / std::max(color[c], 1e-3));
  photograph.notes.push_back(printf_text(
      "colors corrected by a chart: CIEDE2000 %.2f in the mean of its patches, %.2f "
      "and at most %.2f for patches left out",
      correction.mean_error, correction.mean_left_out_error, correction.largest_left_out_error));
}

}  // namespace

void leave_out_chart(const ChartCorners& corners, PixelMask& mask) {
  const Image covered = polygon_image(chart_outline(corners), mask.width, mask.height);
  constexpr float rounding = 1e-3f;  // of sums along rows
  for (std::size_t i = 0; i < covered.pixels.size(); ++i)
    if (covered.pixels[i] > rounding) mask.mark(i, PixelFault::excluded);
}

DevelopedPhotograph develop_photograph(PhotographDescription photograph) {
  Developer develop_by(photograph);
  DevelopedPhotograph result;
  result.developed = develop_by(std::move(photograph.image), photograph.mask);
  result.errors = photograph.errors;
  Developed& developed = result.developed;
  if (auto& parallel = photograph.parallel) {
    const Developed other = develop_by(std::move(parallel->image), photograph.mask);
    developed = at_place(parallel->place, [&] {
      return separate_polarized(other, developed, parallel->options).diffuse;
    });
    result.notes.emplace_back("diffuse light is that of crossed polarizers, twice");
  }
  for (Image* image : {&developed.reflectance, &developed.deviation})
    for (float& pixel : image->pixels)
      pixel = static_cast<float>(static_cast<double>(pixel) / photograph.light);
  if (auto& chart = photograph.chart) {
    std::optional<Image> own;
    if (chart->image) {
      own = develop_by(std::move(*chart->image),
                       make_pixel_mask(developed.mask.width, developed.mask.height))
                .reflectance;
      if (photograph.parallel)  // taken as the image is, through crossed sheets
        for (float& pixel : own->pixels) pixel *= 2.0f;
    }
    at_place(chart->place, [&] { correct_by_chart(*chart, own, result); });
  }
  return result;
}

}  // namespace lamina::acquire_detail
