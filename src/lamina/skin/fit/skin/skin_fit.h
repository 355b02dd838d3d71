// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/skin/fit/least_squares/band_misfit.h"
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"
#include "lamina/skin/fit/skin/skin_population.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"

namespace lamina {

/// Measurement of a uniform place on skin: a spectrum, or a few numbers that a sensor makes
/// of it, such as a color.
struct SkinMeasurement {
  std::vector<double> measured;            ///< fractions of the incident light
  std::vector<double> standard_deviation;  ///< of each, > 0
  /// Weights of the spectrum in each number, [number][wavelength of the table]; empty: the numbers
  /// are the spectrum at those wavelengths.
  DenseMatrix sensor = {};
  bool has_specular = true;  ///< whether what the surface mirrors is part of it, as where the port
                             ///< of an integrating sphere for it is closed
};

struct SkinFit {
  SkinParameters skin;  ///< with what was found
  FitResult fit;
  /// The spectrum that this skin has, [wavelength]; with a population, and what its model misses on
  /// average.
  std::vector<double> spectrum;
};

/// Pigments and scattering of skin from what it reflects, by totals of radiative transfer.
///
/// @param skin        gives what is not fitted; within the range of the table
/// @param numbers     what is fitted: some of skin_fit_numbers
/// @param population  what is known of skin before: priors of the numbers, in place of those that
///                    they have, and how far the model is off; null: nothing
/// @throws InvalidInput as fit_parameters, and for a sensor of another size.
[[nodiscard]] SkinFit fit_skin(const SkinReflectanceTable& table,
                               const SkinMeasurement& measurement, const SkinParameters& skin,
                               const std::vector<SkinFitNumber>& numbers,
                               const SkinPopulation* population = nullptr, FitOptions options = {});

/// Misfit of a fit to each number that was measured, by errors of measurement and model together.
///
/// @param measurement, numbers, population  as fit_skin took them
[[nodiscard]] std::vector<BandMisfit> misfit_of(const SkinFit& fit,
                                                const SkinReflectanceTable& table,
                                                const SkinMeasurement& measurement,
                                                const std::vector<SkinFitNumber>& numbers,
                                                const SkinPopulation* population = nullptr);

}  // namespace lamina
