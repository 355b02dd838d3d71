// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/heterogeneous_transport.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <span>

#include "lamina/scattering/heterogeneous/internal/gaussian_blur_kernels.h"
#include "lamina/scattering/heterogeneous/internal/interlayer_series.h"

namespace lamina {
namespace {

using detail::LayerOperator;
using enum detail::LayerOperator;

/// Totals of all operators along a row of texels, [layer][which][x]; empty where there is none.
using RowTotals = std::vector<std::array<std::vector<float>, 4>>;

RowTotals row_totals(const HeterogeneousLayers& model, int y) {
  const auto width = static_cast<std::size_t>(model.pyramid.width);
  const std::vector<float> ones(width, 1.0f);
  RowTotals totals(model.layers.size());
  for (std::size_t i = 0; i < totals.size(); ++i)
    for (std::size_t which = 0; which < 4; ++which) {
      const MappedOperator& from = model.layers[i].operators[which];
      if (from.powers == 0) continue;
      totals[i][which].assign(width, 0.0f);
      detail::add_times_polynomial(
          ones.data(),
          model.layers[i].coordinate.values.data() + static_cast<std::size_t>(y) * width,
          from.totals, totals[i][which].data(), width);
    }
  return totals;
}

/// What one sweep up and down makes, at a texel as if all were like it, of light that goes down at
/// the junctions; [to][from].
using Local = std::array<std::array<double, 3>, 3>;

constexpr std::size_t most_junctions = 3;

Local local_sweep(const RowTotals& totals, const std::vector<const float*>& junctions,
                  std::size_t x) {
  const std::size_t n = junctions.size();
  const auto at = [&](std::size_t layer, LayerOperator which) {
    return static_cast<double>(totals[layer][which][x]);
  };
  Local sweep{};
  for (std::size_t from = 0; from < n; ++from) {
    std::array<double, most_junctions> up{}, down{};
    for (std::size_t j = n; j-- > 0;) {
      up[j] = j == from ? at(j + 1, reflection_above) : 0.0;
      if (j + 1 < n) up[j] += at(j + 1, transmission_up) * up[j + 1];
      up[j] *= static_cast<double>(junctions[j][x]);
    }
    for (std::size_t j = 0; j < n; ++j) {
      down[j] = at(j, reflection_below) * up[j];
      if (j > 0) down[j] += at(j, transmission_down) * down[j - 1];
      down[j] *= static_cast<double>(junctions[j][x]);
      sweep[j][from] = down[j];
    }
  }
  return sweep;
}

/// Solves (1 - sweep) x = light by Gauss's elimination; no pivots are needed, since no sweep gains
/// energy.
std::array<double, most_junctions> sum_of_sweeps(Local sweep, std::size_t n,
                                                 std::array<double, most_junctions> light) {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) sweep[i][j] = (i == j ? 1.0 : 0.0) - sweep[i][j];
  for (std::size_t p = 0; p < n; ++p)
    for (std::size_t i = p + 1; i < n; ++i) {
      const double share = sweep[i][p] / sweep[p][p];
      for (std::size_t j = p; j < n; ++j) sweep[i][j] -= share * sweep[p][j];
      light[i] -= share * light[p];
    }
  for (std::size_t p = n; p-- > 0;) {
    for (std::size_t j = p + 1; j < n; ++j) light[p] -= sweep[p][j] * light[j];
    light[p] /= sweep[p][p];
  }
  return light;
}

/// Adds to the light that goes down in the last sweep what all further sweeps would bring there.
/// What is below spreads it then: so little of the error that texels are not like one another
/// stays.
void close(const HeterogeneousLayers& model, std::vector<Plane>& down) {
  const std::size_t n = down.size();
  const auto width = static_cast<std::size_t>(model.pyramid.width);
  for (int y = 0; y < model.pyramid.height; ++y) {
    const RowTotals totals = row_totals(model, y);
    const std::size_t row = static_cast<std::size_t>(y) * width;
    std::vector<const float*> junctions;
    for (const Plane& junction : model.junctions) junctions.push_back(&junction.values[row]);
    if (n == 1) {  // skin: the sum of a geometric series
      const float* back = totals[0][reflection_below].data();
      const float* deep = totals[1][reflection_above].data();
      float* light = &down[0].values[row];
      for (std::size_t x = 0; x < width; ++x)
        light[x] /= 1.0f - junctions[0][x] * junctions[0][x] * back[x] * deep[x];
      continue;
    }
    for (std::size_t x = 0; x < width; ++x) {
      std::array<double, most_junctions> light{};
      for (std::size_t j = 0; j < n; ++j) light[j] = static_cast<double>(down[j].values[row + x]);
      light = sum_of_sweeps(local_sweep(totals, junctions, x), n, light);
      for (std::size_t j = 0; j < n; ++j) down[j].values[row + x] = static_cast<float>(light[j]);
    }
  }
}

/// Adds to the light on the last layer what the light that goes up brings there when it turns
/// round, as if all texels were like the one at hand.
void turn_round(const HeterogeneousLayers& model, const std::vector<Plane>& up, Plane& arriving) {
  const auto width = static_cast<std::size_t>(model.pyramid.width);
  for (int y = 0; y < model.pyramid.height; ++y) {
    const RowTotals totals = row_totals(model, y);
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * width + x;
      float down = 0.0f;
      for (std::size_t j = 0; j < up.size(); ++j) {
        const float passed = j > 0 ? totals[j][transmission_down][x] * down : 0.0f;
        down = model.junctions[j].values[at] *
               (passed + totals[j][reflection_below][x] * up[j].values[at]);
      }
      arriving.values[at] += down;
    }
  }
}

/// Planes of texels, as detail::sum_interlayer_bounces takes them.
class PlaneField {
 public:
  using Light = Plane;

  PlaneField(const HeterogeneousLayers& model, ProfileAt profile)
      : model_(model),
        apply_(profile == ProfileAt::exit ? apply_operators : apply_operators_reciprocally) {}

  [[nodiscard]] std::size_t junctions() const { return model_.junctions.size(); }
  [[nodiscard]] bool has_bottom() const {
    return model_.layers.back().operators[transmission_down].powers > 0;
  }
  [[nodiscard]] Plane blur(std::size_t layer, LayerOperator which, const Plane& light) const {
    return std::move(blurs(layer, std::array{which}, light)[0]);
  }
  [[nodiscard]] std::array<Plane, 2> blur(std::size_t layer, LayerOperator first,
                                          LayerOperator second, const Plane& light) const {
    std::vector<Plane> results = blurs(layer, std::array{first, second}, light);
    return {std::move(results[0]), std::move(results[1])};
  }
  void multiply(Plane& light, std::size_t junction) const {
    const std::vector<float>& factor = model_.junctions[junction].values;
    for (std::size_t i = 0; i < factor.size(); ++i) light.values[i] *= factor[i];
  }
  void add(Plane& sum, Plane more) const {
    if (sum.values.empty())
      sum = std::move(more);
    else
      for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += more.values[i];
  }
  void close(std::vector<Plane>& down) const { lamina::close(model_, down); }
  void turn_round(const std::vector<Plane>& up, Plane& arriving) const {
    lamina::turn_round(model_, up, arriving);
  }

 private:
  template <std::size_t K>
  [[nodiscard]] std::vector<Plane> blurs(std::size_t layer,
                                         const std::array<LayerOperator, K>& which,
                                         const Plane& light) const {
    const TransportLayer& at = model_.layers[layer];
    std::array<const MappedOperator*, K> operators;
    for (std::size_t k = 0; k < K; ++k) operators[k] = &at.operators[which[k]];
    return apply_(model_.pyramid, light, at.coordinate, operators);
  }

  const HeterogeneousLayers& model_;
  std::vector<Plane> (*apply_)(const BlurPyramid&, const Plane&, const Plane&,
                               std::span<const MappedOperator* const>);
};

}  // namespace

HeterogeneousLayers make_heterogeneous_layers(const StackTables& tables,
                                              const std::vector<Plane>& sigma_a,
                                              const std::vector<Plane>& absorbance,
                                              double mm_per_texel, double tolerance) {
  assert(sigma_a.size() == tables.layers.size() && absorbance.size() + 1 == sigma_a.size());
  assert(absorbance.size() <= most_junctions && mm_per_texel > 0.0);
  const double texel = mm_per_texel * mm_per_texel;
  // Gaussians beyond 13 mm² hold the tail of a dermis without blood; the widest scale serves them.
  constexpr double widest = 13.2;
  HeterogeneousLayers model{
      .pyramid = make_blur_pyramid(sigma_a[0].width, sigma_a[0].height, widest / texel),
      .layers = {},
      .junctions = {}};
  std::vector<double> variances = tables.variances;
  for (double& v : variances) v /= texel;
  const std::vector<double> scales = scales_of_gaussians(model.pyramid, variances);
  for (std::size_t i = 0; i < sigma_a.size(); ++i) {
    const AbsorptionRange range = absorption_range(sigma_a[i], tables.grid);
    TransportLayer layer{absorption_coordinate(sigma_a[i], range), {}};
    const LayerTables& from = tables.layers[i];
    const auto each = operator_tables(from);
    for (std::size_t which = 0; which < 4; ++which)
      if (!each[which]->weights.empty())
        layer.operators[which] =
            make_mapped_operator(tables, *each[which], range, scales, tolerance);
    model.layers.push_back(std::move(layer));
  }
  for (const Plane& sheet : absorbance) {
    Plane left = sheet;
    for (float& value : left.values) value = std::exp(-value);
    model.junctions.push_back(std::move(left));
  }
  return model;
}

TransportResult transport(const HeterogeneousLayers& model, const Plane& irradiance,
                          const TransportOptions& options) {
  assert(irradiance.width == model.pyramid.width && irradiance.height == model.pyramid.height);
  constexpr int most_bounces = 100;
  TransportResult result;
  double all_down = 0.0;
  const auto is_last = [&](const Plane& down) {
    ++result.interlayer_bounces;
    const double now = std::accumulate(down.values.begin(), down.values.end(), 0.0);
    all_down += now;
    result.last_bounce = all_down > 0.0 ? now / all_down : 0.0;
    return options.interlayer_bounces > 0 ? result.interlayer_bounces >= options.interlayer_bounces
                                          : result.last_bounce < 1.0 - options.energy_threshold ||
                                                result.interlayer_bounces >= most_bounces;
  };
  auto light = detail::sum_interlayer_bounces(PlaneField(model, options.profile), irradiance,
                                              options.has_local_closure, is_last);
  result.reflected = std::move(light.reflected);
  result.transmitted = light.transmitted.values.empty()
                           ? make_plane(model.pyramid.width, model.pyramid.height)
                           : std::move(light.transmitted);
  return result;
}

}  // namespace lamina
