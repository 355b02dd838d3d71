// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace lamina {

/// A fraction of the arriving light, as it was measured.
struct MeasuredTotal {
  double value = 0.0;
  double standard_deviation = 0.0;  ///< > 0
};

/// Totals of a stack at one wavelength.
struct SlabMeasurement {
  MeasuredTotal reflectance;  ///< all that leaves at the top; see has_specular
  std::optional<MeasuredTotal> transmittance = {};              ///< all that leaves at the bottom
  std::optional<MeasuredTotal> unscattered_transmittance = {};  ///< collimated; see below
  bool has_specular = true;  ///< whether the first reflection at the top is in the reflectance
};

}  // namespace lamina
