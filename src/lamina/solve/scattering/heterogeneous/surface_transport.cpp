// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/surface_transport.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "lamina/solve/scattering/heterogeneous/blurs/for_cells.h"
#include "lamina/solve/scattering/heterogeneous/internal/interlayer_series.h"
#include "lamina/solve/scattering/heterogeneous/internal/local_sweeps.h"
#include "lamina/solve/scattering/heterogeneous/internal/sum_over_entries.h"
#include "lamina/solve/scattering/heterogeneous/mapped_operator.h"

namespace lamina {
namespace {

using detail::for_cells;
using detail::LayerOperator;
using enum detail::LayerOperator;

/// One band of an operator, in the lane of that band.
template <int N>
void add_operator(int band, const MappedOperator& from, std::size_t scales, CellOperator<N>& to) {
  to.terms = std::max(to.terms, from.terms);
  to.weights.resize(to.terms * scales);
  to.totals.resize(to.terms);
  for (std::size_t p = 0; p < from.terms; ++p) {
    for (std::size_t j = 0; j < scales; ++j)
      to.weights[p * scales + j][band] = from.weights[p * scales + j];
    to.totals[p][band] = from.totals[p];
  }
}

/// Functions of the basis that a layer's operators use.
template <class Layer>
std::size_t terms_of(const Layer& layer) {
  std::size_t terms = 1;
  for (const auto& op : layer.operators) terms = std::max(terms, op.terms);
  for (const auto& entry : layer.of_entry) {
    terms = std::max(terms, entry.factor.size());
    for (const auto& op : entry.operators) terms = std::max(terms, op.terms);
  }
  return terms;
}

/// The powers of the coordinate as modes, so that a band that needs modes can stand beside.
template <int N>
void turn_to_modes(typename SurfaceLayers<N>::Layer& layer) {
  CellBasis<N>& basis = layer.basis;
  const std::size_t terms = terms_of(layer);
  basis.modes.assign(terms, CellField<N>(basis.coordinate.size(), BandValues<N>::filled(1.0f)));
  for (std::size_t p = 1; p < terms; ++p)
    for_cells(basis.coordinate.size(), [&](std::size_t i) {
      basis.modes[p][i] = basis.modes[p - 1][i] * basis.coordinate[i];
    });
  basis.coordinate = {};
}

/// The operators of both ends of one band. A band without makes do with those of the exit.
template <int N>
void add_both_ends(int band, const TransportLayer& from, std::size_t scales,
                   typename SurfaceLayers<N>::Layer& layer) {
  if (layer.of_entry.size() < from.of_entry.size()) {
    // Bands so far have the same profiles at all cells.
    layer.of_entry.resize(from.of_entry.size());
    layer.of_entry[0].factor = {BandValues<N>::filled(1.0f)};
    layer.of_entry[0].operators = layer.operators;
  }
  for (std::size_t t = 0; t < layer.of_entry.size(); ++t) {
    auto& entry = layer.of_entry[t];
    if (from.of_entry.empty() && t > 0) continue;
    const std::vector<float> factor =
        from.of_entry.empty() ? std::vector{1.0f} : from.of_entry[t].factor;
    entry.factor.resize(std::max(entry.factor.size(), factor.size()));
    for (std::size_t p = 0; p < factor.size(); ++p) entry.factor[p][band] = factor[p];
    const auto& operators = from.of_entry.empty() ? from.operators : from.of_entry[t].operators;
    for (std::size_t which = 0; which < 4; ++which)
      if (operators[which].terms > 0)
        add_operator(band, operators[which], scales, entry.operators[which]);
  }
}

/// One band of a layer, in the lane of that band.
template <int N>
void add_layer(int band, const TransportLayer& from, std::size_t cells, std::size_t scales,
               typename SurfaceLayers<N>::Layer& layer) {
  CellBasis<N>& basis = layer.basis;
  if (basis.coordinate.empty() && basis.modes.empty()) basis.coordinate.resize(cells);
  if (!from.basis.modes.empty() && basis.modes.empty()) turn_to_modes<N>(layer);
  add_both_ends<N>(band, from, scales, layer);
  for (std::size_t which = 0; which < 4; ++which)
    if (from.operators[which].terms > 0)
      add_operator(band, from.operators[which], scales, layer.operators[which]);
  if (basis.modes.empty()) {
    for (std::size_t i = 0; i < cells; ++i)
      basis.coordinate[i][band] = from.basis.coordinate.values[i];
    return;
  }
  const std::size_t count = terms_of(from);
  while (basis.modes.size() < count) basis.modes.emplace_back(cells);
  for (std::size_t i = 0; i < cells; ++i) {
    float power = 1.0f;
    for (std::size_t p = 0; p < count; ++p) {
      basis.modes[p][i][band] = from.basis.modes.empty() ? power : from.basis.modes[p].values[i];
      if (from.basis.modes.empty()) power *= from.basis.coordinate.values[i];
    }
  }
}

/// An operator's total at a cell.
template <int N>
BandValues<N> total_at(const typename SurfaceLayers<N>::Layer& layer, LayerOperator which,
                       std::size_t cell) {
  const CellOperator<N>& op = layer.operators[which];
  if (op.terms == 0) return {};
  return basis_sum(layer.basis, cell, op.terms, [&](std::size_t p) { return op.totals[p]; });
}

/// The texels of one band with absorption as light on its way meets it.
LayerTexels along_surface_paths(const CellGraph& graph, const LayerTexels& texels) {
  constexpr int lanes = 4;  // of which one is used
  const CellLevel& level = graph.levels.front();
  const auto for_neighbors = [&](const auto& take) {
    for (std::size_t i = 0; i < level.area.size(); ++i)
      for (std::uint32_t k = level.first[i]; k < level.first[i + 1]; ++k)
        if (level.neighbors[k].cell > i) take(i, level.neighbors[k].cell);
  };
  return along_paths(texels, for_neighbors, [&](double length) {
    std::array<std::vector<double>, 2> scales;
    for (std::size_t i = 0; i < 2; ++i)
      scales[i] = cell_scales_of_gaussians(graph, std::array{path_variances(length)[i]});
    CellOperator<lanes> blur{.terms = 1, .weights = {}, .totals = {}};
    for (const double weight : sum_by_shares(scales))
      blur.weights.push_back(BandValues<lanes>::filled(static_cast<float>(weight)));
    CellField<lanes> field(texels.sigma_a.size());
    for (std::size_t i = 0; i < field.size(); ++i) field[i][0] = texels.sigma_a[i];
    field =
        apply_cell_operators<lanes>(graph, field, {.coordinate = CellField<lanes>(field.size())},
                                    std::array<const CellOperator<lanes>*, 1>{&blur})[0];
    std::vector<float> sigma_a;
    for (const BandValues<lanes>& value : field) sigma_a.push_back(value[0]);
    return sigma_a;
  });
}

/// Cells of a surface in all bands, as detail::sum_interlayer_bounces takes them.
template <int N>
class SurfaceField {
 public:
  using Light = CellField<N>;

  explicit SurfaceField(const SurfaceLayers<N>& layers) : layers_(layers) {}

  [[nodiscard]] std::size_t junctions() const { return layers_.junctions.size(); }
  [[nodiscard]] bool has_bottom() const {
    return layers_.layers.back().operators[transmission_down].terms > 0;
  }
  [[nodiscard]] Light blur(std::size_t layer, LayerOperator which, const Light& light) const {
    Light blurred = blur_alone(layer, which, light);
    if (layer + 1 < layers_.layers.size() || !has_thin_parts()) return blurred;
    Light through = pass_through(*layers_.graph, layers_.thin, light);
    // In the last bounce what has come through goes on between the layers, too.
    if (!closure_.empty())
      for_cells(through.size(), [&](std::size_t i) { through[i] = through[i] * closure_[i]; });
    for_cells(light.size(), [&](std::size_t i) {
      blurred[i] = blurred[i] * layers_.thin.reflectance[i] + through[i];
    });
    return blurred;
  }
  [[nodiscard]] std::array<Light, 2> blur(std::size_t layer, LayerOperator first,
                                          LayerOperator second, const Light& light) const {
    auto both = apply(layer, std::array<std::size_t, 2>{first, second}, light);
    return {std::move(both[0]), std::move(both[1])};
  }
  void multiply(Light& light, std::size_t junction) const {
    for_cells(light.size(), [&](std::size_t i) { light[i] *= layers_.junctions[junction][i]; });
  }
  void add(Light& sum, Light more) const {
    if (sum.empty())
      sum = std::move(more);
    else
      for_cells(sum.size(), [&](std::size_t i) { sum[i] += more[i]; });
  }
  void close(std::vector<Light>& down) const {
    if (down.size() > 1) return close_locally(down);
    // As on a plane: heterogeneous_transport.cpp says why.
    Light above(down[0].size());
    closure_.resize(down[0].size());
    for_cells(above.size(), [&](std::size_t i) {
      above[i] = layers_.junctions[0][i] * layers_.junctions[0][i] *
                 total_at<N>(layers_.layers[0], reflection_below, i);
      closure_[i] = above[i] * total_at<N>(layers_.layers[1], reflection_above, i);
      if (has_thin_parts()) closure_[i] *= layers_.thin.reflectance[i];
    });
    if (largest(closure_) > detail::most_local_return && !has_thin_parts())
      closure_ = blur_alone(1, reflection_above, above);
    const auto one = BandValues<N>::filled(1.0f);
    for_cells(above.size(), [&](std::size_t i) {
      closure_[i] = one / (one - closure_[i]);
      down[0][i] = down[0][i] * closure_[i];
    });
  }
  void turn_round(const std::vector<Light>& up, Light& arriving) const {
    for_cells(arriving.size(), [&](std::size_t i) {
      BandValues<N> down;
      for (std::size_t j = 0; j < up.size(); ++j) {
        BandValues<N> turned = total_at<N>(layers_.layers[j], reflection_below, i) * up[j][i];
        if (j > 0) turned += total_at<N>(layers_.layers[j], transmission_down, i) * down;
        down = layers_.junctions[j][i] * turned;
      }
      arriving[i] += down;
    });
  }

 private:
  [[nodiscard]] Light blur_alone(std::size_t layer, LayerOperator which, const Light& light) const {
    return std::move(apply(layer, std::array<std::size_t, 1>{which}, light)[0]);
  }
  template <std::size_t K>
  [[nodiscard]] std::vector<Light> apply(std::size_t layer, const std::array<std::size_t, K>& which,
                                         const Light& light) const {
    const auto& at = layers_.layers[layer];
    return detail::sum_over_entries(
        at, light, which,
        [&](const std::vector<BandValues<N>>& factor, const Light& entering) {
          Light entered(entering.size());
          for_cells(entering.size(), [&](std::size_t i) {
            entered[i] = entering[i] * basis_sum(at.basis, i, factor.size(),
                                                 [&](std::size_t p) { return factor[p]; });
          });
          return entered;
        },
        [&](const Light& entered, const auto& those) {
          return apply_cell_operators<N>(*layers_.graph, entered, at.basis, those);
        },
        [&](Light& sum, Light more) { add(sum, std::move(more)); });
  }
  static float largest(const Light& field) {
    float most = 0.0f;
    for (const BandValues<N>& value : field)
      for (int b = 0; b < N; ++b) most = std::max(most, value[b]);
    return most;
  }
  void close_locally(std::vector<Light>& down) const {
    using Bands = BandValues<N>;
    const std::size_t n = down.size();
    for_cells(down[0].size(), [&](std::size_t i) {
      const auto sweep = detail::local_sweep<Bands>(
          n,
          [&](std::size_t layer, LayerOperator which) {
            return total_at<N>(layers_.layers[layer], which, i);
          },
          [&](std::size_t j) { return layers_.junctions[j][i]; });
      std::array<Bands, detail::most_junctions> light{};
      for (std::size_t j = 0; j < n; ++j) light[j] = down[j][i];
      light = detail::sum_of_sweeps(sweep, n, Bands::filled(1.0f), light);
      for (std::size_t j = 0; j < n; ++j) down[j][i] = light[j];
    });
  }
  [[nodiscard]] bool has_thin_parts() const { return layers_.thin.geometry != nullptr; }

  const SurfaceLayers<N>& layers_;
  mutable Light closure_;  ///< of the bounce under way, if it is the last: 1 / (1 - what returns)
};

}  // namespace

template <int N>
SurfaceLayers<N> make_surface_layers(const CellGraph& graph) {
  return {.graph = &graph};
}

template <int N>
void SurfaceLayers<N>::add_band(int band, const StackTables& tables,
                                std::span<const LayerTexels> texels,
                                std::span<const std::vector<float>> absorbance, double tolerance) {
  assert(tables.layers.size() == texels.size() && absorbance.size() + 1 == texels.size());
  const std::size_t cells = graph->levels.front().area.size(), scales = scale_count(*graph);
  const bool has_ground = tables.ground_reflectance > 0.0;
  if (layers.empty()) {
    layers.resize(texels.size() + (has_ground ? 1 : 0));
    junctions.assign(layers.size() - 1, CellField<N>(cells, BandValues<N>::filled(1.0f)));
  }
  const std::vector<double> blurs = cell_scales_of_gaussians(*graph, tables.variances);
  for (std::size_t l = 0; l < texels.size(); ++l) {
    const bool of_both = follows_absorption(texels[l]);
    add_layer<N>(band,
                 make_transport_layer(tables, l,
                                      of_both ? along_surface_paths(*graph, texels[l]) : texels[l],
                                      static_cast<int>(cells), 1, blurs, tolerance,
                                      of_both ? ProfileAt::both : ProfileAt::exit),
                 cells, scales, layers[l]);
  }
  for (std::size_t j = 0; j < absorbance.size(); ++j)
    for (std::size_t i = 0; i < cells; ++i)
      junctions[j][i][band] = std::exp(-absorbance[j][absorbance[j].size() > 1 ? i : 0]);
  if (has_ground)
    add_layer<N>(band, ground_layer(tables.ground_reflectance, static_cast<int>(cells), 1, scales),
                 cells, scales, layers.back());
}

template <int N>
CellField<N> uniform_reflectance(const SurfaceLayers<N>& layers) {
  const std::size_t cells = layers.graph->levels.front().area.size();
  CellField<N> result(cells);
  const std::size_t last = layers.layers.size() - 1;
  for_cells(cells, [&](std::size_t i) {
    BandValues<N> below = total_at<N>(layers.layers[last], reflection_above, i);
    for (std::size_t l = last; l-- > 0;) {
      const auto total = [&](LayerOperator which) {
        return total_at<N>(layers.layers[l], which, i);
      };
      const BandValues<N> back = layers.junctions[l][i] * layers.junctions[l][i] * below;
      below = total(reflection_above) +
              total(transmission_down) * back * total(transmission_up) /
                  (BandValues<N>::filled(1.0f) - back * total(reflection_below));
    }
    result[i] = below;
  });
  return result;
}

template <int N>
CellField<N> uniform_transmittance(const SurfaceLayers<N>& layers) {
  const std::size_t cells = layers.graph->levels.front().area.size();
  CellField<N> result(cells);
  for_cells(cells, [&](std::size_t i) {
    const auto total = [&](std::size_t layer, LayerOperator which) {
      return total_at<N>(layers.layers[layer], which, i);
    };
    // From above downward: what comes through, and what the layers so far turn back from below.
    BandValues<N> through = total(0, transmission_down), back = total(0, reflection_below);
    for (std::size_t l = 1; l < layers.layers.size(); ++l) {
      const BandValues<N> crossed = layers.junctions[l - 1][i];
      back *= crossed * crossed;
      const BandValues<N> series =
          BandValues<N>::filled(1.0f) /
          (BandValues<N>::filled(1.0f) - back * total(l, reflection_above));
      through *= crossed * total(l, transmission_down) * series;
      back = total(l, reflection_below) +
             total(l, transmission_down) * back * total(l, transmission_up) * series;
    }
    result[i] = through;
  });
  return result;
}

template <int N>
SurfaceTransportResult<N> transport(const SurfaceLayers<N>& layers, const CellField<N>& irradiance,
                                    int interlayer_bounces) {
  assert(interlayer_bounces >= 1 && !layers.layers.empty());
  int bounce = 0;
  const auto is_last = [&](const CellField<N>&) { return ++bounce == interlayer_bounces; };
  auto [reflected, transmitted] =
      detail::sum_interlayer_bounces(SurfaceField<N>(layers), irradiance, true, is_last);
  return {std::move(reflected), std::move(transmitted)};
}

#define LAMINA_INSTANTIATE(N)                                              \
  template struct SurfaceLayers<N>;                                        \
  template SurfaceLayers<N> make_surface_layers<N>(const CellGraph&);      \
  template CellField<N> uniform_reflectance<N>(const SurfaceLayers<N>&);   \
  template CellField<N> uniform_transmittance<N>(const SurfaceLayers<N>&); \
  template SurfaceTransportResult<N> transport<N>(const SurfaceLayers<N>&, const CellField<N>&, int)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
