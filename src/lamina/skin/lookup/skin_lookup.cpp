// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/lookup/skin_lookup.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/symmetric_eigen.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/skin/acquire/bands/band_choice.h"
#include "lamina/skin/lookup/internal/node_blend.h"

namespace lamina {
namespace {

/// Along the axes of what is not brightness, in standard deviations of the population.
constexpr double half_box = 8.0;
constexpr int drawn_people = 400;
constexpr double largest_error = 0.5;  // relative
constexpr float darkest = 1e-4f;       ///< channel; what is below counts as that
/// The range of brightness: skin without melanin, this much brighter, to skin of this melanin.
constexpr double brighter = 0.5, most_melanin = 0.4;
const FitOptions fit_options{.max_iterations = 20, .tolerance = 1e-3};

using LogColor = std::array<double, 3>;
double brightness_of(const LogColor& logs) { return (logs[0] + logs[1] + logs[2]) / 3.0; }

std::vector<double> color_of(const DenseMatrix& sensor, std::span<const double> spectrum) {
  std::vector<double> color(sensor.rows, 0.0);
  for (std::size_t c = 0; c < sensor.rows; ++c)
    for (std::size_t w = 0; w < sensor.columns; ++w) color[c] += sensor(c, w) * spectrum[w];
  return color;
}

/// What the sensor sees of skin.
LogColor log_color_of(const SkinReflectanceTable& table, const ColorMeasurement& measurement,
                      const SkinParameters& skin) {
  std::vector<double> spectrum = table.reflectance(skin);
  for (double& r : spectrum) r += measurement.has_specular ? table.specular_reflectance() : 0.0;
  const std::vector<double> color = color_of(measurement.sensor, spectrum);
  LogColor logs;
  for (std::size_t c = 0; c < 3; ++c)
    logs[c] = std::log(std::max(color[c], static_cast<double>(darkest)));
  return logs;
}

/// Colors of the mean person with more and more melanin, from dark to bright.
std::vector<LogColor> colors_over_melanin(const SkinReflectanceTable& table,
                                          const ColorMeasurement& measurement,
                                          const SkinParameters& skin,
                                          const SkinPopulation& population) {
  SkinParameters mean = skin;
  for (const SkinFitNumber& number : skin_fit_numbers(skin)) {
    const auto known = std::ranges::find(population.names, number.parameter.name);
    if (known == population.names.end()) continue;
    for (double SkinParameters::*const value : number.values)
      mean.*value =
          population.priors[static_cast<std::size_t>(known - population.names.begin())].mean;
  }
  constexpr int steps = 60;
  std::vector<LogColor> colors;
  for (int i = steps; i >= 0; --i) {
    mean.melanin = most_melanin * std::pow(static_cast<double>(i) / steps, 3);
    colors.push_back(log_color_of(table, measurement, mean));
  }
  LogColor past = colors.back();
  for (double& log : past) log += brighter;
  colors.push_back(past);
  return colors;
}

/// Of ascending brightness, the color of one.
LogColor color_at(const std::vector<LogColor>& colors, double brightness) {
  const auto above = std::ranges::upper_bound(colors, brightness, {}, brightness_of);
  const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      above - colors.begin(), 1, static_cast<std::ptrdiff_t>(colors.size()) - 1));
  const double low = brightness_of(colors[i - 1]), high = brightness_of(colors[i]);
  const double share = std::clamp((brightness - low) / (high - low), 0.0, 1.0);
  LogColor color;
  for (std::size_t c = 0; c < 3; ++c) color[c] = std::lerp(colors[i - 1][c], colors[i][c], share);
  return color;
}

/// How people of equal brightness differ: two axes, [axis][channel], each as long as its standard
/// deviation; and the standard deviation and mean of
/// brightness.
struct ColorSpread {
  std::array<LogColor, 2> axes = {};
  double brightness = 0.0, mean_brightness = 0.0;
};
ColorSpread spread_of_people(const SkinReflectanceTable& table, const ColorMeasurement& measurement,
                             const std::vector<LogColor>& curve, const SkinPopulation& population) {
  DenseMatrix covariance(3, 3);
  std::vector<double> brightness;
  for (const SkinParameters& person : draw_skins(population, drawn_people, 1)) {
    const LogColor logs = log_color_of(table, measurement, person);
    brightness.push_back(brightness_of(logs));
    const LogColor usual = color_at(curve, brightness.back());
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        covariance(a, b) += (logs[a] - usual[a]) * (logs[b] - usual[b]) / drawn_people;
  }
  const SymmetricEigen eigen = symmetric_eigen(covariance);  // the least: 0, of brightness
  const double least = *std::ranges::min_element(measurement.errors);
  ColorSpread spread;
  for (std::size_t a = 0; a < 2; ++a)
    for (std::size_t c = 0; c < 3; ++c)
      spread.axes[a][c] =
          std::sqrt(std::max(eigen.values[a + 1], least * least)) * eigen.vectors(c, a + 1);
  for (const double each : brightness) spread.mean_brightness += each / drawn_people;
  for (const double each : brightness)
    spread.brightness += std::pow(each - spread.mean_brightness, 2) / drawn_people;
  spread.brightness = std::sqrt(spread.brightness);
  return spread;
}

/// How much further colors of one brightness lie apart in dark skin than in that of people in the
/// mean: moles, and people that the population does not know.
template <class T>
T widening(T brightness, T mean) {
  return std::clamp(T{1} + static_cast<T>(0.4) * (mean - brightness), T{1}, T{2});
}

/// A function on a grid of three axes, on one of half the step: by cubics through four nodes, at
/// the ends by lines.
/// @param nodes  along the first, second and third axis
std::vector<float> halved_steps(std::vector<float> values,
                                const std::array<std::size_t, 3>& nodes) {
  for (const std::size_t n : nodes) {  // the first becomes the last, three times
    const std::size_t m = 2 * n - 1;
    const std::size_t lines = values.size() / n;
    std::vector<float> next(lines * m);
    for (std::size_t line = 0; line < lines; ++line) {
      const float* from = values.data() + line * n;
      for (std::size_t i = 0; i < n; ++i) next[2 * i * lines + line] = from[i];
      for (std::size_t i = 0; i + 1 < n; ++i) {
        const float mean = 0.5f * (from[i] + from[i + 1]);
        const bool has_four = i > 0 && i + 2 < n;
        next[(2 * i + 1) * lines + line] =
            has_four ? 1.125f * mean - 0.0625f * (from[i - 1] + from[i + 2]) : mean;
      }
    }
    values = std::move(next);
  }
  return values;
}

/// What nodes have of a value: its coordinate, turned about for shares, whose value then takes the
/// exponential of this, too.
double exponent(const FitParameter& parameter, double value) {
  const double coordinate = fit_coordinate(parameter, value);
  return parameter.scale == FitScale::logit ? -coordinate : coordinate;
}

/// The value of an exponent: fit_value, of what is known already.
float value_of(const FitParameter& parameter, float exponent, float exponential) {
  const auto low = static_cast<float>(parameter.low), high = static_cast<float>(parameter.high);
  switch (parameter.scale) {
    case FitScale::logarithmic:
      return std::clamp(exponential - static_cast<float>(parameter.offset), low, high);
    case FitScale::logit:
      return low + (high - low) / (1.0f + exponential);
    case FitScale::linear:
      break;
  }
  return exponent;
}

void check(const SkinReflectanceTable& table, const ColorMeasurement& measurement,
           const std::vector<SkinFitNumber>& numbers, int fits) {
  if (fits < 4 || fits > 33)
    throw InvalidInput("fits: must be in [4, 33], but is " + std::to_string(fits));
  if (measurement.sensor.rows != 3 || measurement.sensor.columns != table.wavelengths().size())
    throw InvalidInput("sensor: must have 3 rows and a column for each of " +
                       std::to_string(table.wavelengths().size()) + " wavelengths, but has " +
                       std::to_string(measurement.sensor.rows) + " and " +
                       std::to_string(measurement.sensor.columns));
  if (measurement.errors.size() != 3)
    throw InvalidInput("errors: must be 3, but are " + std::to_string(measurement.errors.size()));
  for (const double error : measurement.errors)
    if (!(1e-4 <= error && error <= largest_error))
      throw InvalidInput("errors: must be in [1e-4, 0.5], but one is " + number_text(error));
  for (const double factor : measurement.error_growth)
    if (!(factor >= 1.0 && std::isfinite(factor)))
      throw InvalidInput("error_growth: must be >= 1, but one is " + number_text(factor));
  if (!measurement.error_growth.empty() && measurement.error_growth.size() != 3)
    throw InvalidInput("error_growth: must be 3, but are " +
                       std::to_string(measurement.error_growth.size()));
  if (numbers.empty() || numbers.size() > ColorFit::most_numbers)
    throw InvalidInput("numbers: must be 1 to " + std::to_string(ColorFit::most_numbers) +
                       ", but are " + std::to_string(numbers.size()));
}

}  // namespace

SkinLookup::SkinLookup(const SkinReflectanceTable& table, const ColorMeasurement& measurement,
                       const SkinParameters& skin, std::vector<SkinFitNumber> numbers,
                       const SkinPopulation& population, int fits, const Progress& progress)
    : numbers_(std::move(numbers)) {
  check(table, measurement, numbers_, fits);
  const std::vector<LogColor> curve = colors_over_melanin(table, measurement, skin, population);
  const ColorSpread spread = spread_of_people(table, measurement, curve, population);
  const double low = brightness_of(curve.front()), high = brightness_of(curve.back());
  constexpr std::size_t curve_points = 128;
  for (std::size_t i = 0; i < curve_points; ++i) {
    const LogColor color =
        color_at(curve, std::lerp(low, high, static_cast<double>(i) / (curve_points - 1)));
    for (std::size_t c = 0; c < 3; ++c) curve_.push_back(static_cast<float>(color[c]));
  }
  low_ = static_cast<float>(low);
  high_ = static_cast<float>(high);
  brightness_deviation_ = static_cast<float>(spread.brightness);
  mean_brightness_ = static_cast<float>(spread.mean_brightness);
  for (std::size_t a = 0; a < 2; ++a) {
    double squares = 0.0;
    for (const double each : spread.axes[a]) squares += each * each;
    for (std::size_t c = 0; c < 3; ++c)
      axes_[a][c] = static_cast<float>(spread.axes[a][c] / squares);
  }
  for (const SkinFitNumber& number : numbers_) {
    const auto known = std::ranges::find(population.names, number.parameter.name);
    if (known == population.names.end())
      throw InvalidInput(number.parameter.name + ": the population knows nothing of it");
    priors_.push_back(population.priors[static_cast<std::size_t>(known - population.names.begin())]
                          .standard_deviation);
  }
  const auto n = static_cast<std::size_t>(fits), along = 2 * n - 1;  // of brightness
  std::vector<std::vector<float>> found(channels);                   // empty: of no number
  const auto deviations_from = static_cast<std::size_t>(ColorFit::most_numbers);
  for (std::size_t p = 0; p < numbers_.size(); ++p)
    for (const std::size_t channel : {p, deviations_from + p}) found[channel].resize(n * n * along);
  found.back().resize(n * n * along);
  const auto fit_of = [&](const LogColor& color, const std::vector<double>& growth) {
    SkinMeasurement seen{.measured = std::vector<double>(3),
                         .standard_deviation = std::vector<double>(3),
                         .sensor = measurement.sensor,
                         .has_specular = measurement.has_specular};
    for (std::size_t c = 0; c < 3; ++c) {
      seen.measured[c] = std::exp(color[c]);
      const double error = measurement.errors[c] * (growth.empty() ? 1.0 : growth[c]);
      seen.standard_deviation[c] = std::min(largest_error, error) * seen.measured[c];
    }
    return fit_skin(table, seen, skin, numbers_, &population, fit_options).fit;
  };
  const auto distance_of = [](const FitResult& fit) {
    return std::sqrt(fit.chi_squared + fit.prior_squares);
  };
  const bool has_grown = largest_ratio(measurement.error_growth, {}) > 1.0;
  // Beyond the ends distances grow as those of fits do there.
  for (const std::size_t end : {0u, 1u}) {
    const LogColor& last = end == 0 ? curve.front() : curve.back();
    LogColor past = last;
    for (double& log : past) log += (end == 0 ? -1.0 : 1.0) * spread.brightness;
    const double squares =
        std::pow(distance_of(fit_of(past, {})), 2) - std::pow(distance_of(fit_of(last, {})), 2);
    end_deviations_[end] =
        static_cast<float>(spread.brightness / std::sqrt(std::max(1.0, squares)));
  }
  const auto fit_at = [&](std::size_t i) {
    const auto place_of = [&](std::size_t node) {
      return half_box * (2.0 * static_cast<double>(node) / static_cast<double>(n - 1) - 1.0);
    };
    const LogColor usual = color_at(
        curve,
        std::lerp(low, high, static_cast<double>(i / (n * n)) / static_cast<double>(along - 1)));
    std::array<double, 2> at = {place_of(i % n), place_of(i / n % n)};
    const double distance = std::hypot(at[0], at[1]);
    const double wide = widening(brightness_of(usual), spread.mean_brightness);
    for (double& x : at)
      x *= wide * std::min(1.0, half_box / distance);  // corners: no color of skin
    LogColor color;
    for (std::size_t c = 0; c < 3; ++c)
      color[c] = usual[c] + at[0] * spread.axes[0][c] + at[1] * spread.axes[1][c];
    const FitResult fit = fit_of(color, measurement.error_growth);
    for (std::size_t p = 0; p < numbers_.size(); ++p) {
      const FittedParameter& number = fit.parameters[p];
      found[p][i] = static_cast<float>(exponent(numbers_[p].parameter, number.value));
      found[deviations_from + p][i] = static_cast<float>(std::log(
          number.is_at_bound ? priors_[p] : std::min(priors_[p], number.standard_deviation)));
    }
    found.back()[i] = static_cast<float>(distance_of(has_grown ? fit_of(color, {}) : fit));
  };
  parallel_for(n * n * along, fit_at, progress);

  nodes_ = {2 * n - 1, 2 * n - 1, 2 * along - 1};
  values_.resize(nodes_[0] * nodes_[1] * nodes_[2] * channels);
  for (std::size_t channel = 0; channel < channels; ++channel) {
    if (found[channel].empty()) continue;
    const std::vector<float> fine = halved_steps(std::move(found[channel]), {n, n, along});
    for (std::size_t i = 0; i < fine.size(); ++i) values_[i * channels + channel] = fine[i];
  }
}

std::array<float, 3> SkinLookup::place(const std::array<float, 3>& color) const {
  std::array<float, 3> logs;
  for (std::size_t c = 0; c < 3; ++c) logs[c] = std::log(std::max(color[c], darkest));
  const float brightness = (logs[0] + logs[1] + logs[2]) / 3.0f;
  const float last = static_cast<float>(curve_.size() / 3 - 1);
  const float step = std::clamp((brightness - low_) / (high_ - low_), 0.0f, 1.0f) * last;
  const std::size_t point = std::min(static_cast<std::size_t>(step), curve_.size() / 3 - 2);
  const float share = step - static_cast<float>(point);
  std::array<float, 3> at = {0.0f, 0.0f, brightness};
  for (std::size_t c = 0; c < 3; ++c) {
    const float usual = std::lerp(curve_[3 * point + c], curve_[3 * point + 3 + c], share);
    for (std::size_t a = 0; a < 2; ++a) at[a] += (logs[c] - usual) * axes_[a][c];
  }
  for (std::size_t a = 0; a < 2; ++a) at[a] /= widening(brightness, mean_brightness_);
  return at;
}

ColorFit SkinLookup::at(const std::array<float, 3>& color) const {
  const std::array<float, 3> at = place(color);
  constexpr auto half = static_cast<float>(half_box);
  const std::array<float, 3> low = {-half, -half, low_}, high = {half, half, high_};
  const std::array<float, 3> deviation = {1.0f, 1.0f, end_deviations_[at[2] < low_ ? 0 : 1]};
  static_assert(channels == lookup_detail::node_numbers + 1);
  std::array<std::size_t, 3> node;
  std::array<float, 3> between;
  float beyond = 0.0f;  // the box, squared
  for (std::size_t a = 0; a < 3; ++a) {
    const float inside = std::clamp(at[a], low[a], high[a]);
    const float outside = (at[a] - inside) / deviation[a];
    beyond += outside * outside;
    const float step = (inside - low[a]) / (high[a] - low[a]) * static_cast<float>(nodes_[a] - 1);
    node[a] = std::min(static_cast<std::size_t>(step), nodes_[a] - 2);
    between[a] = step - static_cast<float>(node[a]);
  }
  std::array<const float*, 8> nodes;
  std::array<float, 8> weights;
  float within = 0.0f;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    std::size_t i = 0;
    float weight = 1.0f;
    for (std::size_t a = 3; a-- > 0;) {
      const std::size_t up = corner >> a & 1;
      i = i * nodes_[a] + node[a] + up;
      weight *= up ? between[a] : 1.0f - between[a];
    }
    nodes[corner] = values_.data() + i * channels;
    weights[corner] = weight;
    within += weight * nodes[corner][channels - 1];
  }
  lookup_detail::NodeBlend blend;
  lookup_detail::blend_nodes(nodes, weights, blend);
  ColorFit fit;
  for (std::size_t p = 0; p < numbers_.size(); ++p) {
    fit.values[p] = value_of(numbers_[p].parameter, blend.sums[p], blend.exponentials[p]);
    fit.deviations[p] = blend.exponentials[ColorFit::most_numbers + p];
  }
  within = std::max(within, 0.0f);
  fit.distance = std::sqrt(within * within + beyond);
  const float along = (at[2] - mean_brightness_) / brightness_deviation_;
  if (std::abs(along) >= std::hypot(at[0], at[1]))
    fit.side = along < 0.0f ? ColorSide::dark : ColorSide::bright;
  return fit;
}

const ColorSensor& srgb_sensor() {
  static const ColorSensor sensor = [] {
    ColorSensor made;
    for (double nm = 400.0; nm <= 700.0; nm += 10.0) made.wavelengths.push_back(nm);
    const BandWeights weights = make_band_weights(BandSet(made.wavelengths));
    made.weights = DenseMatrix(3, made.wavelengths.size());
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t w = 0; w < made.wavelengths.size(); ++w) made.weights(c, w) = weights[w][c];
    return made;
  }();
  return sensor;
}

std::vector<BandMisfit> misfit_of_colors(const SkinReflectanceTable& table,
                                         const ColorMeasurement& measurement,
                                         const SkinParameters& skin,
                                         const std::vector<SkinFitNumber>& numbers,
                                         const SkinPopulation& population,
                                         std::span<const std::array<float, 3>> colors) {
  std::vector<std::vector<BandMisfit>> parts(colors.size());
  parallel_for(colors.size(), [&](std::size_t i) {
    SkinMeasurement seen{.measured = {colors[i].begin(), colors[i].end()},
                         .standard_deviation = {},
                         .sensor = measurement.sensor,
                         .has_specular = measurement.has_specular};
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(seen.measured[c] > 0.0)) return;
      seen.standard_deviation.push_back(measurement.errors[c] * seen.measured[c]);
    }
    const SkinFit found = fit_skin(table, seen, skin, numbers, &population, fit_options);
    if (std::sqrt(found.fit.chi_squared + found.fit.prior_squares) <= farthest_skin)
      parts[i] = misfit_of(found, table, seen, numbers, &population);
  });
  std::vector<BandMisfit> misfit;
  for (const std::vector<BandMisfit>& part : parts) add_misfit(misfit, part);
  return misfit;
}

TextureSkin::TextureSkin(const SkinParameters& given)
    : skin(given),
      measurement{.sensor = srgb_sensor().weights, .errors = std::vector(3, usual_color_error)},
      table(srgb_sensor().wavelengths, {.is_diffuse = true}, skin_fit_range(given)) {
  const std::vector<std::string>& known = forearm_population().names;
  for (const SkinFitNumber& number : skin_fit_numbers(skin))
    if (std::ranges::count(known, number.parameter.name) > 0) numbers.push_back(number);
}

std::vector<double> TextureSkin::error_growth(std::span<const std::array<float, 3>> colors) const {
  return error_growth_of(
      misfit_of_colors(table, measurement, skin, numbers, forearm_population(), colors));
}

SkinLookup TextureSkin::lookup(std::vector<double> growth, const Progress& progress) const {
  ColorMeasurement grown = measurement;
  grown.error_growth = std::move(growth);
  return {table, grown, skin, numbers, forearm_population(), SkinLookup::usual_fits, progress};
}

}  // namespace lamina
