// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <span>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/heterogeneous/internal/bounce_counter.h"
#include "lamina/solve/scattering/heterogeneous/internal/interlayer_series.h"
#include "lamina/solve/scattering/heterogeneous/internal/local_sweeps.h"
#include "lamina/solve/scattering/heterogeneous/internal/plane_paths.h"

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
    for (std::size_t which = 0; which < 4; ++which) {
      const MappedOperator& from = model.layers[i].operators[which];
      if (from.terms == 0) continue;
      totals[i][which].assign(width, 0.0f);
      add_times_basis(model.layers[i].basis, y, ones, from.totals, totals[i][which]);
    }
  }
  return totals;
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
    for (std::size_t x = 0; x < width; ++x) {
      const auto sweep = detail::local_sweep<double>(
          n,
          [&](std::size_t layer, LayerOperator which) {
            return static_cast<double>(totals[layer][which][x]);
          },
          [&](std::size_t j) { return static_cast<double>(model.junctions[j].values[row + x]); });
      std::array<double, detail::most_junctions> light{};
      for (std::size_t j = 0; j < n; ++j) light[j] = static_cast<double>(down[j].values[row + x]);
      light = detail::sum_of_sweeps(sweep, n, 1.0, light);
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

  PlaneField(const HeterogeneousLayers& model, const Progress& progress)
      : model_(model), progress_(progress) {}

  [[nodiscard]] std::size_t junctions() const { return model_.junctions.size(); }
  [[nodiscard]] bool has_bottom() const {
    return model_.layers.back().operators[transmission_down].terms > 0;
  }
  [[nodiscard]] Plane blur(std::size_t layer, LayerOperator which, const Plane& light) const {
    return std::move(blurs(layer, std::array<std::size_t, 1>{which}, light)[0]);
  }
  [[nodiscard]] std::array<Plane, 2> blur(std::size_t layer, LayerOperator first,
                                          LayerOperator second, const Plane& light) const {
    std::vector<Plane> results = blurs(layer, std::array<std::size_t, 2>{first, second}, light);
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
    ReturnTotals totals = return_totals(model_);
    float most = 0.0f;
    std::vector<float>& returned = totals.below.values;
    for (std::size_t i = 0; i < returned.size(); ++i)
      most = std::max(most, returned[i] *= totals.above.values[i]);
    if (most > detail::most_local_return) totals.below = blur(1, reflection_above, totals.above);
    for (std::size_t i = 0; i < returned.size(); ++i) down[0].values[i] /= 1.0f - returned[i];
  }
  void turn_round(const std::vector<Plane>& up, Plane& arriving) const {
    lamina::turn_round(model_, up, arriving);
  }

 private:
  template <std::size_t K>
  [[nodiscard]] std::vector<Plane> blurs(std::size_t layer, const std::array<std::size_t, K>& which,
                                         const Plane& light) const {
    report_or_throw(progress_, 0.0);
    return apply_layer(model_.pyramid, light, model_.layers[layer], which);
  }

  const HeterogeneousLayers& model_;
  const Progress& progress_;
};

/// The texels with absorption as light on its way meets it.
LayerTexels along_plane_paths(const LayerTexels& texels, const BlurPyramid& pyramid,
                              double mm_per_texel) {
  const auto for_neighbors = [&](const auto& take) {
    detail::for_plane_neighbors(pyramid.width, pyramid.height, take);
  };
  return along_paths(texels, for_neighbors, [&](double length) {
    const std::vector<double> scales = detail::path_scales(pyramid, length / mm_per_texel);
    const MappedOperator blur{
        .terms = 1, .weights = {scales.begin(), scales.end()}, .totals = {1.0f}};
    return apply_operators(pyramid, Plane{pyramid.width, pyramid.height, texels.sigma_a},
                           {.coordinate = make_plane(pyramid.width, pyramid.height)},
                           std::array<const MappedOperator*, 1>{&blur})[0]
        .values;
  });
}

}  // namespace

void check_layer_count(std::size_t layers) {
  if (layers > detail::most_junctions + 1)
    throw InvalidInput("at most " + std::to_string(detail::most_junctions + 1) +
                       " layers can be maps, ground included, but there are " +
                       std::to_string(layers));
}

HeterogeneousLayers make_heterogeneous_layers(const StackTables& tables,
                                              const std::vector<Plane>& sigma_a,
                                              const std::vector<Plane>& absorbance,
                                              double mm_per_texel, ProfileAt profile,
                                              double tolerance) {
  assert(sigma_a.size() == tables.layers.size());
  std::vector<LayerTexels> texels;
  for (std::size_t i = 0; i < sigma_a.size(); ++i) {
    texels.push_back(uniform_texels(state_of(tables.lattices[i].origin)));
    texels.back().sigma_a = sigma_a[i].values;
  }
  return make_heterogeneous_layers(tables, sigma_a[0].width, sigma_a[0].height, texels, absorbance,
                                   mm_per_texel, profile, tolerance);
}

HeterogeneousLayers make_heterogeneous_layers(const StackTables& tables, int width, int height,
                                              const std::vector<LayerTexels>& texels,
                                              const std::vector<Plane>& absorbance,
                                              double mm_per_texel, ProfileAt profile,
                                              double tolerance, const Progress& progress) {
  assert(texels.size() == tables.layers.size() && absorbance.size() + 1 == texels.size());
  const double texel = mm_per_texel * mm_per_texel;
  HeterogeneousLayers model{
      .pyramid = make_blur_pyramid(width, height, widest_spread(tables.lattices) / texel),
      .layers = {},
      .junctions = {}};
  std::vector<double> variances = tables.variances;
  for (double& v : variances) v /= texel;
  const std::vector<double> scales = scales_of_gaussians(model.pyramid, variances);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const bool of_both = profile == ProfileAt::both && follows_absorption(texels[i]);
    model.layers.push_back(make_transport_layer(
        tables, i, of_both ? along_plane_paths(texels[i], model.pyramid, mm_per_texel) : texels[i],
        width, height, scales, tolerance, of_both ? ProfileAt::both : ProfileAt::exit));
    report_or_throw(progress, static_cast<double>(i + 1) / static_cast<double>(texels.size()));
  }
  for (const Plane& sheet : absorbance) {
    Plane left = sheet;
    for (float& value : left.values) value = std::exp(-value);
    model.junctions.push_back(std::move(left));
  }
  if (tables.ground_reflectance > 0.0) {
    model.layers.push_back(
        ground_layer(tables.ground_reflectance, width, height, model.pyramid.variances.size()));
    model.junctions.push_back(make_plane(width, height, 1.0f));
  }
  check_layer_count(model.layers.size());
  return model;
}

TransportResult transport(const HeterogeneousLayers& model, const Plane& irradiance,
                          const TransportOptions& options, const Progress& progress) {
  assert(irradiance.width == model.pyramid.width && irradiance.height == model.pyramid.height);
  detail::BounceCounter counter(options);
  const auto is_last = [&](const Plane& down) {
    return counter.is_last(std::accumulate(down.values.begin(), down.values.end(), 0.0));
  };
  auto light = detail::sum_interlayer_bounces(PlaneField(model, progress), irradiance,
                                              options.has_local_closure, is_last);
  TransportResult result{.reflected = std::move(light.reflected),
                         .transmitted = {},
                         .interlayer_bounces = counter.bounces(),
                         .last_bounce = counter.last_part()};
  result.transmitted = light.transmitted.values.empty()
                           ? make_plane(model.pyramid.width, model.pyramid.height)
                           : std::move(light.transmitted);
  return result;
}

}  // namespace lamina
