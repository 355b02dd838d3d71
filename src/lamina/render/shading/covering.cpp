// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/shading/covering.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/scene/description/materials_in_use.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

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
template <int N>
BandValues<N> at_cosine(const std::array<BandValues<N>, cosine_nodes>& table, float cosine) {
  const auto [i, f] = table_place(cosine);
  return mix(table[i], table[i + 1], f);
}

float entering_of(const BoundaryReflectance* boundary, float roughness) {
  return boundary ? 1.0f - boundary->diffuse(roughness) : 1.0f;
}

}  // namespace

template <int N>
CoveringTable<N>::CoveringTable(const RenderScene& scene, std::uint32_t material) {
  const SurfaceMaterial& surface = scene.scene->materials[material];
  const RenderScene::Boundaries& boundaries = scene.boundaries[material];
  const std::span<const Covering> over = coverings_of(surface);
  states_.resize(std::size_t{1} << over.size());
  State& bare = states_[0];
  bare.reflected.fill({});
  bare.through.fill(Bands::filled(1.0f));
  const float eta = boundaries.own ? boundaries.own->ior() : 1.0f;
  bare.leaving = entering_of(boundaries.own.get(), boundaries.own_roughness) / (eta * eta);
  bare.below = Bands::filled(1.0f - bare.leaving);
  try {
    const std::size_t bands = over.front().material.bands.size();
    parallel_for((states_.size() - 1) * bands, [&](std::size_t job) {
      const std::size_t state = 1 + job / bands, band = job % bands;
      states_[state].solve(stack_of(surface, state, band), static_cast<int>(band));
    });
    for (std::size_t state = 1; state < states_.size(); ++state) {
      const std::size_t top = std::bit_width(state) - 1;
      const RenderScene::CoveringTop& boundary = boundaries.over[top];
      const LayerStack stack = stack_of(surface, state, 0);
      const auto eta_below = static_cast<float>(stack.ior_below() / stack.ior_above());
      states_[state].leaving =
          entering_of(boundary.table.get(), boundary.roughness) / (eta_below * eta_below);
    }
  } catch (const InvalidInput& error) {
    throw InvalidInput("material \"" + surface.name + "\": over " + error.what());
  }
}

template <int N>
void CoveringTable<N>::State::solve(const LayerStack& layers, int band) {
  const LayerStack stack = with_smooth_ends(layers);
  const auto solved = adding_doubling_by_angle(stack, table_incidences(), {.accuracy = 1e-4});
  for (std::size_t i = 0; i < cosine_nodes; ++i) {
    const SlabTotals& totals = solved[i].totals;
    const double entered = 1.0 - totals.specular_reflectance;
    reflected[i][band] = static_cast<float>(totals.diffuse_reflectance / entered);
    through[i][band] = static_cast<float>(totals.transmittance / entered);
  }
  // Of the interpolated values, so that what leaves adds up to what there is.
  const double eta = stack.layers().front().medium.ior / stack.ior_above();
  const Quadrature rule = gauss_legendre(64, 0.0, 1.0);
  double all_entered = 0.0, all_reflected = 0.0;
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    const double mu = rule.nodes[k];
    const double entered = rule.weights[k] * 2.0 * mu * (1.0 - fresnel(mu, eta));
    all_entered += entered;
    all_reflected +=
        entered * static_cast<double>(at_cosine(reflected, static_cast<float>(mu))[band]);
  }
  mean_reflected[band] = static_cast<float>(all_reflected / all_entered);
  const SlabTotals from_below =
      adding_doubling(flipped(stack), {.is_diffuse = true}, {.accuracy = 1e-4}).totals;
  below[band] =
      static_cast<float>(from_below.specular_reflectance + from_below.diffuse_reflectance);
}

template <int N>
Coverings<N> make_coverings(const RenderScene& scene) {
  Coverings<N> coverings(scene.scene->materials.size());
  const std::vector<bool> is_used = materials_in_use(*scene.scene);
  for (std::uint32_t i = 0; i < coverings.size(); ++i)
    if (is_used[i] && !coverings_of(scene.scene->materials[i]).empty())
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
    return separable(at_cosine(state.reflected, cos_i), at_cosine(state.reflected, cos_o),
                     state.mean_reflected);
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
