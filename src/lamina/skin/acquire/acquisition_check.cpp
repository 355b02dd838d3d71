// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/acquisition_check.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/spectrum/color.h"
#include "lamina/skin/fit/skin/skin_fit.h"

namespace lamina {
namespace {

constexpr double calibration_change = 0.02;

/// What a pixel of the maps reflects in each band of the capture.
std::vector<double> bands_of(const Capture& capture, const AcquiredSkin& skin, std::size_t pixel,
                             const SkinReflectanceTable& table) {
  SkinParameters made = capture.skin.skin;
  for (const AcquiredNumber& number : skin.numbers)
    for (double SkinParameters::*const value : number.number.values)
      made.*value = static_cast<double>(number.values.pixels[pixel]);
  std::vector<double> spectrum = table.reflectance(made);
  if (capture.has_specular)
    for (double& r : spectrum) r += table.specular_reflectance();
  std::vector<double> bands(capture.sensor.rows, 0.0);
  for (std::size_t b = 0; b < bands.size(); ++b)
    for (std::size_t w = 0; w < spectrum.size(); ++w)
      bands[b] += capture.sensor(b, w) * spectrum[w];
  return bands;
}

Lab lab_of(std::span<const float> rgb) {
  return lab(LinearSrgb{static_cast<double>(rgb[0]), static_cast<double>(rgb[1]),
                        static_cast<double>(rgb[2])});
}

void compare(AcquisitionCheck& check) {
  const std::size_t bands = check.measured.channel_count();
  check.residual.assign(bands, 0.0);
  std::vector<double> differences;
  const bool is_color = check.measured.channels == std::vector<std::string>{"R", "G", "B"};
  std::vector<std::size_t> counts(bands, 0);  // of pixels in which a band is not black
  for (std::size_t i = 0; i < check.is_skin.size(); ++i) {
    if (!check.is_skin[i]) continue;
    const std::span measured(check.measured.pixels.data() + i * bands, bands);
    const std::span predicted(check.predicted.pixels.data() + i * bands, bands);
    for (std::size_t b = 0; b < bands; ++b)
      if (measured[b] > 0.0f) {
        check.residual[b] += std::pow(static_cast<double>(predicted[b] / measured[b]) - 1.0, 2);
        ++counts[b];
      }
    if (is_color) differences.push_back(color_difference(lab_of(measured), lab_of(predicted)));
  }
  for (std::size_t b = 0; b < bands; ++b)
    if (counts[b] > 0)
      check.residual[b] = std::sqrt(check.residual[b] / static_cast<double>(counts[b]));
  if (differences.empty()) return;
  std::ranges::sort(differences);
  double sum = 0.0;
  for (const double difference : differences) sum += difference;
  check.mean_difference = sum / static_cast<double>(differences.size());
  check.high_difference = differences[differences.size() * 95 / 100];
}

/// The middle of each band over skin.
std::vector<double> median_bands(const AcquisitionCheck& check) {
  const std::size_t bands = check.measured.channel_count();
  std::vector<double> medians;
  for (std::size_t b = 0; b < bands; ++b) {
    std::vector<float> values;
    for (std::size_t i = 0; i < check.is_skin.size(); ++i)
      if (check.is_skin[i]) values.push_back(check.measured.pixels[i * bands + b]);
    if (values.empty()) return {};
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    medians.push_back(static_cast<double>(*middle));
  }
  return medians;
}

/// @param growth  factors of the errors, [band]; empty: 1
void vary_calibration(const Capture& capture, const SkinReflectanceTable& table,
                      const std::vector<double>& growth, AcquisitionCheck& check) {
  const std::vector<double> middle = median_bands(check);
  const std::size_t numbers = capture.numbers.size();
  check.by_calibration = DenseMatrix(middle.size(), numbers);
  check.correlation = DenseMatrix(numbers, numbers);
  if (middle.empty()) return;
  const auto fit = [&](const std::vector<double>& measured) {
    SkinMeasurement seen{
        .measured = measured, .sensor = capture.sensor, .has_specular = capture.has_specular};
    for (std::size_t b = 0; b < measured.size(); ++b)
      seen.standard_deviation.push_back(capture.errors[b] * (growth.empty() ? 1.0 : growth[b]) *
                                        measured[b]);
    return fit_skin(table, seen, capture.skin.skin, capture.numbers,
                    capture.population ? &*capture.population : nullptr)
        .fit;
  };
  const auto coordinates = [&](const FitResult& result) {
    std::vector<double> found;
    for (std::size_t n = 0; n < numbers; ++n)
      found.push_back(fit_coordinate(capture.numbers[n].parameter, result.parameters[n].value));
    return found;
  };
  const FitResult result = fit(middle);
  check.correlation = result.correlation;
  const std::vector<double> at = coordinates(result);
  for (std::size_t b = 0; b < middle.size(); ++b) {
    std::vector<double> brighter = middle;
    brighter[b] *= 1.0 + calibration_change;
    const std::vector<double> moved = coordinates(fit(brighter));
    for (std::size_t n = 0; n < numbers; ++n) check.by_calibration(b, n) = moved[n] - at[n];
  }
}

}  // namespace

AcquisitionCheck check_acquisition(const Capture& capture, const AcquiredSkin& skin,
                                   const SkinReflectanceTable& table, const Progress& progress) {
  const int step = picture_step(skin.width, skin.height);
  const int width = (skin.width + step - 1) / step, height = (skin.height + step - 1) / step;
  const std::size_t bands = capture.reflectance.channel_count();
  AcquisitionCheck check{.measured = make_image(width, height, capture.reflectance.channels),
                         .predicted = make_image(width, height, capture.reflectance.channels)};
  std::vector<char> is_skin(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto row = [&](std::size_t y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t pixel =
          y * static_cast<std::size_t>(step) * static_cast<std::size_t>(skin.width) +
          static_cast<std::size_t>(x) * static_cast<std::size_t>(step);
      const std::size_t i = y * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      std::vector<double> predicted;
      if (skin.predicted.pixels.empty())
        predicted = bands_of(capture, skin, pixel, table);
      else
        predicted.assign(
            skin.predicted.pixels.begin() + static_cast<std::ptrdiff_t>(i * bands),
            skin.predicted.pixels.begin() + static_cast<std::ptrdiff_t>((i + 1) * bands));
      is_skin[i] = skin.kinds[pixel] == PixelKind::skin && std::isfinite(predicted[0]) ? 1 : 0;
      for (std::size_t b = 0; b < bands; ++b) {
        check.measured.pixels[i * bands + b] = capture.reflectance.pixels[pixel * bands + b];
        if (std::isfinite(predicted[b]))
          check.predicted.pixels[i * bands + b] = static_cast<float>(predicted[b]);
      }
    }
  };
  parallel_for(static_cast<std::size_t>(height), row, progress);
  check.is_skin.assign(is_skin.begin(), is_skin.end());
  compare(check);
  vary_calibration(capture, table, skin.error_growth, check);
  return check;
}

std::vector<std::string> notes_of_misfit(const Capture& capture, const AcquiredSkin& skin,
                                         const AcquisitionCheck& check) {
  constexpr double far = 5.0;  // residual over stated error
  const std::vector<std::string>& names = capture.reflectance.channels;
  std::vector<std::string> notes;
  std::string grown;
  for (std::size_t b = 0; b < skin.chi_squared.size(); ++b)
    if (skin.chi_squared[b] > chi_squared_of_note)
      grown += printf_text("%s %.3g (%s, errors %.2g times those stated)", grown.empty() ? "" : ",",
                           skin.chi_squared[b], names[b].c_str(), skin.error_growth[b]);
  if (!grown.empty())
    notes.push_back("chi squared is" + grown +
                    ": noise is larger than stated, or the model is not of this skin; errors of "
                    "maps have grown with it, but errors that all pixels share are not in them");
  std::string off;
  for (std::size_t b = 0; b < check.residual.size(); ++b)
    if (check.residual[b] > far * capture.errors[b])
      off += printf_text("%s %.3g %% (%s, stated %.2g %%)", off.empty() ? "" : ",",
                         100.0 * check.residual[b], names[b].c_str(), 100.0 * capture.errors[b]);
  if (!off.empty())
    notes.push_back("residuals are more than five times the stated errors:" + off +
                    "; look whether all that is used is skin, and at white, gains and bands");
  return notes;
}

void add_gain_errors(const Capture& capture, const AcquisitionCheck& check, AcquiredSkin& skin) {
  const DenseMatrix& covariance = capture.gain_covariance;
  if (covariance.rows == 0) return;
  for (std::size_t n = 0; n < skin.numbers.size(); ++n) {
    AcquiredNumber& number = skin.numbers[n];
    double variance = 0.0;
    for (std::size_t a = 0; a < covariance.rows; ++a)
      for (std::size_t b = 0; b < covariance.columns; ++b)
        variance += check.by_calibration(a, n) * covariance(a, b) * check.by_calibration(b, n) /
                    (calibration_change * calibration_change);
    const auto common = static_cast<float>(std::sqrt(std::max(variance, 0.0)));
    const auto most = static_cast<float>(number.prior_deviation);
    for (float& deviation : number.deviations.pixels)
      deviation = std::min(most, std::hypot(deviation, common));
    number.prior_share = std::min(
        1.0, std::hypot(number.prior_share, static_cast<double>(common) / number.prior_deviation));
  }
}

}  // namespace lamina
