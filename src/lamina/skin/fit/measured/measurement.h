// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/memory_budget.h"
#include "lamina/base/io/json_file.h"
#include "lamina/base/spectrum/band_set.h"
#include "lamina/layers/materials/material.h"
#include "lamina/skin/fit/least_squares/fit_parameter.h"
#include "lamina/skin/fit/skin/skin_population.h"
#include "lamina/solve/integrating_sphere/integrating_sphere.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

template <>
inline constexpr auto enum_names<FitScale> =
    std::to_array<EnumName<FitScale>>({{"linear", FitScale::linear},
                                       {"logarithmic", FitScale::logarithmic},
                                       {"logit", FitScale::logit}});

/// Kind of a measurement, as measurement files name it.
enum class MeasurementKind {
  totals,              ///< fractions of the light that leave above and below
  spatial_frequency,   ///< the same of light in waves, k
  radial_profile,      ///< what leaves around a narrow beam, r
  time_resolved,       ///< the same after a short pulse, over time too
  frequency_modulated  ///< amplitude and phase of the same, of a beam that is modulated in time
};

template <>
inline constexpr auto enum_names<MeasurementKind> = std::to_array<EnumName<MeasurementKind>>(
    {{"totals", MeasurementKind::totals},
     {"spatial_frequency", MeasurementKind::spatial_frequency},
     {"radial_profile", MeasurementKind::radial_profile},
     {"time_resolved", MeasurementKind::time_resolved},
     {"frequency_modulated", MeasurementKind::frequency_modulated}});

enum class MeasuredQuantity {
  reflectance,
  transmittance,
  unscattered_transmittance,
  amplitude,  ///< of modulated light that leaves
  phase       ///< by which it lags [degrees]
};

template <>
inline constexpr auto enum_names<MeasuredQuantity> = std::to_array<EnumName<MeasuredQuantity>>(
    {{"reflectance", MeasuredQuantity::reflectance},
     {"transmittance", MeasuredQuantity::transmittance},
     {"unscattered_transmittance", MeasuredQuantity::unscattered_transmittance},
     {"amplitude", MeasuredQuantity::amplitude},
     {"phase_deg", MeasuredQuantity::phase}});

/// One number that was measured: a fraction, or 1/mm² of a profile, 1/(mm² ps) over time.
struct MeasuredPoint {
  std::size_t band = 0;
  MeasuredQuantity quantity = MeasuredQuantity::reflectance;
  double at = 0.0;  ///< spatial frequency [1/mm], radius [mm], time [ps] or frequency [MHz]; 0 of
                    ///< totals
  double r = 0.0;   ///< radius of what is over time or frequency [mm]
  double value = 0.0;
  double standard_deviation = 0.0;               ///< > 0
  std::optional<IntegratingSphere> sphere = {};  ///< of totals: the value is its reading
};

/// A part of the light that an instrument shows later than it came.
struct DelayedPart {
  double delay = 0.0;  ///< [ps]
  double weight = 1.0;
};

/// Points that one instrument measured in one geometry.
struct MeasuredSeries {
  MeasurementKind kind = MeasurementKind::totals;
  Incidence incidence = {};
  bool has_specular = true;  ///< of totals: whether the reflectance has the first reflection
  /// Diameter of the beam of totals in spheres [mm]: light that leaves beside the sample's ports is
  /// lost to them.
  std::optional<double> beam_diameter = {};
  double detector_width = 0.0;  ///< of what is measured over radius [mm]
  bool is_relative = false;     ///< times a factor that is not known: of each curve over time, of
                                ///< all amplitudes in a band
  std::vector<DelayedPart> instrument = {{}};  ///< of what is measured over time
  double photons = 2e6;                        ///< most that correct a curve over time or frequency
  std::vector<MeasuredPoint> points;
};

/// A number of the material file that a fit is free to choose, once or in every band.
struct FreeNumber {
  FitParameter parameter;  ///< its name is the path in the file, as that of --set
  bool is_per_band = false;
  std::vector<std::string> further_paths = {};  ///< of what is set to the same number
  std::optional<std::size_t> known = {};        ///< its place in the population
  std::vector<double> band_starts = {};  ///< [band] in place of parameter.start; may be empty

  /// All that are set to it.
  [[nodiscard]] std::vector<std::string> paths() const {
    std::vector<std::string> all = {parameter.name};
    all.insert(all.end(), further_paths.begin(), further_paths.end());
    return all;
  }
  [[nodiscard]] double start(std::size_t band) const {
    return band_starts.empty() ? parameter.start : band_starts[band];
  }
  /// One, or as many as bands.
  [[nodiscard]] std::vector<double> starts(std::size_t bands) const {
    if (!band_starts.empty()) return band_starts;
    return std::vector<double>(is_per_band ? bands : 1, parameter.start);
  }
};

/// A material file with settings to be put in.
struct MeasuredMaterial {
  std::string text;  ///< of the file
  std::string name;  ///< that messages name and paths are relative to

  /// @param settings  as parse_json takes them. @throws InvalidInput as load_material.
  [[nodiscard]] Material with(std::span<const std::string> settings) const;
};

/// A number that the file of a material states, or one for each of its bands.
struct StatedNumber {
  std::string path;  ///< as that of --set
  std::vector<double> values;
};

/// All of them, in the order of the file; wavelengths of bands and versions are none.
[[nodiscard]] std::vector<StatedNumber> stated_numbers(const MeasuredMaterial& material);

/// Measurement of a file.
struct Measurement {
  std::string name, source;
  MeasuredMaterial material;
  BandSet bands = BandSet::rgb();  ///< those measured, of the material where it is solved
  std::vector<FreeNumber> free;
  std::vector<MeasuredSeries> series;
  /// Prior of skin. The free numbers that it knows have its priors, which go
  /// together; all others then have one of their own.
  std::optional<SkinPopulation> population = {};
  int starts = 1;             ///< as in FitOptions
  double robust_limit = 0.0;  ///< as in FitOptions
};

/// Reads a measurement file; docs/fit.md has the format.
/// @param settings  changes of it, as parse_json takes them.
/// @throws FileError if a file is missing or unreadable; InvalidInput naming file, line and field.
[[nodiscard]] Measurement load_measurement(const JsonFile& file, MemoryBudget memory = {},
                                           std::span<const std::string> settings = {});

/// The material with numbers for what is free.
/// @param values  [free number][band], of a number that is not per band [0]
[[nodiscard]] Material material_with(const Measurement& measurement,
                                     std::span<const std::vector<double>> values);

}  // namespace lamina
