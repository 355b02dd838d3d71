// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"

namespace lamina {

/// Maps that heterogeneous transport depends on, texel by texel; or the derivatives of a number by
/// them. All planes have one size.
template <class T>
struct TransportMaps {
  std::vector<PlaneOf<T>> sigma_a;     ///< [layer] absorption [1/mm], > 0
  std::vector<PlaneOf<T>> absorbance;  ///< [layer - 1] of the sheets, natural, per crossing
  PlaneOf<T> irradiance;               ///< flux that enters per area
};

/// Light that leaves at the two surfaces; or the derivatives of a number by it.
template <class T>
struct TransportLight {
  PlaneOf<T> reflected;
  PlaneOf<T> transmitted;  ///< empty: none, or derivatives of 0
};

struct DifferentiableOptions {
  TransportOptions transport;
  ProfileAt profile = ProfileAt::both;
  double tolerance = 5e-5;  ///< as make_heterogeneous_layers has it
};

/// `transport` for fits: light in layers whose absorption varies, and how a number that is computed
/// from this light, such as its distance from a photograph, changes with every texel of every map.
///
/// Operators are made once, for absorptions between two for each layer, not for those of the maps
/// at hand: so the model is one smooth function of the maps. With the ranges of the maps it is what
/// make_heterogeneous_layers and transport give. The gradient is that of the same arithmetic,
/// blurs of absorption along paths and their width included (reverse accumulation); <f(x), y> =
/// <x, f^T(y)> to rounding. Where it has a kink (neighbors that absorb alike, absorption at the end
/// of a range) it is that of one side.
///
/// Light and gradient together cost about two transports (docs/heterogeneous_skin.md). T is float,
/// or double where derivatives are to be checked.
template <class T>
class DifferentiableTransport {
 public:
  /// @param ranges  [layer] of tables whose layers vary by their absorption alone. Absorptions
  ///                beyond count as the nearer end.
  /// @param mm_per_texel  > 0
  /// @throws InvalidInput if a layer of the tables has other states, or there are too many.
  DifferentiableTransport(const StackTables& tables, int width, int height,
                          std::span<const AbsorptionRange> ranges, double mm_per_texel,
                          const DifferentiableOptions& options = {});
  ~DifferentiableTransport();
  DifferentiableTransport(const DifferentiableTransport&) = delete;
  DifferentiableTransport& operator=(const DifferentiableTransport&) = delete;

  /// Light that leaves. Keeps what `gradient` needs, some fifty planes.
  [[nodiscard]] TransportLight<T> light(const TransportMaps<T>& maps);

  /// Derivatives of a number by all maps that `light` was last called with.
  ///
  /// @param by_light  its derivatives by what left
  [[nodiscard]] TransportMaps<T> gradient(const TransportLight<T>& by_light);

  /// Change of the light, to first order, when these maps change: the transpose of `gradient`,
  /// <tangent(x), y> = <x, gradient(y)> to rounding. It costs less than `light`.
  ///
  /// @param change  of the maps that `light` was last called with; vectors and planes that are
  ///                empty: nothing
  [[nodiscard]] TransportLight<T> tangent(const TransportMaps<T>& change);

 private:
  struct Model;
  struct Run;
  std::unique_ptr<const Model> model_;
  std::unique_ptr<Run> run_;  ///< the last one
};

}  // namespace lamina
