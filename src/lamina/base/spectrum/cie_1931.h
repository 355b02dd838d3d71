// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace lamina {

/// The light that a surface or a scene is seen under.
enum class Illuminant {
  d65,           ///< noon daylight, the white of sRGB
  a,             ///< an incandescent lamp of 2856 K
  equal_energy,  ///< E: the same power per nm everywhere
};

/// One row of the tables, each 5 nm from 360 to 830 nm.
struct ColorMatchingRow {
  double wavelength;  ///< [nm]
  double x, y, z;     ///< CIE 1931 2 degree standard observer
  double d65;         ///< relative power per nm, 100 at 560 nm
};

/// Source: [CIE015] Tables 1 (D65) and 4 (observer), the rows of which are 5 nm apart; from 360 nm.
[[nodiscard]] std::span<const ColorMatchingRow> color_matching_table();

/// Relative power per nm of an illuminant at a wavelength [nm] in [300, 830], 100 at 560 nm.
///
/// D65: linear between the rows of the table, as [CIE015] §4.1.1 says; 0 outside [360, 830].
/// A: Planck's law as [CIE015] Eq. 3.1 writes it.
[[nodiscard]] double illuminant_power(Illuminant illuminant, double wavelength);

}  // namespace lamina
