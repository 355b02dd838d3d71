// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/skin/acquire/inversion/texels/local_reflectance.h"
#include "lamina/skin/acquire/inversion/texels/patch_capture.h"
#include "lamina/skin/fit/skin/skin_population.h"
#include "lamina/solve/scattering/heterogeneous/transport_gradient.h"

namespace lamina {

/// Model of skin that photographs are inverted to.
struct InversionModel {
  /// Numbers that vary over the patch: some of skin_fit_numbers, but for scattering_scale.
  std::vector<std::string> numbers = {"melanin", "melanin_blend", "hemoglobin_epidermis",
                                      "hemoglobin_dermis", "carotene"};
  SkinParameters skin;  ///< gives all else; its dermis is infinite
  /// Prior of the numbers of each texel; absent: a wide one
  std::optional<SkinPopulation> population = {};
  /// False: for InversionOptions::is_by_texel alone, and light that does not travel sideways.
  bool has_transport = true;
  OperatorTotals totals = OperatorTotals::radiative_transfer_profile;
  TransportOptions transport = {.interlayer_bounces = 3};
  ProfileAt profile = ProfileAt::both;
  /// Table over skin_fit_range of `skin`, of wavelengths and light of the capture; null: made for
  /// it
  std::shared_ptr<const SkinReflectanceTable> reflectance = nullptr;
};

/// Without a population each coordinate of skin_fit_numbers is taken to be known to so much before,
/// about that of the reference skin: a factor of 20.
inline constexpr double wide_deviation = 3.0;

/// Tables of an inversion that all tiles of a capture share.
struct InversionTables {
  InversionModel model;
  std::vector<SkinFitNumber> numbers;  ///< those of the model
  std::vector<double> wavelengths;     ///< [nm]
  std::vector<SkinSpectrum> spectra;   ///< [wavelength]
  std::shared_ptr<const LocalReflectance> reflectance;
  /// Coordinates that are typical of the capture, and the prior's: its mean and inverse covariance.
  std::vector<double> reference, prior_mean;
  DenseMatrix prior_precision;
  /// Misses of the model in the population, [wavelength]: reflectance, and its deviation.
  std::vector<double> missed, missed_deviation;
  /// Tables of the transport, [wavelength]; empty without it: tables, what of the arriving light
  /// enters, and what the sheet between the layers absorbs per crossing.
  std::vector<StackTables> stacks;
  std::vector<double> entering, sheet;
};

/// @param cache  keeps the tables of the transport; absent: none.
/// @throws InvalidInput as check_capture; for a number that is none or cannot vary, one of which
///         the population knows nothing, a dermis that is finite; for fewer images than numbers
///         without a population.
[[nodiscard]] InversionTables make_inversion_tables(const PatchCapture& capture,
                                                    const InversionModel& model,
                                                    const std::optional<DiskCache>& cache = {});

}  // namespace lamina
