// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/memory_budget.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/skin/fit/least_squares/fit_parameter.h"

namespace lamina {

/// A number of skin that measurements are fitted with; those of `values` are all set to it, as both
/// saturations are.
struct SkinFitNumber {
  FitParameter parameter;
  std::vector<double SkinParameters::*> values;
};

/// Numbers that the reflectance of a uniform place can tell of skin: melanin, its blend, blood of
/// epidermis and dermis, carotene, saturation, and the scales of scattering and of the baseline.
/// Starts are those of `skin`, ranges those of skin_fit_range.
///
/// The thickness of the epidermis is not among them: with all absorption and scattering divided by
/// it, uniform skin looks the same.
[[nodiscard]] std::vector<SkinFitNumber> skin_fit_numbers(const SkinParameters& skin);

/// The skin with the numbers set to values.
[[nodiscard]] SkinParameters with_numbers(SkinParameters skin,
                                          std::span<const SkinFitNumber> numbers,
                                          std::span<const double> values);

/// Prior of people's skin before it is measured.
struct SkinPopulation {
  std::vector<std::string> names;  ///< of numbers, as in skin_fit_numbers
  std::vector<FitPrior> priors;    ///< [number]
  DenseMatrix correlation;         ///< of the coordinates, [number][number]
  /// Misses of the model: measured less fitted, at ascending wavelengths [nm]: its mean, and
  /// independent components of its scatter, each as large as its standard deviation.
  std::vector<double> wavelengths, missed;
  DenseMatrix missed_components;  ///< [component][wavelength]
};

/// Population of 100 inner forearms of all skin types, 400 to 700 nm, 8 degrees against hemisphere;
/// made by tools/fit/skin_spectra. Source: [Cooksey2017]; the method: [KennedyOHagan2001].
[[nodiscard]] const SkinPopulation& forearm_population();

/// Reads a file of a population; docs/fit.md has the format.
/// @throws FileError if it is missing or unreadable; InvalidInput naming file, line and field.
[[nodiscard]] SkinPopulation load_skin_population(const std::filesystem::path& file,
                                                  MemoryBudget memory = {});

/// Finds the population of the name "forearms", or else of the file of that path.
/// @throws as load_skin_population.
[[nodiscard]] SkinPopulation find_skin_population(const std::string& name_or_path,
                                                  MemoryBudget memory = {});

/// A population as the text of a file that load_skin_population reads back.
/// @param source  of the measurements
[[nodiscard]] std::string format_skin_population(const SkinPopulation& population,
                                                 const std::string& source);

/// A curve over the wavelengths of a population at another wavelength: linear, constant beyond; 0
/// if it has none.
[[nodiscard]] double at_wavelength(const SkinPopulation& population, std::span<const double> curve,
                                   double wavelength);

}  // namespace lamina
