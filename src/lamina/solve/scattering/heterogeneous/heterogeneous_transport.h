// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/solve/scattering/heterogeneous/blurs/gaussian_blurs.h"
#include "lamina/solve/scattering/heterogeneous/mapped_operator.h"
#include "lamina/solve/scattering/heterogeneous/path_absorption.h"
#include "lamina/solve/scattering/heterogeneous/tables/gaussian_tables.h"

namespace lamina {

/// Layers that vary over the surface, with absorbing sheets between them; one band. A ground that
/// reflects is one more layer, at the bottom.
template <class T>
struct HeterogeneousLayersOf {
  BlurPyramid pyramid;
  std::vector<TransportLayerOf<T>> layers;  ///< from the lit surface downward
  std::vector<PlaneOf<T>> junctions;        ///< [layer - 1] what a crossing leaves, in [0, 1]
};
using HeterogeneousLayers = HeterogeneousLayersOf<float>;

/// @throws InvalidInput if there are more layers than can be maps.
void check_layer_count(std::size_t layers);

/// @param sigma_a        [layer] maps of one size [1/mm], > 0, finite.
/// @param absorbance     [layer - 1] of the sheets between layers, natural, per crossing: light
///                       that crosses is multiplied by exp(-absorbance) [Donner2008] eq. 8.
/// @param mm_per_texel   > 0.
/// @param profile        of layers of which only absorption varies; others take that of the exit.
/// @param tolerance      of each operator, of its largest total.
[[nodiscard]] HeterogeneousLayers make_heterogeneous_layers(const StackTables& tables,
                                                            const std::vector<Plane>& sigma_a,
                                                            const std::vector<Plane>& absorbance,
                                                            double mm_per_texel,
                                                            ProfileAt profile = ProfileAt::both,
                                                            double tolerance = 5e-5);

/// Makes layers of which anything may vary.
///
/// @param texels  [layer] width * height each, or one.
/// @throws InvalidInput if there are too many layers; Interrupted if progress, which is told after
///         each, asks to stop.
[[nodiscard]] HeterogeneousLayers make_heterogeneous_layers(
    const StackTables& tables, int width, int height, const std::vector<LayerTexels>& texels,
    const std::vector<Plane>& absorbance, double mm_per_texel, ProfileAt profile = ProfileAt::both,
    double tolerance = 5e-5, const Progress& progress = {});

struct TransportOptions {
  /// Times that light goes down and comes back between layers; 0: as many as `energy_threshold`
  /// asks for
  int interlayer_bounces = 2;
  /// The bounces left out are added as if the texel's surroundings were like it
  bool has_local_closure = true;
  /// Part of the energy that goes down which the bounces must hold
  double energy_threshold = 0.999;
};

struct TransportResult {
  Plane reflected;             ///< flux that leaves at the lit surface
  Plane transmitted;           ///< and at the other one; 0 under a half-space
  int interlayer_bounces = 0;  ///< that were summed
  double last_bounce = 0.0;    ///< the last one's part of what went down, closure left out
};

/// Transports light that has entered at the lit surface.
///
///     M = R1+[Φ] + T1-[A R2+[A T1+[Φ]]] + T1-[A R2+[A R1-[A R2+[A T1+[Φ]]]]] + ...
///
/// where every operator takes its profile where light comes out, or the mean of that and where it
/// enters. All that comes back is summed
/// before one T1-. Before the last R2+, light that goes down becomes that of all further bounces,
/// as in a uniform skin like the one at the texel: so a uniform skin under uniform light is right
/// from one bounce on.
///
/// Linear in the light; every step is a blur, which is its own adjoint, or a product with a map.
///
/// @param irradiance  flux that enters per area, of the maps' size.
/// @param progress    told before each blur that the work goes on
/// @throws Interrupted if asked to stop.
///
/// Source: [Donner2008] eqs. 5-8; the closure is lamina's.
[[nodiscard]] TransportResult transport(const HeterogeneousLayers& layers, const Plane& irradiance,
                                        const TransportOptions& options = {},
                                        const Progress& progress = {});

}  // namespace lamina
