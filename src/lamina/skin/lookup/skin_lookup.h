// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/progress.h"
#include "lamina/skin/fit/least_squares/band_misfit.h"
#include "lamina/skin/fit/skin/skin_fit.h"

namespace lamina {

/// How colors of skin are known.
struct ColorMeasurement {
  DenseMatrix sensor;          ///< weights of the spectrum in a color, [3][wavelength of the table]
  std::vector<double> errors;  ///< of the three channels, relative, in [1e-4, .5]
  bool has_specular = false;   ///< whether what the surface mirrors is part of the color
  /// Factors of the errors by which numbers are found, [channel]; empty: 1. Distances go by errors
  /// as they are stated: what is skin does not become more with them
  std::vector<double> error_growth = {};
};

/// On which side of people's skin a color lies.
enum class ColorSide : std::uint8_t { dark, bright, colored };
inline constexpr std::size_t color_sides = 3;

/// Result of fit_skin for a color.
struct ColorFit {
  static constexpr std::size_t most_numbers = 8;
  std::array<float, most_numbers> values = {};
  std::array<float, most_numbers> deviations = {};  ///< of the coordinates
  /// From the middle of the population to this color, in standard deviations of colors of its
  /// people: the root of chi squared and prior squares together.
  float distance = 0.0f;
  ColorSide side = ColorSide::colored;  ///< the direction in which it lies farthest
};

/// The skin of a color: fits of fit_skin to all colors that skin can have, for millions of pixels.
///
/// Fits on a grid: along brightness, from more melanin than people have to none, and across it,
/// along the axes in which people of equal brightness differ; brought to half its step by cubics
/// and interpolated linearly. For people of the population values differ from those of fits by a
/// fiftieth of their error bar in the median; one color costs .1 µs, the table 2.2 CPU-s.
class SkinLookup {
 public:
  static constexpr int usual_fits = 13;

  /// @param skin        gives what is not found
  /// @param numbers     what is found: of skin_fit_numbers, known to the population
  /// @param fits        along each axis, and twice as many along brightness, in [4, 33]
  /// @throws InvalidInput as fit_skin, for a sensor of another size or errors out of range;
  ///         Interrupted if progress asks to stop.
  SkinLookup(const SkinReflectanceTable& table, const ColorMeasurement& measurement,
             const SkinParameters& skin, std::vector<SkinFitNumber> numbers,
             const SkinPopulation& population, int fits = usual_fits,
             const Progress& progress = {});

  [[nodiscard]] const std::vector<SkinFitNumber>& numbers() const { return numbers_; }
  /// Prior deviations of the coordinates of the numbers, among people.
  [[nodiscard]] const std::vector<double>& prior_deviations() const { return priors_; }

  /// @param color  as the sensor has it, as a fraction of white. What is darker or more colorful
  ///               than the table counts as its nearest color, with a distance beyond skin's.
  [[nodiscard]] ColorFit at(const std::array<float, 3>& color) const;

 private:
  /// Channels of a node: exponents of the numbers, logarithms of deviations, and the distance.
  static constexpr std::size_t channels = 2 * ColorFit::most_numbers + 1;

  /// Two places across and the brightness.
  [[nodiscard]] std::array<float, 3> place(const std::array<float, 3>& color) const;

  std::vector<SkinFitNumber> numbers_;
  std::vector<double> priors_;      ///< standard deviations
  std::vector<float> curve_;        ///< [brightness][channel] logarithms of usual colors
  float low_ = 0.0f, high_ = 0.0f;  ///< brightness
  float brightness_deviation_ = 0.0f, mean_brightness_ = 0.0f;
  std::array<float, 2> end_deviations_ = {};  ///< of brightness beyond the lowest and the highest
  std::array<std::array<float, 3>, 2> axes_ = {};  ///< [axis][channel], to standard deviations
  std::array<std::size_t, 3> nodes_ = {};          ///< along axes and brightness
  std::vector<float> values_;                      ///< [3rd][2nd][1st axis][channel]
};

/// Colors beyond this distance are no skin: of 4392 spectra of nine body areas [Xiao2016] 99.9 %
/// lie within 12.6 of the forearms, grays from 14 on.
inline constexpr double farthest_skin = 12.0;

/// Linear sRGB under D65.
struct ColorSensor {
  std::vector<double> wavelengths;  ///< [nm] 400, 410 to 700
  DenseMatrix weights;              ///< [channel][wavelength]
};
[[nodiscard]] const ColorSensor& srgb_sensor();

/// Misfit to each channel of fits of some colors, those of skin among them, by stated errors. Not
/// by errors that have grown: numbers follow a color nearly everywhere, and skin that is not of the
/// population would all become noise.
/// @param colors  [color][channel]; measurement, skin, numbers and population as in SkinLookup
[[nodiscard]] std::vector<BandMisfit> misfit_of_colors(
    const SkinReflectanceTable& table, const ColorMeasurement& measurement,
    const SkinParameters& skin, const std::vector<SkinFitNumber>& numbers,
    const SkinPopulation& population, std::span<const std::array<float, 3>> colors);

/// Colors of which misfit_of_colors asks: enough for the noise of a channel to 5 %.
inline constexpr std::size_t misfit_colors = 200;

/// Textures of albedo as sRGB: what is known of their colors where nothing else is said.
struct TextureSkin {
  /// @param skin  gives what the forearms' population knows nothing of
  explicit TextureSkin(const SkinParameters& skin);
  /// Factors of the errors of channels that colors of the texture ask for where skin does not meet
  /// them, at least 1.
  [[nodiscard]] std::vector<double> error_growth(
      std::span<const std::array<float, 3>> colors) const;
  /// @param growth  as of error_growth
  [[nodiscard]] SkinLookup lookup(std::vector<double> growth = {},
                                  const Progress& progress = {}) const;

  SkinParameters skin;
  std::vector<SkinFitNumber> numbers;  ///< all that the population knows
  ColorMeasurement measurement;
  SkinReflectanceTable table;  ///< of light from all sides
};
/// The error of a channel of a photograph of which none is stated, relative.
inline constexpr double usual_color_error = 0.005;

}  // namespace lamina
