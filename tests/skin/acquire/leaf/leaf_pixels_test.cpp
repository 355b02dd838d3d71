// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/leaf/leaf_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/base/image/files/envi_file.h"
#include "lamina/skin/acquire/leaf/internal/leaf_light.h"
#include "lamina/solve/reflectance/leaf_totals_table.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

constexpr double leaf_ground = 0.1, leaf_noise = 0.005;

double normal_draw(Random& random) {
  return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) *
         std::cos(2.0 * std::numbers::pi * random.uniform());
}

/// Leaves that are drawn from the prior, in bands with noise, over a gray ground; one row
/// of ground.
struct MadeLeaves {
  static constexpr int width = 20, height = 16;
  std::vector<double> wavelengths;
  Image image;
  std::vector<std::vector<double>> truths;  ///< [number][pixel] coordinates
  LeafPixelOptions options;

  MadeLeaves() {
    for (double nm = 420.0; nm < 995.0; nm += 19.0) wavelengths.push_back(nm);
    std::vector<std::string> channels;
    for (const double nm : wavelengths) channels.push_back(std::to_string(nm) + "nm");
    image = make_image(width, height, channels);
    options.incidence.theta = 0.33;
    options.edge = 0;
    options.gloss.prior = FitPrior{0.1, 0.03};  // far from none, which would hold it
    const LeafTotalsTable table(wavelengths, options.incidence, leaf_fit_range({}));
    std::vector<FitParameter> parameters;
    for (const LeafNumber& number : options.numbers) parameters.push_back(number.parameter);
    parameters.insert(parameters.end(), {options.illumination, options.gloss});
    truths.assign(parameters.size(), std::vector<double>(width * height));
    Random random(21);
    for (std::size_t i = 0; i < width * height; ++i) {
      LeafParameters leaf;
      std::vector<double> values;
      for (std::size_t n = 0; n < parameters.size(); ++n) {
        const FitParameter& parameter = parameters[n];
        const double drawn = fit_coordinate(parameter, parameter.prior->mean) +
                             parameter.prior->standard_deviation * normal_draw(random);
        values.push_back(std::clamp(fit_value(parameter, drawn), parameter.low, parameter.high));
        truths[n][i] = fit_coordinate(parameter, values.back());
        if (n < options.numbers.size()) leaf.*options.numbers[n].value = values.back();
      }
      const double illumination = values[values.size() - 2], gloss = values.back();
      for (std::size_t b = 0; b < wavelengths.size(); ++b) {
        const LeafTotalsTable::Totals totals = table.totals(leaf, b);
        const double through = totals.transmittance * totals.transmittance * leaf_ground /
                               (1.0 - leaf_ground * totals.reflectance);
        const double reflected = illumination * (totals.reflectance + through) + gloss;
        image.pixels[i * wavelengths.size() + b] = static_cast<float>(
            (i < width ? leaf_ground : reflected) + leaf_noise * normal_draw(random));
      }
    }
  }
};
const MadeLeaves& made_leaves() {
  static const MadeLeaves each;
  return each;
}

/// The share of pixels whose coordinate is within a standard deviation of the truth.
double leaf_coverage(const LeafMaps& maps, std::size_t number) {
  double covered = 0.0, count = 0.0;
  for (std::size_t i = 0; i < maps.kinds.size(); ++i) {
    if (maps.kinds[i] != LeafPixelKind::leaf) continue;
    const LeafMap& map = maps.maps[number];
    const double found = fit_coordinate(map.parameter, static_cast<double>(map.values.pixels[i]));
    covered += std::abs(found - made_leaves().truths[number][i]) <
               static_cast<double>(map.deviations.pixels[i]);
    count += 1.0;
  }
  return covered / count;
}

TEST(LeafPixels, FindLeavesWithinTheirErrors) {
  LeafPixelOptions options = made_leaves().options;
  options.noise.assign(made_leaves().wavelengths.size(), leaf_noise);
  const LeafMaps maps = fit_leaf_pixels(made_leaves().image, made_leaves().wavelengths, options);
  EXPECT_EQ(maps.counts[static_cast<std::size_t>(LeafPixelKind::background)], 20U);
  EXPECT_GE(maps.counts[0], 290U);  // but for leaves in the dark
  for (const double reflectance : maps.ground) EXPECT_NEAR(reflectance, leaf_ground, 0.006);
  double mean = 0.0;
  for (std::size_t n = 0; n < maps.maps.size(); ++n) {
    const double share = leaf_coverage(maps, n);
    EXPECT_GT(share, 0.60) << maps.maps[n].parameter.name;
    EXPECT_LT(share, 0.76) << maps.maps[n].parameter.name;
    mean += share / static_cast<double>(maps.maps.size());
  }
  EXPECT_NEAR(mean, 0.683, 0.03);
  // What the bands tell, and what they do not
  EXPECT_LT(maps.maps[0].prior_share, 0.2);
  EXPECT_EQ(maps.maps[5].parameter.name, "dry_matter");
  EXPECT_GT(maps.maps[5].prior_share, 0.8);
  for (const double residual : maps.residual)
    EXPECT_NEAR(residual, 0.85 * leaf_noise, 0.25 * leaf_noise);
  EXPECT_TRUE(std::isnan(maps.predicted.pixels[0]));
  EXPECT_NEAR(maps.correlation(3, 3), 1.0, 1e-6);
}

// Noise that is understated by three grows to what it is.
TEST(LeafPixels, ErrorsGrowToWhatIsLeft) {
  LeafPixelOptions options = made_leaves().options;
  options.noise.assign(made_leaves().wavelengths.size(), leaf_noise / 3.0);
  const LeafMaps maps = fit_leaf_pixels(made_leaves().image, made_leaves().wavelengths, options);
  double mean = 0.0, chi_squared = 0.0;
  for (std::size_t n = 0; n < maps.maps.size(); ++n)
    mean += leaf_coverage(maps, n) / static_cast<double>(maps.maps.size());
  for (const double each : maps.chi_squared)
    chi_squared += each / static_cast<double>(maps.chi_squared.size());
  EXPECT_NEAR(mean, 0.683, 0.04);
  EXPECT_NEAR(chi_squared, 9.0, 1.0);
  for (std::size_t b = 0; b < maps.noise.size(); ++b)
    EXPECT_NEAR(maps.noise[b], leaf_noise, 0.2 * leaf_noise);
}

// Values and derivatives, beside the slower table's.
TEST(LeafLight, IsThatOfTheTable) {
  const std::vector<double> wavelengths = {440.0, 550.0, 690.0, 720.0, 850.0, 970.0};
  const Incidence incidence = {.theta = 0.33};
  const LeafTotalsTable table(wavelengths, incidence, leaf_fit_range({}));
  const detail::LeafLight light({}, 14.0, incidence, {});
  const std::array numbers = {&LeafParameters::chlorophyll, &LeafParameters::structure};
  Random random(4);
  for (int i = 0; i < 600; ++i) {
    const LeafParameters leaf = {.chlorophyll = 100.0 * random.uniform(),
                                 .water = 0.05 * random.uniform(),
                                 .structure = 0.4 * std::pow(20.0, random.uniform())};
    const std::size_t w = static_cast<std::size_t>(i) % wavelengths.size();
    std::array<LeafTotalsTable::Totals, 2> by;
    const LeafTotalsTable::Totals totals = table.totals(leaf, w, numbers, by);
    const LeafSpectrum spectrum = leaf_spectrum(wavelengths[w]);
    const detail::LeafLight::Value value =
        light.at(leaf_absorption(leaf, spectrum), leaf.structure);
    EXPECT_NEAR(value.reflectance, totals.reflectance, 2e-4);
    EXPECT_NEAR(value.transmittance, totals.transmittance, 2e-4);
    EXPECT_NEAR(value.by_absorption[0] * spectrum.chlorophyll, by[0].reflectance, 1e-3);
    EXPECT_NEAR(value.by_absorption[1] * spectrum.chlorophyll, by[0].transmittance, 1e-3);
    EXPECT_NEAR(value.by_structure[0], by[1].reflectance, 0.005);
    EXPECT_NEAR(value.by_structure[1], by[1].transmittance, 0.005);
  }
}

TEST(LeafPixels, FindTheirNoise) {
  const LeafMaps maps =
      fit_leaf_pixels(made_leaves().image, made_leaves().wavelengths, made_leaves().options);
  double mean = 0.0;
  for (const double deviation : maps.noise)
    mean += deviation / static_cast<double>(maps.noise.size());
  EXPECT_NEAR(mean, leaf_noise, 0.15 * leaf_noise);
  EXPECT_LT(maps.residual_correlation, 0.1);
}

// A ripple from band to band that no leaf has
TEST(LeafPixels, TakeOffWhatTheyMissAlike) {
  constexpr double ripple = 0.01;
  Image image = made_leaves().image;
  const std::size_t bands = made_leaves().wavelengths.size();
  for (std::size_t i = MadeLeaves::width * bands; i < image.pixels.size(); ++i)
    image.pixels[i] += static_cast<float>(i % bands % 2 == 0 ? ripple : -ripple);
  LeafPixelOptions options = made_leaves().options;
  const auto mean_error = [&] {
    double mean = 0.0;
    const LeafMaps maps = fit_leaf_pixels(image, made_leaves().wavelengths, options);
    for (const double deviation : maps.noise) mean += deviation / static_cast<double>(bands);
    for (std::size_t b = 0; b < bands && options.shares_misfit; ++b)
      EXPECT_NEAR(maps.missed[b], b % 2 == 0 ? ripple : -ripple, 0.6 * ripple);
    return mean;
  };
  EXPECT_GT(mean_error(), 0.9 * std::hypot(leaf_noise, ripple));
  options.shares_misfit = true;
  EXPECT_NEAR(mean_error(), leaf_noise, 0.15 * leaf_noise);
  options.noise.assign(bands, leaf_noise);
  EXPECT_THROW((void)fit_leaf_pixels(image, made_leaves().wavelengths, options), InvalidInput);
}

TEST(LeafPixels, KeepToTheMaskAndToFiniteNumbers) {
  Image image = made_leaves().image;
  image.at(3, 5)[7] = std::nanf("");
  LeafPixelOptions options = made_leaves().options;
  options.noise.assign(made_leaves().wavelengths.size(), leaf_noise);
  options.mask = make_pixel_mask(image.width, image.height);
  for (int y = 3; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (x > 4) options.mask->mark(options.mask->index(x, y), PixelFault::excluded);
  options.edge = 1;
  const LeafMaps maps = fit_leaf_pixels(image, made_leaves().wavelengths, options);
  EXPECT_EQ(maps.counts[static_cast<std::size_t>(LeafPixelKind::unused)], 13U * 15U + 1U);
  EXPECT_GE(maps.counts[static_cast<std::size_t>(LeafPixelKind::edge)], 20U);
  EXPECT_TRUE(std::isnan(*maps.maps[0].values.at(3, 5)));
  EXPECT_TRUE(std::isfinite(*maps.maps[0].values.at(3, 7)));
}

// A second witness: adding-doubling of the leaf on the ground, and the fit's own prediction.
TEST(LeafPixels, ReflectWhatAddingDoublingSays) {
  const LeafParameters leaf = {.chlorophyll = 25.0, .structure = 1.4};
  const double behind = 0.1;
  const std::vector<double> wavelengths = made_leaves().wavelengths;
  Image image = make_image(1, 1, made_leaves().image.channels);
  for (std::size_t b = 0; b < wavelengths.size(); ++b) {
    const std::array<Layer, 2> layers = leaf_layers(leaf, leaf_spectrum(wavelengths[b]));
    const LayerStack stack({layers.begin(), layers.end()}, 1.0, 1.0,
                           {.top = {}, .reflectance = behind});
    const SlabTotals totals = adding_doubling(stack, {}).totals;
    image.pixels[b] = static_cast<float>(0.8 * totals.diffuse_reflectance + 0.05);
  }
  LeafPixelOptions options;
  options.numbers = {options.numbers[0], options.numbers[6]};
  options.leaf = leaf;
  options.ground.assign(wavelengths.size(), behind);
  options.noise.assign(wavelengths.size(), 1e-4);
  const LeafMaps maps = fit_leaf_pixels(image, wavelengths, options);
  EXPECT_NEAR(maps.maps[0].values.pixels[0], 25.0, 0.1);
  EXPECT_NEAR(maps.maps[1].values.pixels[0], 1.4, 0.02);
  EXPECT_NEAR(maps.maps[2].values.pixels[0], 0.8, 0.01);
  EXPECT_NEAR(maps.maps[3].values.pixels[0], 0.05, 0.001);
  EXPECT_LT(maps.misfit.pixels[0], 5e-4);
}

TEST(LeafPixels, RefuseWhatTheyCannotFit) {
  const auto refuses = [](const Image& image, std::vector<double> wavelengths,
                          const LeafPixelOptions& options, const std::string& text) {
    try {
      (void)fit_leaf_pixels(image, wavelengths, options);
      ADD_FAILURE() << text;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  };
  const Image& image = made_leaves().image;
  const std::vector<double>& wavelengths = made_leaves().wavelengths;
  refuses(image, {500.0}, {}, "a wavelength for each of");
  std::vector<double> infrared = wavelengths;
  infrared[0] = 1200.0;
  refuses(image, infrared, {}, "but one is 1200");
  refuses(make_image(2, 2, {"a", "b", "c"}), {500.0, 600.0, 700.0}, {}, "need as many bands");
  refuses(make_image(2, 2, image.channels), wavelengths, {}, "none is of a leaf");
  LeafPixelOptions options;
  options.numbers[1].parameter.prior.reset();
  refuses(image, wavelengths, options, "carotenoids must have a prior");
  options = {};
  options.numbers[1].value = &LeafParameters::palisade_share;
  refuses(image, wavelengths, options, "cannot be free");
  options = {};
  options.numbers[0].parameter.high = std::numeric_limits<double>::infinity();
  refuses(image, wavelengths, options, "chlorophyll must lie within [0, 200]");
  options = {};
  options.leaf.structure = std::nan("");
  refuses(image, wavelengths, options, "structure must lie within");
  options = {};
  options.ground.assign(wavelengths.size(), 1.5);
  refuses(image, wavelengths, options, "ground must lie in [0, 1], but is 1.5");
  options = {};
  options.noise = {0.01};
  refuses(image, wavelengths, options, "noise must have a number for each of");
  options = {};
  options.mask = make_pixel_mask(3, 3);
  refuses(image, wavelengths, options, "mask");
  EXPECT_THROW((void)fit_leaf_pixels(image, wavelengths, {}, [](double) { return false; }),
               Interrupted);
}

// Photographs of real leaves, where they are at hand.
TEST(LeafPixels, FitPhotographsOfLeaves) {
  const std::filesystem::path file =
      std::filesystem::path(LAMINA_SHARED_DATA) / "images/leaf_laurel_vnir.hdr";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  EnviSelection selection;
  std::vector<double> wavelengths;
  for (double nm = 427.5; nm < 990.0; nm += 15.0) {
    wavelengths.push_back(nm);
    selection.bands.push_back({.wavelength = nm, .shape = EnviBandShape::box, .width = 15.0});
  }
  selection.rectangle = PixelRectangle{.x = 60, .y = 4, .width = 40, .height = 32};
  MemoryBudget memory;
  LeafPixelOptions options;
  options.ground.assign(wavelengths.size(), 0.09);
  options.incidence.theta = 19.0 / 180.0 * std::numbers::pi;
  const LeafMaps maps = fit_leaf_pixels(load_envi(file, selection, memory), wavelengths, options);
  EXPECT_GT(maps.counts[0], 900U);
  double least = 1e9, most = 0.0, squares = 0.0;
  for (const double residual : maps.residual)
    squares += residual * residual / static_cast<double>(maps.residual.size());
  EXPECT_LT(std::sqrt(squares), 0.015);
  for (const float value : maps.maps[0].values.pixels)
    if (std::isfinite(value)) {
      least = std::min(least, static_cast<double>(value));
      most = std::max(most, static_cast<double>(value));
    }
  EXPECT_LT(least, 8.0);  // yellow spots
  EXPECT_GT(most, 28.0);
}

}  // namespace
}  // namespace lamina
