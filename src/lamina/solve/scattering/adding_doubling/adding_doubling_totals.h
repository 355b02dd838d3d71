// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

/// Totals by adding-doubling, with how far they can be trusted.
struct AddingDoublingTotals {
  SlabTotals totals;
  double unscattered_transmittance = 0.0;  ///< part of totals.transmittance, with all reflections
  double unscattered_reflectance = 0.0;  ///< specular, and what comes back from inside unscattered
  double estimated_error = 0.0;          ///< by the changes of the totals from grid to grid
  int nodes = 0;                         ///< of the last grid
  bool is_accurate = false;              ///< estimated_error <= options.accuracy
};

}  // namespace lamina
