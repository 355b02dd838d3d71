// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lamina/scattering/heterogeneous/cell_blurs.h"
#include "lamina/scattering/heterogeneous/gaussian_tables.h"
#include "lamina/scattering/heterogeneous/thin_parts.h"

namespace lamina {

/// What skin is at each cell of a surface in one band.
struct CellAbsorption {
  std::vector<float> upper, lower;  ///< [cell] of the two layers [1/mm], > 0
  std::vector<float> absorbance;    ///< [cell] of the sheet between them, natural, per crossing
};

/// A layer over a half-space on a curved surface, their absorption different at each cell: what
/// HeterogeneousLayers is on a plane, for all bands at once.
template <int N>
struct SurfaceLayers {
  const CellGraph* graph = nullptr;
  struct Layer {
    CellField<N> coordinate;
    std::array<CellOperator<N>, 4> operators;  ///< R+, T+, R-, T-; the half-space has R+ only
  };
  Layer upper, lower;
  CellField<N> junction;  ///< what a crossing leaves
  ThinParts<N> thin;      ///< where light comes through from another side

  /// Adds a band; the next lane is its.
  void add_band(int band, const StackTables& tables, const CellAbsorption& absorption,
                double tolerance = 2e-4);
};

/// No layers yet, over a graph that must outlive them.
template <int N>
[[nodiscard]] SurfaceLayers<N> make_surface_layers(const CellGraph& graph);

/// Fraction of the light that has entered that leaves, at each cell as if all skin were like it.
template <int N>
[[nodiscard]] CellField<N> uniform_reflectance(const SurfaceLayers<N>& layers);

/// What becomes of light that has entered: `transport` of heterogeneous_transport.h on a surface,
/// with the profile of the exit.
///
/// @param irradiance  [cell] flux that enters per area.
/// @param interlayer_bounces  times that light comes back from below before the series is closed
///                            locally, >= 1.
/// @return            [cell] flux that leaves per area.
///
/// Holds where the surface bends little within the reach of light. Source: [Donner2008] eqs. 5-8.
template <int N>
[[nodiscard]] CellField<N> transport(const SurfaceLayers<N>& layers, const CellField<N>& irradiance,
                                     int interlayer_bounces = 2);

}  // namespace lamina
