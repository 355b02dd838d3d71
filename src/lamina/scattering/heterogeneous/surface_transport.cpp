// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/surface_transport.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "lamina/scattering/heterogeneous/internal/for_cells.h"
#include "lamina/scattering/heterogeneous/internal/interlayer_series.h"
#include "lamina/scattering/heterogeneous/mapped_operator.h"

namespace lamina {
namespace {

using detail::for_cells;
using detail::LayerOperator;
using enum detail::LayerOperator;

/// One band of an operator, in the lane of that band.
template <int N>
void add_operator(int band, const MappedOperator& from, std::size_t scales, CellOperator<N>& to) {
  to.powers = std::max(to.powers, from.terms);
  to.weights.resize(to.powers * scales);
  to.totals.resize(to.powers);
  for (std::size_t p = 0; p < from.terms; ++p) {
    for (std::size_t j = 0; j < scales; ++j)
      to.weights[p * scales + j][band] = from.weights[p * scales + j];
    to.totals[p][band] = from.totals[p];
  }
}

template <int N>
void add_layer(int band, const StackTables& tables, const LayerTables& from,
               const std::vector<float>& sigma_a, std::span<const double> scales, double tolerance,
               typename SurfaceLayers<N>::Layer& layer) {
  const Plane values{static_cast<int>(sigma_a.size()), 1, sigma_a};
  const AbsorptionRange range = absorption_range(values, tables.grid);
  const Plane coordinate = absorption_coordinate(values, range);
  for (std::size_t i = 0; i < sigma_a.size(); ++i) layer.coordinate[i][band] = coordinate.values[i];
  const auto each = operator_tables(from);
  for (std::size_t which = 0; which < 4; ++which)
    if (!each[which]->weights.empty())
      add_operator(band, make_mapped_operator(tables, *each[which], range, scales, tolerance),
                   scales.size() / tables.variances.size(), layer.operators[which]);
}

/// An operator's total where the coordinate is such.
template <int N>
BandValues<N> total_at(const CellOperator<N>& op, const BandValues<N>& coordinate) {
  BandValues<N> total = op.totals.back();
  for (std::size_t p = op.powers - 1; p-- > 0;) total = total * coordinate + op.totals[p];
  return total;
}

/// Cells of a surface in all bands, as detail::sum_interlayer_bounces takes them.
template <int N>
class SurfaceField {
 public:
  using Light = CellField<N>;

  explicit SurfaceField(const SurfaceLayers<N>& layers) : layers_(layers) {}

  [[nodiscard]] std::size_t junctions() const { return 1; }
  [[nodiscard]] Light blur(std::size_t layer, LayerOperator which, const Light& light) const {
    const auto& at = layer == 0 ? layers_.upper : layers_.lower;
    const std::array<const CellOperator<N>*, 1> operators = {&at.operators[which]};
    Light blurred =
        std::move(apply_cell_operators<N>(*layers_.graph, light, at.coordinate, operators)[0]);
    if (layer == 0 || !has_thin_parts()) return blurred;
    Light through = pass_through(*layers_.graph, layers_.thin, light);
    // In the last bounce what has come through goes on between the layers, too.
    if (is_closed_)
      for_cells(through.size(), [&](std::size_t i) { through[i] = through[i] * closure(i); });
    for_cells(light.size(), [&](std::size_t i) {
      blurred[i] = blurred[i] * layers_.thin.reflectance[i] + through[i];
    });
    return blurred;
  }
  [[nodiscard]] std::array<Light, 2> blur(std::size_t layer, LayerOperator first,
                                          LayerOperator second, const Light& light) const {
    const auto& at = layer == 0 ? layers_.upper : layers_.lower;
    const std::array<const CellOperator<N>*, 2> operators = {&at.operators[first],
                                                             &at.operators[second]};
    auto both = apply_cell_operators<N>(*layers_.graph, light, at.coordinate, operators);
    return {std::move(both[0]), std::move(both[1])};
  }
  void multiply(Light& light, std::size_t) const {
    for_cells(light.size(), [&](std::size_t i) { light[i] *= layers_.junction[i]; });
  }
  void add(Light& sum, Light more) const {
    if (sum.empty())
      sum = std::move(more);
    else
      for_cells(sum.size(), [&](std::size_t i) { sum[i] += more[i]; });
  }
  void close(std::vector<Light>& down) const {
    for_cells(down[0].size(), [&](std::size_t i) { down[0][i] = down[0][i] * closure(i); });
    is_closed_ = true;
  }

 private:
  /// All further bounces between the layers, as if all skin were like this cell.
  [[nodiscard]] BandValues<N> closure(std::size_t i) const {
    BandValues<N> again =
        layers_.junction[i] * layers_.junction[i] *
        total_at(layers_.upper.operators[reflection_below], layers_.upper.coordinate[i]) *
        total_at(layers_.lower.operators[reflection_above], layers_.lower.coordinate[i]);
    if (has_thin_parts()) again *= layers_.thin.reflectance[i];
    const auto one = BandValues<N>::filled(1.0f);
    return one / (one - again);
  }
  [[nodiscard]] bool has_thin_parts() const { return layers_.thin.geometry != nullptr; }

  const SurfaceLayers<N>& layers_;
  mutable bool is_closed_ = false;  ///< by the bounce under way
};

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
  const std::vector<double> scales = cell_scales_of_gaussians(*graph, tables.variances);
  add_layer<N>(band, tables, tables.layers[0], absorption.upper, scales, tolerance, upper);
  add_layer<N>(band, tables, tables.layers[1], absorption.lower, scales, tolerance, lower);
  for (std::size_t i = 0; i < junction.size(); ++i)
    junction[i][band] = std::exp(-absorption.absorbance[i]);
}

template <int N>
CellField<N> uniform_reflectance(const SurfaceLayers<N>& layers) {
  CellField<N> result(layers.junction.size());
  for_cells(result.size(), [&](std::size_t i) {
    const auto upper = [&](LayerOperator which) {
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
  int bounce = 0;
  const auto is_last = [&](const CellField<N>&) { return ++bounce == interlayer_bounces; };
  return detail::sum_interlayer_bounces(SurfaceField<N>(layers), irradiance, true, is_last)
      .reflected;
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
