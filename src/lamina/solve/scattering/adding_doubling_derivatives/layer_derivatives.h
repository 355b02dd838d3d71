// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lamina {

/// Derivatives of a total by what one layer is made of, all else kept.
struct LayerDerivatives {
  double by_sigma_a = 0.0;    ///< [mm]
  double by_sigma_s = 0.0;    ///< [mm] at constant g
  double by_g = 0.0;          ///< of the Henyey-Greenstein lobes, all changed alike; else 0
  double by_thickness = 0.0;  ///< [1/mm]; 0 in an infinitely thick layer
};

}  // namespace lamina
