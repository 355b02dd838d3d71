// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/shading/thin_sheet.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/shading/internal/cosine_table.h"
#include "lamina/scene/description/materials_in_use.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

constexpr int steps_per_octave = 2;  // of the table over thickness
constexpr int octaves = 3;           // thinner and thicker than the material

double total_thickness(const Material& material) {
  double sum = 0.0;
  for (const MaterialLayer& layer : material.layers) sum += layer.thickness;
  return sum;
}

Material scaled(Material material, double factor) {
  for (MaterialLayer& layer : material.layers) layer.thickness *= factor;
  return material;
}

}  // namespace

template <int N>
ThinSheet<N>::ThinSheet(const SurfaceMaterial& material) {
  const auto& thin = std::get<ThinSurface>(material.surface);
  const Material& layers = thin.material;
  const double own = total_thickness(layers);
  const auto require = [&](bool holds, const char* rule) {
    if (!holds) throw InvalidInput("material \"" + material.name + "\": thin: " + rule);
  };
  require(std::isfinite(own) && !layers.layers.empty(), "every layer must have a finite thickness");
  require(layers.ground.reflectance == 0.0, "there must be no ground below the layers");
  const bool is_mapped = thin.thickness && thin.thickness->map;
  thickness_ = thin.thickness.value_or(ScalarParameter{.value = static_cast<float>(own)});
  if (is_mapped)
    for (int i = -octaves * steps_per_octave; i <= octaves * steps_per_octave; ++i)
      log_thickness_.push_back(
          static_cast<float>(std::log(own) + i * std::log(2.0) / steps_per_octave));
  else
    log_thickness_ = {std::log(std::max(thickness_.value, 1e-12f))};
  rows_.resize(log_thickness_.size());
  const std::size_t bands = layers.bands.size();
  try {
    parallel_for(rows_.size() * bands, [&](std::size_t job) {
      const std::size_t r = job / bands, b = job % bands;
      const int lane = static_cast<int>(b);
      const double thickness = std::exp(static_cast<double>(log_thickness_[r]));
      const LayerStack top = layer_stack(scaled(layers, thickness / own), b);
      for (std::size_t s = 0; s < 2; ++s) {
        const LayerStack stack = s == 0 ? top : flipped(top);
        Side& side = rows_[r].sides[s];
        const auto solved = adding_doubling_by_angle(stack, table_incidences(), {.accuracy = 1e-4});
        for (std::size_t i = 0; i < cosine_nodes; ++i) {
          const SlabTotals& totals = solved[i].totals;
          const double straight = solved[i].unscattered_transmittance;
          const double entered = 1.0 - totals.specular_reflectance;
          side.at[i].reflected[lane] = static_cast<float>(totals.diffuse_reflectance / entered);
          side.at[i].transmitted[lane] =
              static_cast<float>(std::max(0.0, totals.transmittance - straight) / entered);
          side.at[i].straight[lane] = static_cast<float>(straight / entered);
        }
        // Of the interpolated values, so that what leaves adds up to what there is.
        const double eta = stack.layers().front().medium.ior / stack.ior_above();
        const Quadrature rule = gauss_legendre(64, 0.0, 1.0);
        double entered = 0.0, reflected = 0.0, transmitted = 0.0;
        for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
          const double mu = rule.nodes[k];
          const double weight = rule.weights[k] * 2.0 * mu * (1.0 - fresnel(mu, eta));
          const Fractions at = at_cosine(side, static_cast<float>(mu));
          entered += weight;
          reflected += weight * static_cast<double>(at.reflected[lane]);
          transmitted += weight * static_cast<double>(at.transmitted[lane]);
        }
        side.mean_reflected[lane] = static_cast<float>(reflected / entered);
        side.mean_transmitted[lane] = static_cast<float>(transmitted / entered);
      }
    });
  } catch (const InvalidInput& error) {
    throw InvalidInput("material \"" + material.name + "\": thin: " + error.what());
  }
}

template <int N>
typename ThinSheet<N>::Place ThinSheet<N>::place_at(const TextureStore& textures,
                                                    const SurfacePoint& point) const {
  if (rows_.size() == 1) return {};
  const float thickness = std::max(textures.scalar(thickness_, point), 1e-12f);
  const float step = log_thickness_[1] - log_thickness_[0];
  const float x = std::clamp((std::log(thickness) - log_thickness_[0]) / step, 0.0f,
                             static_cast<float>(rows_.size() - 1));
  const auto row = std::min(static_cast<std::size_t>(x), rows_.size() - 2);
  return {row, x - static_cast<float>(row)};
}

template <int N>
typename ThinSheet<N>::Fractions ThinSheet<N>::at_cosine(const Side& side, float cos_i) {
  const auto [i, f] = table_place(cos_i);
  const Fractions &a = side.at[i], &b = side.at[i + 1];
  return {mix(a.reflected, b.reflected, f), mix(a.transmitted, b.transmitted, f),
          mix(a.straight, b.straight, f)};
}

template <int N>
typename ThinSheet<N>::Fractions ThinSheet<N>::fractions(const Place& place, int side,
                                                         float cos_i) const {
  const auto s = static_cast<std::size_t>(side);
  const Fractions a = at_cosine(rows_[place.row].sides[s], cos_i);
  if (place.blend == 0.0f) return a;
  const Fractions b = at_cosine(rows_[place.row + 1].sides[s], cos_i);
  return {mix(a.reflected, b.reflected, place.blend),
          mix(a.transmitted, b.transmitted, place.blend), mix(a.straight, b.straight, place.blend)};
}

template <int N>
BandValues<N> ThinSheet<N>::reflection(const Place& place, int side, float cos_i,
                                       float cos_o) const {
  const auto in_row = [&](std::size_t row) {
    const Side& s = rows_[row].sides[static_cast<std::size_t>(side)];
    return separable(at_cosine(s, cos_i).reflected, at_cosine(s, cos_o).reflected,
                     s.mean_reflected);
  };
  const Bands value = in_row(place.row);
  return place.blend == 0.0f ? value : mix(value, in_row(place.row + 1), place.blend);
}

template <int N>
BandValues<N> ThinSheet<N>::transmission(const Place& place, int side, float cos_i,
                                         float cos_o) const {
  const auto in_row = [&](std::size_t row) {
    const auto& sides = rows_[row].sides;
    const Side &in = sides[static_cast<std::size_t>(side)],
               &out = sides[static_cast<std::size_t>(1 - side)];
    return separable(at_cosine(in, cos_i).transmitted, at_cosine(out, cos_o).transmitted,
                     out.mean_transmitted);
  };
  const Bands value = in_row(place.row);
  return place.blend == 0.0f ? value : mix(value, in_row(place.row + 1), place.blend);
}

template <int N>
ThinSheets<N> make_thin_sheets(const Scene& scene) {
  ThinSheets<N> sheets(scene.materials.size());
  const std::vector<bool> is_used = materials_in_use(scene);
  for (std::size_t i = 0; i < sheets.size(); ++i)
    if (is_used[i] && std::holds_alternative<ThinSurface>(scene.materials[i].surface))
      sheets[i] = std::make_unique<ThinSheet<N>>(scene.materials[i]);
  return sheets;
}

#define LAMINA_INSTANTIATE(N)  \
  template class ThinSheet<N>; \
  template ThinSheets<N> make_thin_sheets<N>(const Scene&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
