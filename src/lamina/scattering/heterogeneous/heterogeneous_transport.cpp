// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/heterogeneous_transport.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "lamina/scattering/heterogeneous/internal/gaussian_blur_kernels.h"

namespace lamina {
namespace {

enum Which { reflection_above, transmission_down, reflection_below, transmission_up };

/// Light on a layer, and what some of its operators make of it.
class Operators {
 public:
  Operators(const HeterogeneousLayers& model, ProfileAt profile)
      : model_(model), apply_(profile == ProfileAt::exit ? apply : apply_reciprocally) {}

  [[nodiscard]] Plane one(std::size_t layer, Which which, const Plane& light) const {
    const TransportLayer& at = model_.layers[layer];
    const std::array<const MappedOperator*, 1> operators = {&at.operators[which]};
    return std::move(apply_(model_.ladder, light, at.coordinate, operators)[0]);
  }

  [[nodiscard]] std::array<Plane, 2> both(std::size_t layer, Which first, Which second,
                                          const Plane& light) const {
    const TransportLayer& at = model_.layers[layer];
    const std::array<const MappedOperator*, 2> operators = {&at.operators[first],
                                                            &at.operators[second]};
    std::vector<Plane> results = apply_(model_.ladder, light, at.coordinate, operators);
    return {std::move(results[0]), std::move(results[1])};
  }

 private:
  const HeterogeneousLayers& model_;
  std::vector<Plane> (*apply_)(const BlurLadder&, const Plane&, const Plane&,
                               std::span<const MappedOperator* const>);
};

void add(Plane& sum, const Plane& more) {
  if (sum.values.empty()) {
    sum = more;
    return;
  }
  for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += more.values[i];
}

void multiply(Plane& plane, const Plane& factor) {
  for (std::size_t i = 0; i < plane.values.size(); ++i) plane.values[i] *= factor.values[i];
}

double total(const Plane& plane) {
  return std::accumulate(plane.values.begin(), plane.values.end(), 0.0);
}

/// Totals of all operators along a row of texels, [layer][which][x]; empty where there is none.
using RowTotals = std::vector<std::array<std::vector<float>, 4>>;

RowTotals row_totals(const HeterogeneousLayers& model, int y) {
  const auto width = static_cast<std::size_t>(model.ladder.width);
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
  const auto at = [&](std::size_t layer, Which which) {
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
  const auto width = static_cast<std::size_t>(model.ladder.width);
  for (int y = 0; y < model.ladder.height; ++y) {
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
  const auto width = static_cast<std::size_t>(model.ladder.width);
  for (int y = 0; y < model.ladder.height; ++y) {
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

}  // namespace

HeterogeneousLayers make_heterogeneous_layers(const StackTables& tables,
                                              const std::vector<Plane>& sigma_a,
                                              const std::vector<Plane>& absorbance,
                                              double mm_per_texel, double tolerance) {
  assert(sigma_a.size() == tables.layers.size() && absorbance.size() + 1 == sigma_a.size());
  assert(absorbance.size() <= most_junctions && mm_per_texel > 0.0);
  const double texel = mm_per_texel * mm_per_texel;
  // Gaussians beyond 13 mm² hold the tail of a dermis without blood; the widest rung serves them.
  constexpr double widest = 13.2;
  HeterogeneousLayers model{
      .ladder = make_blur_ladder(sigma_a[0].width, sigma_a[0].height, widest / texel),
      .layers = {},
      .junctions = {}};
  std::vector<double> variances = tables.variances;
  for (double& v : variances) v /= texel;
  const std::vector<double> rungs = rungs_of_gaussians(model.ladder, variances);
  for (std::size_t i = 0; i < sigma_a.size(); ++i) {
    const AbsorptionRange range = absorption_range(sigma_a[i], tables.grid);
    TransportLayer layer{absorption_coordinate(sigma_a[i], range), {}};
    const LayerTables& from = tables.layers[i];
    const GaussianTable* each[] = {&from.reflection_above, &from.transmission_down,
                                   &from.reflection_below, &from.transmission_up};
    for (std::size_t which = 0; which < 4; ++which)
      if (!each[which]->weights.empty())
        layer.operators[which] =
            make_mapped_operator(tables, *each[which], range, rungs, tolerance);
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
  assert(irradiance.width == model.ladder.width && irradiance.height == model.ladder.height);
  constexpr int most_bounces = 100;
  const Operators operators(model, options.profile);
  const std::size_t n = model.junctions.size();
  const bool has_bottom = model.layers.back().operators[transmission_down].powers > 0;
  TransportResult result;
  Plane reflected, transmitted = make_plane(model.ladder.width, model.ladder.height);
  if (n == 0) {
    reflected = operators.one(0, reflection_above, irradiance);
    if (has_bottom) transmitted = operators.one(0, transmission_down, irradiance);
  } else {
    std::vector<Plane> up(n), down(n);
    {
      auto [r, t] = operators.both(0, reflection_above, transmission_down, irradiance);
      reflected = std::move(r);
      down[0] = std::move(t);
    }
    Plane all_up;    // through the uppermost junction
    Plane arriving;  // on the last layer, where it lets some through
    double all_down = 0.0;
    for (bool is_last = false; !is_last;) {
      // Down: what has turned round, and what passes on from above.
      for (std::size_t j = 0; j < n; ++j) {
        if (j > 0) add(down[j], operators.one(j, transmission_down, down[j - 1]));
        multiply(down[j], model.junctions[j]);
      }
      ++result.interlayer_bounces;
      const double now = total(down[0]);
      all_down += now;
      result.last_bounce = all_down > 0.0 ? now / all_down : 0.0;
      is_last = options.interlayer_bounces > 0
                    ? result.interlayer_bounces >= options.interlayer_bounces
                    : result.last_bounce < 1.0 - options.energy_threshold ||
                          result.interlayer_bounces >= most_bounces;
      if (has_bottom) add(arriving, down[n - 1]);
      const bool closes = is_last && options.has_local_closure;
      if (closes) close(model, down);
      // Up again; of what comes up, a part turns round once more.
      for (std::size_t j = n; j-- > 0;) {
        up[j] = operators.one(j + 1, reflection_above, down[j]);
        if (j + 1 < n) {
          auto [r, t] = operators.both(j + 1, reflection_below, transmission_up, up[j + 1]);
          down[j + 1] = std::move(r);
          add(up[j], t);
        }
        multiply(up[j], model.junctions[j]);
      }
      add(all_up, up[0]);
      if (closes && has_bottom) turn_round(model, up, arriving);
      if (!is_last) down[0] = operators.one(0, reflection_below, up[0]);
    }
    add(reflected, operators.one(0, transmission_up, all_up));
    if (has_bottom) transmitted = operators.one(n, transmission_down, arriving);
  }
  result.reflected = std::move(reflected);
  result.transmitted = std::move(transmitted);
  return result;
}

}  // namespace lamina
