// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/base/core/chebyshev_table.h"
#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/progress.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

/// The skin that a table covers. Each number of SkinParameters lies between those of `low` and
/// `high`; what both have alike is fixed, as junction and inks are.
struct SkinRange {
  SkinParameters low, high;
};

/// How much light skin of any pigments reflects at given wavelengths, by radiative transfer, in
/// microseconds: for fits of spectra.
///
/// Half-spaces below an epidermis of any thickness are alike in three numbers at each wavelength:
/// absorption and reduced scattering of the epidermis times its thickness, and the ratio of both in
/// the dermis. The table holds totals by adding-doubling at Chebyshev points of these three, and
/// interpolates the logarithm of what comes out of the skin. Its error is below 1e-3 of the
/// reflectance over the range of skin_fit_range (tests); making it takes some .1 CPU-s a
/// wavelength, and half a second for any number of them.
class SkinReflectanceTable {
 public:
  /// @param wavelengths  [nm], in [350, 1000]
  /// @throws InvalidInput for a wavelength or parameter out of its range, `low` above `high`, a
  ///         finite dermis, or a junction that is not fixed; Interrupted if progress asks to stop.
  SkinReflectanceTable(std::vector<double> wavelengths, Incidence incidence, const SkinRange& range,
                       const Progress& progress = {});

  [[nodiscard]] const std::vector<double>& wavelengths() const { return wavelengths_; }

  /// Reflected fraction of the incident light, without what the surface mirrors, [wavelength].
  /// What lies out of the range counts as its nearest place.
  [[nodiscard]] std::vector<double> reflectance(const SkinParameters& skin) const;

  /// Reflectance with its derivatives by numbers of the skin, [wavelength][number].
  [[nodiscard]] std::vector<double> reflectance(const SkinParameters& skin,
                                                std::span<double SkinParameters::*const> numbers,
                                                DenseMatrix& derivatives) const;

  /// At one of the wavelengths, with its derivatives by numbers of the skin if any, [number].
  [[nodiscard]] double reflectance_at(std::size_t wavelength, const SkinParameters& skin,
                                      std::span<double SkinParameters::*const> numbers = {},
                                      std::span<double> derivatives = {}) const;

  /// Specular reflectance of the surface, the same at all wavelengths.
  [[nodiscard]] double specular_reflectance() const { return specular_; }

 private:
  using Place = ChebyshevTable::Point;  ///< epidermis sigma_a d, sigma_s' d; dermis
                                        ///< sigma_a / sigma_s'
  struct Band {
    double wavelength = 0.0;
    SkinSpectrum spectrum = {};
    double scattering = 0.0;  ///< of the epidermis at scale 1 and power 0 [1/mm]
    double log_ratio = 0.0;   ///< of the wavelength to that where the power is 1
    ChebyshevTable table;     ///< of the logarithm, over coordinates of the place
  };
  [[nodiscard]] static Band make_band(double wavelength);
  [[nodiscard]] static ChebyshevTable::Box box_of(const Band& band, const SkinRange& range);
  [[nodiscard]] static Place place(const Band& band, const SkinParameters& skin);
  [[nodiscard]] static double log_reflectance(const Band& band, const Place& at,
                                              Place* derivatives);

  std::vector<double> wavelengths_;
  std::vector<Band> bands_;
  double specular_ = 0.0;
};

/// Share of the light that the surface of skin mirrors, the same at all wavelengths.
[[nodiscard]] double skin_specular_reflectance(const SkinParameters& skin,
                                               const Incidence& incidence);

/// The range in which spectra of skin are fitted: any pigments that skin has; scattering .3 to 3
/// times that of [Donner2008], baseline up to 2; all else as in `skin`.
[[nodiscard]] SkinRange skin_fit_range(const SkinParameters& skin);

}  // namespace lamina
