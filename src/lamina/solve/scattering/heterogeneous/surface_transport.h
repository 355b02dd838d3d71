// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/blurs/cell_blurs.h"
#include "lamina/solve/scattering/heterogeneous/tables/gaussian_tables.h"
#include "lamina/solve/scattering/heterogeneous/thin_parts/thin_parts.h"

namespace lamina {

/// Layers on a curved surface that are different at each cell: what HeterogeneousLayers is on a
/// plane, for all bands at once.
template <int N>
struct SurfaceLayers {
  const CellGraph* graph = nullptr;
  struct Layer {
    CellBasis<N> basis;
    std::array<CellOperator<N>, 4> operators;  ///< R+, T+, R-, T-; a half-space has R+ only
    struct OfEntry {
      std::vector<BandValues<N>> factor;  ///< [term]
      std::array<CellOperator<N>, 4> operators;
    };
    std::vector<OfEntry> of_entry;  ///< as TransportLayer has them, for all bands or none
  };
  std::vector<Layer> layers;            ///< from the lit surface downward; a ground is the last
  std::vector<CellField<N>> junctions;  ///< [layer - 1] what a crossing leaves
  ThinParts<N> thin;                    ///< where light comes through from another side

  /// Adds a band; the next lane is its. All have the same layers.
  ///
  /// @param texels      [layer] a number for each cell, or one
  /// @param absorbance  [layer - 1] of the sheets between, natural, per crossing, likewise
  void add_band(int band, const StackTables& tables, std::span<const LayerTexels> texels,
                std::span<const std::vector<float>> absorbance, double tolerance = 2e-4);
};

/// No layers yet, over a graph that must outlive them.
template <int N>
[[nodiscard]] SurfaceLayers<N> make_surface_layers(const CellGraph& graph);

/// Fraction of the light that has entered that leaves, at each cell as if all were like it.
template <int N>
[[nodiscard]] CellField<N> uniform_reflectance(const SurfaceLayers<N>& layers);

/// Light that leaves below in uniform light; 0 under a half-space or a ground.
template <int N>
[[nodiscard]] CellField<N> uniform_transmittance(const SurfaceLayers<N>& layers);

/// Flux that leaves per area, [cell].
template <int N>
struct SurfaceTransportResult {
  CellField<N> reflected;
  CellField<N> transmitted;  ///< below; empty under a half-space or a ground
};

/// Transports light that has entered: `transport` of heterogeneous_transport.h on a surface,
/// with profiles of both ends where only absorption varies.
///
/// @param irradiance  [cell] flux that enters per area.
/// @param interlayer_bounces  times that light comes back from below before the series is closed
///                            locally, >= 1.
///
/// Holds where the surface bends little within the reach of light. Source: [Donner2008] eqs. 5-8.
template <int N>
[[nodiscard]] SurfaceTransportResult<N> transport(const SurfaceLayers<N>& layers,
                                                  const CellField<N>& irradiance,
                                                  int interlayer_bounces = 2);

}  // namespace lamina
