// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lamina/base/core/estimate.h"
#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// A vessel: an endless cylinder along y within one layer, of that layer's index.
struct Cylinder {
  double x = 0.0, depth = 0.0;  ///< of its axis [mm]
  double radius = 0.0;          ///< [mm], > 0
  double sigma_a = 0.0;         ///< [1/mm], >= 0
  double sigma_s = 0.0;         ///< [1/mm], >= 0
  double g = 0.0;               ///< in (-1, 1)
};

/// Treatment of light at the sides of a box.
enum class BoxSides {
  repeat,  ///< the box repeats without end
  open     ///< light is gone
};

/// Flat layers with cylinders in them, over a box of 0 .. width by 0 .. length; lit from above,
/// normally and evenly, on all of the box or on a disc in its middle.
struct CylinderLayers {
  LayerStack stack;                 ///< smooth boundaries, black ground
  std::vector<Cylinder> cylinders;  ///< apart from one another; within the box where it repeats
  double width = 1.0,
         length = 1.0;  ///< [mm], >= 1e-3, finite: sides that repeat are crossed one by one
  BoxSides sides = BoxSides::repeat;
  std::optional<double> beam_radius;  ///< [mm]
  int columns = 1;                    ///< of the exitance over x, >= 1
};

struct CylinderPhotonOptions {
  std::uint64_t photons = 1'000'000;  ///< >= 1
  std::uint64_t seed = 0;
  Progress progress;  ///< may stop the run, which keeps what it has
};

/// Fractions of the light that arrives. Together with `specular` they sum to 1 but for noise.
struct CylinderPhotons {
  std::uint64_t photons = 0;  ///< that were followed
  double specular = 0.0;      ///< reflected before the light enters
  Estimate reflected, transmitted, through_sides;
  std::vector<Estimate> absorbed_by_layers;     ///< [layer], without its cylinders
  std::vector<Estimate> absorbed_by_cylinders;  ///< [cylinder]
  std::vector<Estimate> reflected_by_column;    ///< [column], which sum to `reflected`
};

/// Follows photons through layers with cylinders, whose surfaces are found exactly.
///
/// Free paths are drawn from the scattering coefficient of where the photon is, anew at each
/// surface; the weight falls by the absorption along the path, which is tallied where it happens.
/// Below a weight of .05 chance decides. The result does not depend on the number of threads.
///
/// @throws InvalidInput if a cylinder leaves its layer or meets another, or a boundary is rough.
[[nodiscard]] CylinderPhotons trace_cylinder_photons(const CylinderLayers& scene,
                                                     const CylinderPhotonOptions& options = {});

}  // namespace lamina
