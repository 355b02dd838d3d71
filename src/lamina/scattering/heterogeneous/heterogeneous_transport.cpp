// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/heterogeneous_transport.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <span>
#include <string>

#include "lamina/core/error.h"
#include "lamina/optics/medium.h"
#include "lamina/scattering/heterogeneous/internal/basis_row.h"
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
  for (std::size_t i = 0; i < totals.size(); ++i) {
    detail::BasisRow functions(model.layers[i].basis);
    functions.move_to(y);
    for (std::size_t which = 0; which < 4; ++which) {
      const MappedOperator& from = model.layers[i].operators[which];
      if (from.terms == 0) continue;
      totals[i][which].assign(width, 0.0f);
      functions.add_times_sum(ones.data(), from.totals, totals[i][which].data(), width);
    }
  }
  return totals;
}

/// What one sweep up and down makes, at a texel as if all were like it, of light that goes down at
/// the junctions; [to][from].
constexpr std::size_t most_junctions = 7;
using Local = std::array<std::array<double, most_junctions>, most_junctions>;

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
    for (std::size_t x = 0; x < width; ++x) {
      std::array<double, most_junctions> light{};
      for (std::size_t j = 0; j < n; ++j) light[j] = static_cast<double>(down[j].values[row + x]);
      light = sum_of_sweeps(local_sweep(totals, junctions, x), n, light);
      for (std::size_t j = 0; j < n; ++j) down[j].values[row + x] = static_cast<float>(light[j]);
    }
  }
}

/// The two fractions that make light which goes down through the only junction come down again, as
/// if all were like the texel: what turns round above the junction, which it crosses twice, and
/// below it.
struct ReturnTotals {
  Plane above, below;
};
ReturnTotals return_totals(const HeterogeneousLayers& model) {
  const int width = model.pyramid.width, height = model.pyramid.height;
  ReturnTotals result{make_plane(width, height), make_plane(width, height)};
  for (int y = 0; y < height; ++y) {
    const RowTotals totals = row_totals(model, y);
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    const float* junction = &model.junctions[0].values[row];
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
      result.above.values[row + x] = junction[x] * junction[x] * totals[0][reflection_below][x];
      result.below.values[row + x] = totals[1][reflection_above][x];
    }
  }
  return result;
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
    return model_.layers.back().operators[transmission_down].terms > 0;
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
  void close(std::vector<Plane>& down) const {
    if (down.size() > 1) return lamina::close(model_, down);
    // The sum of a geometric series. Where most light turns round again and again, it is returned
    // by what is around the texel: 1 / (1 - r) of the texel alone would make light of nothing, for
    // its mean is not that of the mean r.
    constexpr float most_local = 0.5f;
    ReturnTotals totals = return_totals(model_);
    float most = 0.0f;
    std::vector<float>& returned = totals.below.values;
    for (std::size_t i = 0; i < returned.size(); ++i)
      most = std::max(most, returned[i] *= totals.above.values[i]);
    if (most > most_local) totals.below = blur(1, reflection_above, totals.above);
    for (std::size_t i = 0; i < returned.size(); ++i) down[0].values[i] /= 1.0f - returned[i];
  }
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
    return apply_(model_.pyramid, light, at.basis, operators);
  }

  const HeterogeneousLayers& model_;
  std::vector<Plane> (*apply_)(const BlurPyramid&, const Plane&, const TexelBasis&,
                               std::span<const MappedOperator* const>);
};

/// Variance beyond which little light of any layer goes [mm²]: 4 / sigma_tr² of the state that
/// absorbs least, of skin no less than what holds the tail of a dermis without blood.
double widest_spread(const StackTables& tables) {
  constexpr double of_skin = 13.2, most = 400.0;
  double widest = of_skin;
  for (const StateLattice& lattice : tables.lattices) {
    const bool is_any_absorption = lattice.axes.size() == 1 && lattice.origin[0] == 0.0;
    if (is_any_absorption) continue;
    for (std::size_t node = 0; node < node_count(lattice); ++node) {
      const LayerState state = node_state(lattice, node);
      const double root =
          sigma_tr({.sigma_a = state.sigma_a, .sigma_s = state.sigma_s, .g = state.g});
      widest = std::max(widest, 4.0 / (root * root));
    }
  }
  return std::min(widest, most);
}

}  // namespace

HeterogeneousLayers make_heterogeneous_layers(const StackTables& tables,
                                              const std::vector<Plane>& sigma_a,
                                              const std::vector<Plane>& absorbance,
                                              double mm_per_texel, double tolerance) {
  assert(sigma_a.size() == tables.layers.size());
  std::vector<LayerTexels> texels;
  for (std::size_t i = 0; i < sigma_a.size(); ++i) {
    texels.push_back(uniform_texels(state_of(tables.lattices[i].origin)));
    texels.back().sigma_a = sigma_a[i].values;
  }
  return make_heterogeneous_layers(tables, sigma_a[0].width, sigma_a[0].height, texels, absorbance,
                                   mm_per_texel, tolerance, BasisKind::powers);
}

HeterogeneousLayers make_heterogeneous_layers(const StackTables& tables, int width, int height,
                                              const std::vector<LayerTexels>& texels,
                                              const std::vector<Plane>& absorbance,
                                              double mm_per_texel, double tolerance,
                                              BasisKind kind) {
  assert(texels.size() == tables.layers.size() && absorbance.size() + 1 == texels.size());
  const double texel = mm_per_texel * mm_per_texel;
  HeterogeneousLayers model{
      .pyramid = make_blur_pyramid(width, height, widest_spread(tables) / texel),
      .layers = {},
      .junctions = {}};
  std::vector<double> variances = tables.variances;
  for (double& v : variances) v /= texel;
  const std::vector<double> scales = scales_of_gaussians(model.pyramid, variances);
  for (std::size_t i = 0; i < texels.size(); ++i)
    model.layers.push_back(
        make_transport_layer(tables, i, texels[i], width, height, scales, tolerance, kind));
  for (const Plane& sheet : absorbance) {
    Plane left = sheet;
    for (float& value : left.values) value = std::exp(-value);
    model.junctions.push_back(std::move(left));
  }
  if (tables.ground_reflectance > 0.0) {
    const auto ground = static_cast<float>(tables.ground_reflectance);
    TransportLayer layer{.basis = {.coordinate = make_plane(width, height)}, .operators = {}};
    MappedOperator& reflection = layer.operators[reflection_above];
    reflection = {.terms = 1,
                  .weights = std::vector<float>(model.pyramid.variances.size(), 0.0f),
                  .totals = {ground}};
    reflection.weights[0] = ground;  // where the light is
    model.layers.push_back(std::move(layer));
    model.junctions.push_back(make_plane(width, height, 1.0f));
  }
  if (model.junctions.size() > most_junctions)
    throw InvalidInput("at most " + std::to_string(most_junctions + 1) +
                       " layers can be maps, ground included, but there are " +
                       std::to_string(model.layers.size()));
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
