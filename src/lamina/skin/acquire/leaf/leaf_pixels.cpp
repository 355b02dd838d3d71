// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/leaf/leaf_pixels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/skin/acquire/leaf/internal/leaf_pixel.h"

namespace lamina {
namespace {

using detail::fit_leaf;
using detail::LeafCoordinates;
using detail::LeafFit;
using detail::LeafPixelModel;
using detail::LeafPrediction;

constexpr float no_number = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t chunk = 64;  // pixels that one thread takes at a time

FitParameter about(std::string name, double median, double deviation, double offset, double high) {
  return {.name = std::move(name),
          .start = median,
          .low = 0.0,
          .high = high,
          .scale = FitScale::logarithmic,
          .prior = FitPrior{median, deviation},
          .offset = offset};
}

double middle_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void check(const Image& image, const std::vector<double>& wavelengths,
           const LeafPixelOptions& options) {
  const auto refuse = [](const std::string& text) { throw InvalidInput("leaf pixels: " + text); };
  const std::size_t bands = image.channel_count();
  if (wavelengths.size() != bands)
    refuse("there must be a wavelength for each of " + std::to_string(bands) +
           " channels, but there are " + std::to_string(wavelengths.size()));
  for (const double nm : wavelengths)
    if (!(shortest_leaf_wavelength <= nm && nm <= longest_leaf_wavelength))
      refuse("wavelengths must lie in [" + number_text(shortest_leaf_wavelength) + ", " +
             number_text(longest_leaf_wavelength) + "] nm, but one is " + number_text(nm));
  if (options.numbers.empty()) refuse("a number of the leaf must be free");
  const std::size_t numbers = options.numbers.size() + 2;
  if (numbers > detail::most_leaf_numbers)
    refuse("at most " + std::to_string(detail::most_leaf_numbers - 2) + " numbers can be free");
  if (bands < numbers)
    refuse(std::to_string(numbers) + " free numbers need as many bands, but there are " +
           std::to_string(bands));
  const auto check_parameter = [&](const FitParameter& parameter) {
    check_fit_parameter(parameter);
    if (!parameter.prior) refuse(parameter.name + " must have a prior");
  };
  for (const LeafNumber& number : options.numbers) {
    check_parameter(number.parameter);
    // The table's place is linear in these alone.
    if (number.value == nullptr || number.value == &LeafParameters::palisade_share ||
        number.value == &LeafParameters::thickness)
      refuse(number.parameter.name + " cannot be free");
  }
  for (const LeafParameterRange& range : leaf_parameter_ranges()) {
    const auto check_range = [&](double low, double high) {
      if (!(range.low <= low && high <= range.high))
        refuse(std::string(range.name) + " must lie within [" + number_text(range.low) + ", " +
               number_text(range.high) + "], but is within [" + number_text(low) + ", " +
               number_text(high) + "]");
    };
    check_range(options.leaf.*range.value, options.leaf.*range.value);
    for (const LeafNumber& number : options.numbers)
      if (number.value == range.value) check_range(number.parameter.low, number.parameter.high);
  }
  check_parameter(options.illumination);
  check_parameter(options.gloss);
  const auto check_bands = [&](const std::vector<double>& values, const std::string& name,
                               double low, double high) {
    if (values.empty()) return;
    if (values.size() != bands)
      refuse(name + " must have a number for each of " + std::to_string(bands) +
             " bands, but has " + std::to_string(values.size()));
    for (const double value : values)
      if (!(low <= value && value <= high))
        refuse(name + " must lie in [" + number_text(low) + ", " + number_text(high) +
               "], but is " + number_text(value));
  };
  check_bands(options.ground, "ground", 0.0, 1.0);
  check_bands(options.noise, "noise", 1e-6, 1e6);
  if (options.mask && (options.mask->width != image.width || options.mask->height != image.height))
    refuse("the mask must be as large as the image");
  if (options.shares_misfit && !options.noise.empty())
    refuse("shares_misfit needs noise that is found, not given");
  if (options.edge < 0) refuse("edge must be >= 0, but is " + std::to_string(options.edge));
}

/// Whether a spectrum has no pigment: it hardly rises, and what is left of it beside a straight
/// line is a small part of it; or it is hardly any light. Dead leaves rise much.
bool is_background(std::span<const double> measured, const std::vector<double>& wavelengths) {
  constexpr double least_light = 0.02, least_shape = 0.1, least_rise = 0.6, noise = 0.008;
  const auto bands = static_cast<double>(measured.size());
  double x = 0.0, y = 0.0;
  for (std::size_t b = 0; b < measured.size(); ++b) {
    x += wavelengths[b] / bands;
    y += measured[b] / bands;
  }
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t b = 0; b < measured.size(); ++b) {
    const double dx = wavelengths[b] - x, dy = measured[b] - y;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  const double slope = xx > 0.0 ? xy / xx : 0.0;
  const double rise =
      std::abs(slope) * (std::ranges::max(wavelengths) - std::ranges::min(wavelengths));
  const double shape = std::sqrt(std::max(0.0, yy - slope * xy) / bands);
  return y < least_light || (shape < least_shape * y + noise && rise < least_rise * y + noise);
}

/// Pixels, band by band, and what they are.
struct Pixels {
  const Image& image;
  std::vector<LeafPixelKind> kinds;
  std::vector<std::size_t> leaves;  ///< their indices

  [[nodiscard]] std::vector<double> measured(std::size_t pixel) const {
    const float* first = image.pixels.data() + pixel * image.channel_count();
    return {first, first + image.channel_count()};
  }
};

Pixels sorted_pixels(const Image& image, const std::vector<double>& wavelengths,
                     const LeafPixelOptions& options) {
  const std::size_t count =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  Pixels pixels{image, std::vector<LeafPixelKind>(count, LeafPixelKind::leaf), {}};
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<double> measured = pixels.measured(i);
    const bool is_finite =
        std::ranges::all_of(measured, [](double value) { return std::isfinite(value); });
    if (!is_finite || (options.mask && options.mask->faults[i] != 0))
      pixels.kinds[i] = LeafPixelKind::unused;
    else if (options.has_background && is_background(measured, wavelengths))
      pixels.kinds[i] = LeafPixelKind::background;
  }
  PixelMask leaf = make_pixel_mask(image.width, image.height);
  for (std::size_t i = 0; i < count; ++i)
    if (pixels.kinds[i] == LeafPixelKind::background) leaf.mark(i, PixelFault::excluded);
  leaf = eroded(std::move(leaf), options.edge);
  for (std::size_t i = 0; i < count; ++i) {
    if (pixels.kinds[i] != LeafPixelKind::leaf) continue;
    if (leaf.faults[i] != 0)
      pixels.kinds[i] = LeafPixelKind::edge;
    else
      pixels.leaves.push_back(i);
  }
  return pixels;
}

std::vector<double> background_of(const Pixels& pixels) {
  std::vector<double> result(pixels.image.channel_count(), 0.0);
  for (std::size_t b = 0; b < result.size(); ++b) {
    std::vector<double> values;
    for (std::size_t i = 0; i < pixels.kinds.size(); ++i)
      if (pixels.kinds[i] == LeafPixelKind::background)
        values.push_back(static_cast<double>(pixels.image.pixels[i * result.size() + b]));
    if (!values.empty()) result[b] = std::clamp(middle_of(std::move(values)), 0.0, 1.0);
  }
  return result;
}

LeafPixelModel make_model(const std::vector<double>& wavelengths, const LeafPixelOptions& options,
                          const Progress& progress) {
  std::vector<LeafSpectrum> spectra;
  for (const double nm : wavelengths) spectra.push_back(leaf_spectrum(nm));
  LeafParameters most = options.leaf;
  for (const LeafNumber& number : options.numbers) most.*number.value = number.parameter.high;
  double most_absorption = 0.1;
  for (const LeafSpectrum& spectrum : spectra)
    most_absorption = std::max(most_absorption, leaf_absorption(most, spectrum));
  LeafPixelModel model{
      .spectra = std::move(spectra),
      .leaf = options.leaf,
      .values = {},
      .parameters = {},
      .prior = {},
      .prior_deviation = {},
      .low = {},
      .high = {},
      .light = detail::LeafLight(options.leaf, most_absorption, options.incidence, progress),
      .ground = {},
      .deviation = {},
      .missed = std::vector<double>(wavelengths.size())};
  for (const LeafNumber& number : options.numbers) {
    model.values.push_back(number.value);
    model.parameters.push_back(number.parameter);
  }
  model.parameters.push_back(options.illumination);
  model.parameters.push_back(options.gloss);
  for (std::size_t n = 0; n < model.size(); ++n) {
    const FitParameter& parameter = model.parameters[n];
    model.prior[n] = fit_coordinate(parameter, parameter.prior->mean);
    model.prior_deviation[n] = parameter.prior->standard_deviation;
    model.low[n] = fit_coordinate(parameter, parameter.low);
    model.high[n] = fit_coordinate(parameter, parameter.high);
  }
  return model;
}

/// Errors of the bands by what is left of some pixels, until they stay.
/// @return  the correlation of neighboring bands, in [0, .9]
double find_errors(LeafPixelModel& model, const Pixels& pixels, bool shares_misfit,
                   const Progress& progress) {
  constexpr std::size_t most_samples = 1000;
  constexpr int rounds_apart = 3, rounds_shared = 2;
  const int rounds = rounds_apart + (shares_misfit ? rounds_shared : 0);
  constexpr double first_error = 0.01, least_error = 5e-4, most_correlation = 0.9;
  constexpr double of_median = 1.4826;  // a Gaussian's deviation over its median distance from 0
  const std::size_t bands = model.spectra.size();
  const std::size_t samples = std::min(most_samples, pixels.leaves.size());
  std::vector<std::vector<double>> left(samples);
  model.deviation.assign(bands, first_error);
  double correlation = 0.0;
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> told(samples);  // how many numbers the bands tell, not the prior
    parallel_for(
        samples,
        [&](std::size_t i) {
          left[i] = pixels.measured(pixels.leaves[i * pixels.leaves.size() / samples]);
          LeafPrediction prediction;
          const LeafFit fit = fit_leaf(model, left[i], prediction);
          for (std::size_t b = 0; b < bands; ++b) left[i][b] -= prediction.reflectance[b];
          for (std::size_t n = 0; n < model.size(); ++n)
            told[i] += 1.0 - fit.covariance[n][n] / std::pow(model.prior_deviation[n], 2);
        },
        part_of(progress, round / static_cast<double>(rounds),
                (round + 1) / static_cast<double>(rounds)));
    const double free = std::max(1.0, static_cast<double>(bands) - middle_of(told));
    // What all pixels miss alike is the model's, and counts as equally large in all bands: a band
    // that is met by chance would else draw the fit to itself.
    double misfit = 0.0;
    // Taken off once: the numbers would else follow it step by step.
    const bool is_shared = shares_misfit && round + 1 >= rounds_apart;
    std::vector<double> missed(bands);
    for (std::size_t b = 0; b < bands; ++b) {
      std::vector<double> misses;
      for (const std::vector<double>& residual : left) misses.push_back(residual[b]);
      const double middle = middle_of(misses);
      for (double& miss : misses) miss = std::abs(miss - middle);
      missed[b] = middle;
      misfit += middle * middle / static_cast<double>(bands);
      model.deviation[b] = of_median * middle_of(std::move(misses));
    }
    if (is_shared) misfit = 0.0;
    if (is_shared && round + 1 == rounds_apart) {
      model.missed = missed;
      for (std::vector<double>& residual : left)
        for (std::size_t b = 0; b < bands; ++b) residual[b] -= missed[b];
    }
    for (double& deviation : model.deviation)
      deviation = std::max(least_error, std::sqrt((deviation * deviation + misfit) *
                                                  static_cast<double>(bands) / free));
    std::vector<double> correlations;
    for (const std::vector<double>& residual : left) {
      double product = 0.0, square = 1e-30;
      for (std::size_t b = 0; b + 1 < bands; ++b) {
        const double here = residual[b] / model.deviation[b];
        const double next = residual[b + 1] / model.deviation[b + 1];
        product += here * next;
        square += 0.5 * (here * here + next * next);
      }
      correlations.push_back(product / square);
    }
    correlation = std::clamp(middle_of(std::move(correlations)), 0.0, most_correlation);
    for (double& deviation : model.deviation)
      deviation *= std::sqrt((1.0 + correlation) / (1.0 - correlation));
  }
  return correlation;
}

/// The noise of bands grows to what fits of some pixels leave. Returns that, by the noise before.
/// @param growth  that was used, [band]
std::vector<BandMisfit> grow_errors(LeafPixelModel& model, const Pixels& pixels,
                                    std::vector<double>& growth) {
  constexpr std::size_t most_samples = 1000;
  constexpr int most_rounds = 6;
  constexpr double hardly = 1.02;
  const std::size_t bands = model.spectra.size(), numbers = model.size();
  const std::size_t samples = std::min(most_samples, pixels.leaves.size());
  const std::vector<double> stated = model.deviation;
  growth.assign(bands, 1.0);
  std::vector<BandMisfit> misfit;
  for (int round = 0; round < most_rounds; ++round) {
    std::vector<std::vector<BandMisfit>> parts(samples, std::vector<BandMisfit>(bands));
    parallel_for(
        samples,
        [&](std::size_t i) {
          const std::vector<double> measured =
              pixels.measured(pixels.leaves[i * pixels.leaves.size() / samples]);
          LeafPrediction prediction;
          const LeafFit fit = fit_leaf(model, measured, prediction);
          for (std::size_t b = 0; b < bands; ++b) {
            const detail::LeafCoordinates& by = prediction.by_coordinate[b];
            double leverage = 0.0;
            for (std::size_t n = 0; n < numbers; ++n)
              for (std::size_t m = 0; m < numbers; ++m)
                leverage += by[n] * fit.covariance[n][m] * by[m];
            parts[i][b] = {
                .squares = std::pow((measured[b] - prediction.reflectance[b]) / stated[b], 2),
                .left = std::max(0.0, 1.0 - leverage / std::pow(model.deviation[b], 2)),
                .count = 1.0};
          }
        },
        {});
    misfit.clear();
    for (const std::vector<BandMisfit>& part : parts) add_misfit(misfit, part);
    const std::vector<double> next = error_growth_of(misfit);
    const double change = std::max(largest_ratio(next, growth), largest_ratio(growth, next));
    growth = next;
    for (std::size_t b = 0; b < bands; ++b) model.deviation[b] = stated[b] * growth[b];
    if (change < hardly) break;
  }
  return misfit;
}

/// What chunks of pixels add up, in their order, so that sums are the same for any threads.
struct Sums {
  std::vector<double> squares, misses;  ///< [band]
  DenseMatrix correlation;
};

}  // namespace

std::vector<LeafNumber> leaf_numbers() {
  return {{about("chlorophyll", 35.0, 0.7, 2.0, 120.0), &LeafParameters::chlorophyll},
          {about("carotenoids", 7.0, 0.6, 1.0, 40.0), &LeafParameters::carotenoids},
          {about("anthocyanins", 2.0, 0.8, 1.0, 40.0), &LeafParameters::anthocyanins},
          {about("brown_pigments", 0.03, 0.9, 0.02, 5.0), &LeafParameters::brown_pigments},
          {about("water", 0.012, 0.45, 0.0005, 0.1), &LeafParameters::water},
          {about("dry_matter", 0.005, 0.6, 0.0005, 0.03), &LeafParameters::dry_matter},
          {{.name = "structure",
            .start = 1.7,
            .low = detail::LeafLight::least_structure,
            .high = detail::LeafLight::most_structure,
            .scale = FitScale::logarithmic,
            .prior = FitPrior{1.7, 0.3}},
           &LeafParameters::structure}};
}

FitParameter leaf_illumination() {
  return {.name = "illumination",
          .start = 0.9,
          .low = 0.05,
          .high = 2.0,
          .scale = FitScale::logarithmic,
          .prior = FitPrior{0.9, 0.3}};
}

FitParameter leaf_gloss() {
  return {.name = "gloss", .start = 0.04, .low = 0.0, .high = 1.0, .prior = FitPrior{0.04, 0.05}};
}

LeafMaps fit_leaf_pixels(const Image& image, const std::vector<double>& wavelengths,
                         const LeafPixelOptions& options, const Progress& progress) {
  constexpr double table_end = 0.1, errors_end = 0.2;  // of the work
  check(image, wavelengths, options);
  Pixels pixels = sorted_pixels(image, wavelengths, options);
  if (pixels.leaves.empty())
    throw InvalidInput(
        "leaf pixels: none is of a leaf: all are masked, not finite, dark or at an edge, or have "
        "straight spectra");
  LeafPixelModel model = make_model(wavelengths, options, part_of(progress, 0.0, table_end));
  model.ground = options.ground.empty() ? background_of(pixels) : options.ground;
  LeafMaps result;
  if (options.noise.empty())
    result.residual_correlation =
        find_errors(model, pixels, options.shares_misfit, part_of(progress, table_end, errors_end));
  else
    model.deviation = options.noise;

  result.chi_squared = chi_squared_of(grow_errors(model, pixels, result.error_growth));

  const std::size_t bands = image.channel_count(), numbers = model.size();
  const auto nowhere = [&](std::vector<std::string> channels) {
    Image map = make_image(image.width, image.height, std::move(channels));
    std::ranges::fill(map.pixels, no_number);
    return map;
  };
  for (const FitParameter& parameter : model.parameters)
    result.maps.push_back({parameter, nowhere({"Y"}), nowhere({"Y"})});
  result.width = image.width;
  result.height = image.height;
  result.predicted = nowhere(image.channels);
  result.misfit = nowhere({"Y"});
  const std::size_t leaves = pixels.leaves.size();
  std::vector<Sums> sums((leaves + chunk - 1) / chunk);
  parallel_for(
      sums.size(),
      [&](std::size_t c) {
        Sums& sum = sums[c];
        sum = {std::vector<double>(bands), std::vector<double>(bands),
               DenseMatrix(numbers, numbers)};
        LeafPrediction prediction;
        for (std::size_t i = c * chunk; i < std::min(leaves, (c + 1) * chunk); ++i) {
          const std::size_t pixel = pixels.leaves[i];
          const std::vector<double> measured = pixels.measured(pixel);
          const LeafFit fit = fit_leaf(model, measured, prediction);
          double squares = 0.0;
          for (std::size_t b = 0; b < bands; ++b) {
            const double miss = measured[b] - prediction.reflectance[b];
            result.predicted.pixels[pixel * bands + b] =
                static_cast<float>(prediction.reflectance[b]);
            sum.misses[b] += miss;
            sum.squares[b] += miss * miss;
            squares += miss * miss;
          }
          result.misfit.pixels[pixel] =
              static_cast<float>(std::sqrt(squares / static_cast<double>(bands)));
          for (std::size_t n = 0; n < numbers; ++n) {
            const double deviation = std::sqrt(fit.covariance[n][n]);
            result.maps[n].values.pixels[pixel] =
                static_cast<float>(fit_value(model.parameters[n], fit.coordinates[n]));
            result.maps[n].deviations.pixels[pixel] = static_cast<float>(deviation);
            for (std::size_t m = 0; m < numbers; ++m)
              sum.correlation(n, m) +=
                  fit.covariance[n][m] / (deviation * std::sqrt(fit.covariance[m][m]));
          }
        }
      },
      part_of(progress, errors_end, 1.0));

  result.residual.assign(bands, 0.0);
  result.bias.assign(bands, 0.0);
  result.correlation = DenseMatrix(numbers, numbers);
  const auto count = static_cast<double>(leaves);
  for (const Sums& sum : sums) {
    for (std::size_t b = 0; b < bands; ++b) {
      result.residual[b] += sum.squares[b] / count;
      result.bias[b] += sum.misses[b] / count;
    }
    for (std::size_t i = 0; i < numbers * numbers; ++i)
      result.correlation.values[i] += sum.correlation.values[i] / count;
  }
  for (double& residual : result.residual) residual = std::sqrt(residual);
  for (std::size_t n = 0; n < numbers; ++n) {
    std::vector<double> shares;
    for (const std::size_t pixel : pixels.leaves)
      shares.push_back(static_cast<double>(result.maps[n].deviations.pixels[pixel]) /
                       model.prior_deviation[n]);
    result.maps[n].prior_share = middle_of(std::move(shares));
  }
  result.ground = std::move(model.ground);
  result.noise = std::move(model.deviation);
  result.missed = std::move(model.missed);
  for (const LeafPixelKind kind : pixels.kinds) ++result.counts[static_cast<std::size_t>(kind)];
  result.kinds = std::move(pixels.kinds);
  return result;
}

}  // namespace lamina
