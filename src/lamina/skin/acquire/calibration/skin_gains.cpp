// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/skin_gains.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/random.h"
#include "lamina/skin/acquire/bands/band_choice.h"
#include "lamina/skin/acquire/calibration/internal/channel_values.h"
#include "lamina/skin/acquire/calibration/internal/chi_squared.h"
#include "lamina/skin/acquire/calibration/internal/local_median.h"

namespace lamina {
namespace {

DenseMatrix inverse_matrix(const DenseMatrix& a) {
  DenseMatrix one(a.rows, a.rows);
  for (std::size_t i = 0; i < a.rows; ++i) one(i, i) = 1.0;
  return solve_linear(a, one);
}

/// x^T A x
double quadratic_form(const DenseMatrix& a, std::span<const double> x) {
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < x.size(); ++j) sum += x[i] * a(i, j) * x[j];
  return sum;
}

void require_channels(std::size_t given, const SkinColors& population) {
  if (given != population.mean.size())
    throw InvalidInput("skin gains: colors must have the " +
                       std::to_string(population.mean.size()) +
                       " channels of the population, but have " + std::to_string(given));
}

}  // namespace

SkinColors make_skin_colors(const SkinReflectanceTable& table, const DenseMatrix& sensor,
                            const SkinPopulation& population, bool with_specular, int count,
                            std::uint64_t seed) {
  const std::vector<double>& wavelengths = table.wavelengths();
  const std::size_t channels = sensor.rows, components = population.missed_components.rows;
  if (count < 100)
    throw InvalidInput("skin colors: at least 100 skins are required, but " +
                       std::to_string(count) + " are asked for");
  if (sensor.columns != wavelengths.size() || channels == 0)
    throw InvalidInput("skin colors: the sensor must have weights at the " +
                       std::to_string(wavelengths.size()) + " wavelengths of the table, but has " +
                       std::to_string(sensor.columns));
  // What the model misses: at each wavelength its mean, and the size of each component.
  DenseMatrix missed(components + 1, wavelengths.size());
  for (std::size_t w = 0; w < wavelengths.size(); ++w) {
    missed(0, w) = at_wavelength(population, population.missed, wavelengths[w]);
    for (std::size_t k = 0; k < components; ++k)
      missed(k + 1, w) =
          at_wavelength(population, population.missed_components.row(k), wavelengths[w]);
  }
  Random random = make_random(seed, 1);
  const auto normal = [&] {
    return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) *
           std::cos(2.0 * std::numbers::pi * random.uniform());
  };
  DenseMatrix colors(static_cast<std::size_t>(count), channels);
  SkinColors result{.mean = std::vector<double>(channels),
                    .covariance = DenseMatrix(channels, channels)};
  const std::vector<SkinParameters> skins = draw_skins(population, count, seed);
  for (std::size_t s = 0; s < skins.size(); ++s) {
    std::vector<double> spectrum = table.reflectance(skins[s]);
    for (std::size_t k = 0; k <= components; ++k) {
      const double size = k == 0 ? 1.0 : normal();
      for (std::size_t w = 0; w < spectrum.size(); ++w) spectrum[w] += size * missed(k, w);
    }
    for (std::size_t c = 0; c < channels; ++c) {
      double color = 0.0;
      for (std::size_t w = 0; w < spectrum.size(); ++w)
        color +=
            sensor(c, w) * (spectrum[w] + (with_specular ? table.specular_reflectance() : 0.0));
      colors(s, c) = std::log(std::max(color, 1e-4));  // darker than any skin
      result.mean[c] += colors(s, c) / count;
    }
  }
  for (std::size_t s = 0; s < skins.size(); ++s)
    for (std::size_t c = 0; c < channels; ++c)
      for (std::size_t d = 0; d < channels; ++d)
        result.covariance(c, d) +=
            (colors(s, c) - result.mean[c]) * (colors(s, d) - result.mean[d]) / (count - 1);
  return result;
}

std::vector<double> median_log_color(const Image& image, const PixelMask& skin) {
  require_size(skin, image, "skin gains: the mask");
  const std::size_t channels = image.channel_count();
  std::vector<std::vector<float>> logs(channels);
  for (std::size_t i = 0; i < skin.faults.size(); ++i) {
    const auto pixel = std::span(image.pixels).subspan(i * channels, channels);
    if (skin.faults[i] != 0 ||
        !std::ranges::all_of(pixel, [](float v) { return v > 0.0f && std::isfinite(v); }))
      continue;
    for (std::size_t c = 0; c < channels; ++c) logs[c].push_back(std::log(pixel[c]));
  }
  if (channels == 0 || logs[0].size() < 16)
    throw InvalidInput("skin gains: at least 16 pixels of skin are required, but there are " +
                       std::to_string(channels == 0 ? 0 : logs[0].size()));
  std::vector<double> medians;
  for (std::vector<float>& each : logs) medians.push_back(static_cast<double>(median_of(each)));
  return medians;
}

// With g the logarithms of the gains, m the mean over n people, and mu, C of the population:
// the least of n (g + m - mu)^T C^-1 (g + m - mu) + g^T P^-1 g.
SkinGains fit_skin_gains(std::span<const std::vector<double>> people, const SkinColors& population,
                         const SkinGainPrior& prior) {
  if (people.empty()) throw InvalidInput("skin gains: the skin of a person is required");
  const auto& [level, color, widening] = prior;
  if (!(level > 0.0 && color > 0.0 && widening >= 1.0))
    throw InvalidInput(
        "skin gains: deviations of the prior must be > 0 and its widening >= 1, "
        "but they are " +
        number_text(level) + ", " + number_text(color) + " and " + number_text(widening));
  const std::size_t channels = population.mean.size();
  const auto count = static_cast<double>(people.size());
  std::vector<double> away(channels);
  for (const std::vector<double>& person : people) {
    require_channels(person.size(), population);
    for (std::size_t c = 0; c < channels; ++c) {
      if (!std::isfinite(person[c]))
        throw InvalidInput("skin gains: colors must be finite, but one is " +
                           number_text(person[c]));
      away[c] += (population.mean[c] - person[c]) / count;
    }
  }
  DenseMatrix before(channels, channels);
  for (std::size_t i = 0; i < channels; ++i)
    for (std::size_t j = 0; j < channels; ++j)
      before(i, j) = level * level + (i == j ? color * color : 0.0);
  DenseMatrix known = inverse_matrix(population.covariance);
  for (double& value : known.values) value /= widening * widening;
  const DenseMatrix prior_precision = inverse_matrix(before);
  DenseMatrix precision = prior_precision;
  std::vector<double> pull(channels);
  for (std::size_t i = 0; i < channels; ++i)
    for (std::size_t j = 0; j < channels; ++j) {
      precision(i, j) += count * known(i, j);
      pull[i] += count * known(i, j) * away[j];
    }
  SkinGains result{.covariance = inverse_matrix(precision)};
  std::vector<double> logs(channels);
  for (std::size_t i = 0; i < channels; ++i) {
    for (std::size_t j = 0; j < channels; ++j) logs[i] += result.covariance(i, j) * pull[j];
    result.gains.push_back(std::exp(logs[i]));
    result.prior_share.push_back(std::sqrt(result.covariance(i, i) / before(i, i)));
  }
  double squares = quadratic_form(prior_precision, logs);
  for (const std::vector<double>& person : people) {
    std::vector<double> left(channels);
    for (std::size_t c = 0; c < channels; ++c) left[c] = person[c] + logs[c] - population.mean[c];
    squares += quadratic_form(known, left);
  }
  result.distance = std::sqrt(squares / (count * static_cast<double>(channels)));
  return result;
}

SkinPixels pixels_of_skin(const Image& image, const PixelMask& mask, std::span<const double> gains,
                          const SkinColors& population) {
  require_size(mask, image, "skin gains: the mask");
  require_channels(image.channel_count(), population);
  require_channels(gains.size(), population);
  const std::size_t channels = gains.size();
  const DenseMatrix known = inverse_matrix(population.covariance);
  constexpr double normal_of_99 = 2.32635;
  const auto degrees = static_cast<double>(channels);
  const double limit = degrees * chi_squared_quantile(degrees, normal_of_99);
  SkinPixels found{.mask = mask};
  std::vector<double> left(channels);
  for (std::size_t i = 0; i < mask.faults.size(); ++i) {
    if (mask.faults[i] != 0) continue;
    bool is_color = true, is_below = true, is_above = true;  // all channels, by a deviation
    for (std::size_t c = 0; c < channels; ++c) {
      const double value = gains[c] * static_cast<double>(image.pixels[i * channels + c]);
      is_color = is_color && value > 0.0;
      left[c] = is_color ? std::log(value) - population.mean[c] : 0.0;
      const double deviation = std::sqrt(population.covariance(c, c));
      is_below = is_below && left[c] < -deviation;
      is_above = is_above && left[c] > deviation;
    }
    if (is_color && quadratic_form(known, left) <= limit) {
      ++found.skin;
      continue;
    }
    found.mask.mark(i, PixelFault::excluded);
    ++(!is_color || is_below ? found.dark : is_above ? found.bright : found.colored);
  }
  return found;
}

FoundSkinGains find_skin_gains(const Image& image, const PixelMask& mask,
                               const SkinColors& population, const SkinGainPrior& prior) {
  constexpr int most_rounds = 20;
  constexpr std::size_t least_pixels = 64;
  constexpr double least_share = 0.01;
  const auto fit = [&](const PixelMask& skin) {
    const std::vector<double> seen = median_log_color(image, skin);
    return fit_skin_gains({&seen, 1}, population, prior);
  };
  const auto is_enough = [&](std::size_t pixels) {
    return pixels >= least_pixels && static_cast<double>(pixels) >=
                                         least_share * static_cast<double>(count_pixels(mask).used);
  };
  // Colors of skin before gains: the spread of people, and that of gains.
  SkinColors before_gains = population;
  DenseMatrix& spread = before_gains.covariance;
  for (std::size_t i = 0; i < spread.rows; ++i)
    for (std::size_t j = 0; j < spread.columns; ++j)
      spread(i, j) = spread(i, j) * prior.widening * prior.widening + prior.level * prior.level +
                     (i == j ? prior.color * prior.color : 0.0);
  const std::vector<double> as_it_is(image.channel_count(), 1.0);
  SkinPixels pixels = pixels_of_skin(image, mask, as_it_is, before_gains);
  SkinGains gains = fit(is_enough(pixels.skin) ? pixels.mask : mask);
  for (int round = 0; round < most_rounds; ++round) {
    const std::vector<std::uint8_t> before = pixels.mask.faults;
    pixels = pixels_of_skin(image, mask, gains.gains, population);
    if (pixels.mask.faults == before || !is_enough(pixels.skin)) break;
    gains = fit(pixels.mask);
  }
  return {std::move(gains), std::move(pixels)};
}

}  // namespace lamina
