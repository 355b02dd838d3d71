// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/shading/covering.h"

#include <algorithm>
#include <cmath>

#include "lamina/core/error.h"
#include "lamina/core/parallel.h"
#include "lamina/core/quadrature.h"
#include "lamina/optics/fresnel.h"
#include "lamina/reflectance/material_totals.h"
#include "lamina/render/shading/internal/table_incidences.h"
#include "lamina/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

/// The stack of coverings of a state on what they lie on, of one band.
LayerStack stack_of(const SurfaceMaterial& material, std::size_t state, std::size_t band) {
  const std::span<const Covering> over = coverings_of(material);
  std::vector<Layer> layers;
  for (std::size_t i = over.size(); i-- > 0;) {  // the last one is on top
    if (!(state >> i & 1)) continue;
    const LayerStack own = layer_stack(over[i].material, band);
    if (is_semi_infinite(own))
      throw InvalidInput("\"" + over[i].name + "\": every layer must have a finite thickness");
    layers.insert(layers.end(), own.layers().begin(), own.layers().end());
  }
  const auto* subsurface = std::get_if<SubsurfaceSurface>(&material.surface);
  if (!subsurface) {  // a matte surface is in touch with what covers it
    const double ior = layers.back().medium.ior;
    return LayerStack(std::move(layers), 1.0, ior);
  }
  const LayerStack base = layer_stack(subsurface->material, band);
  const Layer& first = base.layers().front();
  return LayerStack(std::move(layers), base.ior_above(), first.medium.ior, {.top = first.top});
}

/// The interpolated value of a table over cosines.
template <int N, std::size_t nodes>
BandValues<N> at_cosine(const std::array<BandValues<N>, nodes>& table, float cosine) {
  const float x = std::clamp(cosine, 0.0f, 1.0f) * static_cast<float>(nodes - 1);
  const auto i = std::min(static_cast<std::size_t>(x), nodes - 2);
  const float f = x - static_cast<float>(i);
  return table[i] + f * (table[i + 1] - table[i]);
}

float entering_of(const BoundaryReflectance* boundary, float roughness) {
  return boundary ? 1.0f - boundary->diffuse(roughness) : 1.0f;
}

}  // namespace

template <int N>
CoveringTable<N>::CoveringTable(const RenderScene& scene, std::uint32_t material) {
  const SurfaceMaterial& surface = scene.scene->materials[material];
  states_.resize(std::size_t{1} << coverings_of(surface).size());
  const RenderScene::Boundaries& boundaries = scene.boundaries[material];
  State& bare = states_[0];
  bare.reflected.fill({});
  bare.through.fill(Bands::filled(1.0f));
  const float eta = boundaries.own ? boundaries.own->ior() : 1.0f;
  bare.leaving = entering_of(boundaries.own.get(), boundaries.own_roughness) / (eta * eta);
  bare.below = Bands::filled(1.0f - bare.leaving);
  for (std::size_t state = 1; state < states_.size(); ++state) solve(scene, material, state);
}

template <int N>
void CoveringTable<N>::solve(const RenderScene& scene, std::uint32_t material, std::size_t state) {
  const SurfaceMaterial& surface = scene.scene->materials[material];
  const std::span<const Covering> over = coverings_of(surface);
  State& found = states_[state];
  std::size_t top = over.size() - 1;
  while (!(state >> top & 1)) --top;
  const RenderScene::CoveringTop& boundary = scene.boundaries[material].over[top];
  const LayerStack first = stack_of(surface, state, 0);
  const auto eta_below = static_cast<float>(first.ior_below() / first.ior_above());
  found.leaving = entering_of(boundary.table.get(), boundary.roughness) / (eta_below * eta_below);
  const std::vector<Incidence> incidences = table_incidences(nodes);
  const Quadrature rule = gauss_legendre(64, 0.0, 1.0);
  try {
    parallel_for(over[top].material.bands.size(), [&](std::size_t band) {
      const int lane = static_cast<int>(band);
      const LayerStack stack = with_smooth_ends(stack_of(surface, state, band));
      const auto solved = adding_doubling_by_angle(stack, incidences, {.accuracy = 1e-4});
      for (std::size_t i = 0; i < nodes; ++i) {
        const SlabTotals& totals = solved[i].totals;
        const double entered = 1.0 - totals.specular_reflectance;
        found.reflected[i][lane] = static_cast<float>(totals.diffuse_reflectance / entered);
        found.through[i][lane] = static_cast<float>(totals.transmittance / entered);
      }
      // Of the interpolated values, so that what leaves adds up to what there is.
      const double eta = stack.layers().front().medium.ior / stack.ior_above();
      double entered = 0.0, reflected = 0.0;
      for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double mu = rule.nodes[k];
        const double weight = rule.weights[k] * 2.0 * mu * (1.0 - fresnel(mu, eta));
        entered += weight;
        reflected +=
            weight * static_cast<double>(at_cosine(found.reflected, static_cast<float>(mu))[lane]);
      }
      found.mean_reflected[lane] = static_cast<float>(reflected / entered);
      const SlabTotals below =
          adding_doubling(flipped(stack), {.is_diffuse = true}, {.accuracy = 1e-4}).totals;
      found.below[lane] =
          static_cast<float>(below.specular_reflectance + below.diffuse_reflectance);
    });
  } catch (const InvalidInput& error) {
    throw InvalidInput("material \"" + surface.name + "\": over " + error.what());
  }
}

template <int N>
Coverings<N> make_coverings(const RenderScene& scene) {
  Coverings<N> coverings(scene.scene->materials.size());
  for (std::uint32_t i = 0; i < coverings.size(); ++i)
    if (!coverings_of(scene.scene->materials[i]).empty())
      coverings[i] = std::make_unique<CoveringTable<N>>(scene, i);
  return coverings;
}

template <int N>
template <class Value>
BandValues<N> CoverAt<N>::sum_of(const Value& value) const {
  Bands sum;
  for (std::size_t i = 0; i < table_->states_.size(); ++i)
    if (share_[i] > 0.0f) sum += share_[i] * value(table_->states_[i]);
  return sum;
}

template <int N>
BandValues<N> CoverAt<N>::through(float cos_i) const {
  return sum_of([&](const auto& state) { return at_cosine(state.through, cos_i); });
}

template <int N>
BandValues<N> CoverAt<N>::mean_through() const {
  return through(2.0f / 3.0f);  // the mean cosine of diffuse light
}

template <int N>
BandValues<N> CoverAt<N>::reflected(float cos_i) const {
  return sum_of([&](const auto& state) { return at_cosine(state.reflected, cos_i); });
}

template <int N>
BandValues<N> CoverAt<N>::reflection(float cos_i, float cos_o) const {
  return sum_of([&](const auto& state) {
    const Bands a = at_cosine(state.reflected, cos_i), b = at_cosine(state.reflected, cos_o);
    Bands value;
    for (int i = 0; i < N; ++i)
      value[i] = state.mean_reflected[i] > 0.0f ? a[i] * b[i] / state.mean_reflected[i] : 0.0f;
    return value;
  });
}

namespace {

/// Factor by which coverings change the light that a base sends out.
/// @param below, leaving            of the coverings (CoveringTable::State)
/// @param bare_below, bare_leaving  of the bare base
/// @param reflectance               of the bare base, of the flux that has entered
template <int N>
BandValues<N> factor_on(const BandValues<N>& reflectance, const BandValues<N>& below, float leaving,
                        const BandValues<N>& bare_below, float bare_leaving) {
  BandValues<N> factor;
  for (int i = 0; i < N; ++i) {
    // Of the light that comes down inside, what the base returns; from what it shows when bare.
    const float r0 = bare_below[i], shown = std::clamp(reflectance[i], 0.0f, 1.0f);
    const float returned = shown / std::max(1.0f - r0 + shown * r0, 1e-6f);
    factor[i] = leaving / bare_leaving * (1.0f - r0 * returned) /
                std::max(1.0f - below[i] * returned, 1e-6f);
  }
  return factor;
}

}  // namespace

template <int N>
BandValues<N> CoverAt<N>::returning(const Bands& reflectance) const {
  float leaving = 0.0f;
  for (std::size_t i = 0; i < table_->states_.size(); ++i)
    leaving += share_[i] * table_->states_[i].leaving;
  const auto& bare = table_->states_[0];
  return factor_on(reflectance, sum_of([](const auto& state) { return state.below; }), leaving,
                   bare.below, bare.leaving);
}

template <int N>
BandValues<N> CoverAt<N>::matte_reflection(float cos_i, float cos_o,
                                           const Bands& reflectance) const {
  const auto& bare = table_->states_[0];
  return sum_of([&](const auto& state) {
    return at_cosine(state.through, cos_i) * at_cosine(state.through, cos_o) * reflectance *
           factor_on(reflectance, state.below, state.leaving, bare.below, bare.leaving);
  });
}

template <int N>
std::optional<CoverAt<N>> cover_at(const RenderScene& scene, const Coverings<N>& coverings,
                                   const SurfacePoint& point) {
  const CoveringTable<N>* table = coverings[point.material].get();
  if (!table || point.is_below) return std::nullopt;
  const std::span<const Covering> over = coverings_of(scene.scene->materials[point.material]);
  std::array<float, CoveringTable<N>::most_states> share{1.0f};
  std::size_t states = 1;
  for (const Covering& covering : over) {
    const float covered = std::clamp(scene.textures.scalar(covering.coverage, point), 0.0f, 1.0f);
    for (std::size_t i = 0; i < states; ++i) {
      share[states + i] = covered * share[i];
      share[i] -= share[states + i];
    }
    states *= 2;
  }
  if (share[0] == 1.0f) return std::nullopt;
  return CoverAt<N>(*table, share);
}

#define LAMINA_INSTANTIATE(N)                                                          \
  template class CoveringTable<N>;                                                     \
  template Coverings<N> make_coverings<N>(const RenderScene&);                         \
  template class CoverAt<N>;                                                           \
  template std::optional<CoverAt<N>> cover_at(const RenderScene&, const Coverings<N>&, \
                                              const SurfacePoint&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
