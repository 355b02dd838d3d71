// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/surface_transport.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "lamina/core/parallel.h"
#include "lamina/scattering/heterogeneous/mapped_operator.h"

namespace lamina {
namespace {

enum Which { reflection_above, transmission_down, reflection_below, transmission_up };

template <class Body>
void for_cells(std::size_t count, const Body& body) {
  constexpr std::size_t chunk = 8192;
  parallel_for((count + chunk - 1) / chunk, [&](std::size_t c) {
    for (std::size_t i = c * chunk; i < std::min(count, (c + 1) * chunk); ++i) body(i);
  });
}

/// One band of an operator, in the lane of that band.
template <int N>
void add_operator(int band, const MappedOperator& from, std::size_t rungs, CellOperator<N>& to) {
  to.powers = std::max(to.powers, from.powers);
  to.weights.resize(to.powers * rungs);
  to.totals.resize(to.powers);
  for (std::size_t p = 0; p < from.powers; ++p) {
    for (std::size_t j = 0; j < rungs; ++j)
      to.weights[p * rungs + j][band] = from.weights[p * rungs + j];
    to.totals[p][band] = from.totals[p];
  }
}

template <int N>
void add_layer(int band, const StackTables& tables, const LayerTables& from,
               const std::vector<float>& sigma_a, std::span<const double> rungs, double tolerance,
               typename SurfaceLayers<N>::Layer& layer) {
  const Plane values{static_cast<int>(sigma_a.size()), 1, sigma_a};
  const AbsorptionRange range = absorption_range(values, tables.grid);
  const Plane coordinate = absorption_coordinate(values, range);
  for (std::size_t i = 0; i < sigma_a.size(); ++i) layer.coordinate[i][band] = coordinate.values[i];
  const GaussianTable* each[] = {&from.reflection_above, &from.transmission_down,
                                 &from.reflection_below, &from.transmission_up};
  for (std::size_t which = 0; which < 4; ++which)
    if (!each[which]->weights.empty())
      add_operator(band, make_mapped_operator(tables, *each[which], range, rungs, tolerance),
                   rungs.size() / tables.variances.size(), layer.operators[which]);
}

/// An operator's total where the coordinate is such.
template <int N>
BandValues<N> total_at(const CellOperator<N>& op, const BandValues<N>& coordinate) {
  BandValues<N> total = op.totals.back();
  for (std::size_t p = op.powers - 1; p-- > 0;) total = total * coordinate + op.totals[p];
  return total;
}

}  // namespace

template <int N>
SurfaceLayers<N> make_surface_layers(const CellGraph& graph) {
  const std::size_t cells = graph.levels.front().area.size();
  SurfaceLayers<N> layers{.graph = &graph};
  layers.upper.coordinate.resize(cells);
  layers.lower.coordinate.resize(cells);
  layers.junction.resize(cells);
  return layers;
}

template <int N>
void SurfaceLayers<N>::add_band(int band, const StackTables& tables,
                                const CellAbsorption& absorption, double tolerance) {
  assert(tables.layers.size() == 2 && absorption.upper.size() == junction.size());
  const std::vector<double> rungs = cell_rungs_of_gaussians(*graph, tables.variances);
  add_layer<N>(band, tables, tables.layers[0], absorption.upper, rungs, tolerance, upper);
  add_layer<N>(band, tables, tables.layers[1], absorption.lower, rungs, tolerance, lower);
  for (std::size_t i = 0; i < junction.size(); ++i)
    junction[i][band] = std::exp(-absorption.absorbance[i]);
}

template <int N>
CellField<N> uniform_reflectance(const SurfaceLayers<N>& layers) {
  CellField<N> result(layers.junction.size());
  for_cells(result.size(), [&](std::size_t i) {
    const auto upper = [&](Which which) {
      return total_at(layers.upper.operators[which], layers.upper.coordinate[i]);
    };
    const BandValues<N> back =
        layers.junction[i] * layers.junction[i] *
        total_at(layers.lower.operators[reflection_above], layers.lower.coordinate[i]);
    result[i] = upper(reflection_above) +
                upper(transmission_down) * back * upper(transmission_up) /
                    (BandValues<N>::filled(1.0f) - back * upper(reflection_below));
  });
  return result;
}

template <int N>
CellField<N> transport(const SurfaceLayers<N>& layers, const CellField<N>& irradiance,
                       int interlayer_bounces) {
  assert(interlayer_bounces >= 1 && irradiance.size() == layers.junction.size());
  using Layer = typename SurfaceLayers<N>::Layer;
  const auto one = [&](const Layer& layer, Which which, const CellField<N>& light) {
    const std::array<const CellOperator<N>*, 1> operators = {&layer.operators[which]};
    return std::move(apply<N>(*layers.graph, light, layer.coordinate, operators)[0]);
  };
  const auto cross = [&](CellField<N>& light) {
    for_cells(light.size(), [&](std::size_t i) { light[i] *= layers.junction[i]; });
  };
  const bool has_thin_parts = !layers.thin.far.empty();
  CellMixture<N> halves;
  if (has_thin_parts) halves = spread_through(*layers.graph, layers.thin);
  CellField<N> reflected, down, all_up;
  {
    const std::array<const CellOperator<N>*, 2> operators = {
        &layers.upper.operators[reflection_above], &layers.upper.operators[transmission_down]};
    auto both = apply<N>(*layers.graph, irradiance, layers.upper.coordinate, operators);
    reflected = std::move(both[0]);
    down = std::move(both[1]);
  }
  for (int bounce = 1; bounce <= interlayer_bounces; ++bounce) {
    cross(down);
    if (bounce == interlayer_bounces)
      for_cells(down.size(), [&](std::size_t i) {
        BandValues<N> again =
            layers.junction[i] * layers.junction[i] *
            total_at(layers.upper.operators[reflection_below], layers.upper.coordinate[i]) *
            total_at(layers.lower.operators[reflection_above], layers.lower.coordinate[i]);
        if (has_thin_parts) again *= layers.thin.reflectance[i];
        down[i] = down[i] / (BandValues<N>::filled(1.0f) - again);
      });
    const std::array<const CellOperator<N>*, 1> operators = {
        &layers.lower.operators[reflection_above]};
    auto returned = apply<N>(*layers.graph, down, layers.lower.coordinate, operators,
                             has_thin_parts ? &halves : nullptr);
    CellField<N> up = std::move(returned[0]);
    if (has_thin_parts) {
      const CellField<N> through = apply<N>(*layers.graph, pass_through(layers.thin, returned[1]),
                                            layers.lower.coordinate, {}, &halves)[0];
      for_cells(up.size(),
                [&](std::size_t i) { up[i] = up[i] * layers.thin.reflectance[i] + through[i]; });
    }
    cross(up);
    if (bounce < interlayer_bounces) down = one(layers.upper, reflection_below, up);
    if (all_up.empty())
      all_up = std::move(up);
    else
      for_cells(up.size(), [&](std::size_t i) { all_up[i] += up[i]; });
  }
  const CellField<N> returned = one(layers.upper, transmission_up, all_up);
  for_cells(reflected.size(), [&](std::size_t i) { reflected[i] += returned[i]; });
  return reflected;
}

template struct SurfaceLayers<4>;
template struct SurfaceLayers<8>;
template struct SurfaceLayers<16>;
template SurfaceLayers<4> make_surface_layers<4>(const CellGraph&);
template SurfaceLayers<8> make_surface_layers<8>(const CellGraph&);
template SurfaceLayers<16> make_surface_layers<16>(const CellGraph&);
template CellField<4> uniform_reflectance<4>(const SurfaceLayers<4>&);
template CellField<8> uniform_reflectance<8>(const SurfaceLayers<8>&);
template CellField<16> uniform_reflectance<16>(const SurfaceLayers<16>&);
template CellField<4> transport<4>(const SurfaceLayers<4>&, const CellField<4>&, int);
template CellField<8> transport<8>(const SurfaceLayers<8>&, const CellField<8>&, int);
template CellField<16> transport<16>(const SurfaceLayers<16>&, const CellField<16>&, int);

}  // namespace lamina
