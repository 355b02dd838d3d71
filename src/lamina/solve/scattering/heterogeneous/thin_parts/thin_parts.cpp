// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/thin_parts/thin_parts.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "lamina/base/core/parallel.h"
#include "lamina/base/core/parallel_chunks.h"
#include "lamina/solve/scattering/heterogeneous/blurs/for_cells.h"
#include "lamina/solve/scattering/heterogeneous/thin_parts/internal/facing_cells.h"
#include "lamina/solve/scattering/heterogeneous/thin_parts/internal/slab_profiles.h"

namespace lamina {

template <int N>
struct ThinParts<N>::Geometry {
  detail::FacingCells facing;
  detail::SlabProfiles<N> profiles;
  float coats = 0.0f;  ///< thickness of what lies over the last layer on both sides [mm]
};

namespace {

using detail::for_cells;
using detail::SlabResponse;

/// Cells that take light are about as wide, and light is spread by a part of that on its way [mm].
constexpr float spacing = 0.7f;
constexpr float blur_in_spacings = 0.5f;

/// Less light than this through a part is none.
constexpr float least_transmittance = 1e-4f;

/// Depths from which light spreads on its way up, in a slab of a few millimetres [mm].
constexpr std::array<double, 5> depths = {0.15, 0.45, 0.75, 1.05, 1.35};

/// Absorption of the last layer as light sees it that comes up through the near half of a slab: the
/// mean over depths of what lies within the width that it spreads to from there.
template <int N>
CellField<N> seen_absorption(const CellGraph& graph, std::span<const ThinBand> bands) {
  CellField<N> sigma_a(bands.front().sigma_a.size());
  for (std::size_t b = 0; b < bands.size(); ++b)
    for (std::size_t i = 0; i < sigma_a.size(); ++i)
      sigma_a[i][static_cast<int>(b)] = bands[b].sigma_a[i];
  std::array<double, depths.size()> variances{};
  std::ranges::transform(depths, variances.begin(), [](double depth) { return depth * depth; });
  const std::vector<double> scales = cell_scales_of_gaussians(graph, variances);
  const std::size_t count = scale_count(graph);
  CellOperator<N> mean{.terms = 1,
                       .weights = std::vector<BandValues<N>>(count),
                       .totals = {BandValues<N>::filled(1.0f)}};
  for (std::size_t k = 0; k < scales.size(); ++k)
    mean.weights[k % count] +=
        BandValues<N>::filled(static_cast<float>(scales[k]) / static_cast<float>(depths.size()));
  const std::array<const CellOperator<N>*, 1> operators = {&mean};
  return std::move(
      apply_cell_operators<N>(graph, sigma_a, {CellField<N>(sigma_a.size())}, operators)[0]);
}

/// Which ways through the body count.
enum class Ways { all, slabs };

/// What comes through to the cells that take light, of light at all cells.
template <int N>
CellField<N> gather(const CellGraph& graph, const detail::FacingCells& facing,
                    const detail::SlabProfiles<N>& profiles, float coats, CellField<N> light,
                    Ways ways) {
  CellField<N> of_level = mean_on_level(graph, std::move(light), 0, facing.level);
  const std::size_t takers = of_level.size();
  CellField<N> flux;
  for (std::size_t level = facing.level;; ++level) {
    flux.insert(flux.end(), of_level.begin(), of_level.end());
    if (level + 1 == graph.levels.size()) break;
    of_level = mean_on_level(graph, std::move(of_level), level, level + 1);
  }
  for (std::size_t j = 0; j < flux.size(); ++j) flux[j] *= facing.cells[j].area;
  CellField<N> through(takers);
  parallel_chunks(facing.taking.size(), 256, [&](std::size_t t) {
    const std::uint32_t i = facing.taking[t];
    BandValues<N> sum;
    for (std::size_t k = facing.first[t]; k < facing.first[t + 1]; ++k) {
      const std::uint32_t j = facing.from[k];
      const detail::FacingPair pair = detail::facing_pair(facing.cells[i], facing.cells[j]);
      BandValues<N> per_area = pair.of_slab * profiles.transmittance(pair.thickness - coats,
                                                                     pair.lateral2, pair.opening);
      if (ways == Ways::all && pair.of_distance > 0.0f)
        per_area += pair.of_distance * profiles.reflectance(pair.distance2);
      sum += flux[j] * per_area;
    }
    through[i] = sum;
  });
  return smooth_on_finest(graph, std::move(through), facing.level);
}

/// Thickness of the slab that transmits as much [mm]; 0 if next to nothing.
float thickness_of(std::span<const SlabResponse> slabs, float transmittance) {
  if (!(transmittance > least_transmittance) || transmittance <= slabs.back().transmittance)
    return 0.0f;
  const auto wanted = static_cast<double>(transmittance);
  const auto thicker = std::ranges::partition_point(
      slabs, [&](const SlabResponse& slab) { return slab.transmittance > wanted; });
  const auto i = static_cast<std::size_t>(thicker - slabs.begin());
  if (i == 0) return static_cast<float>(detail::slab_thickness(0));
  const double f =
      (slabs[i - 1].transmittance - wanted) / (slabs[i - 1].transmittance - slabs[i].transmittance);
  return static_cast<float>(std::lerp(detail::slab_thickness(i - 1), detail::slab_thickness(i), f));
}

}  // namespace

template <int N>
ThinParts<N> make_thin_parts(const CellGraph& graph, std::span<const Vec3f> positions,
                             std::span<const Vec3f> normals, std::span<const ThinBand> bands) {
  assert(!bands.empty() && positions.size() == normals.size());
  typename ThinParts<N>::Geometry geometry;
  geometry.facing = detail::find_facing_cells(graph, positions, normals, spacing);
  if (geometry.facing.taking.empty()) return {};

  std::vector<detail::SlabFactors> factors(bands.size());
  std::vector<std::vector<SlabResponse>> slabs(bands.size());
  parallel_for(bands.size(), [&](std::size_t b) {
    factors[b] = detail::transfer_factors(bands[b]);
    const detail::SlabLayer layer = detail::last_layer(*bands[b].stack);
    for (std::size_t s = 0; s < detail::slab_count; ++s) {
      const SlabResponse slab =
          detail::multipole_slab(layer, bands[b].reference.back(), detail::slab_thickness(s));
      slabs[b].push_back({slab.transmittance * factors[b].slabs[s].transmittance,
                          slab.reflectance * factors[b].slabs[s].reflectance});
    }
  });
  const float width = std::sqrt(graph.levels[geometry.facing.level].typical_area);
  const auto blur = static_cast<double>(blur_in_spacings * width);
  geometry.profiles = detail::SlabProfiles<N>(bands, factors, blur, detail::SlabLight::scattered);
  for (const MappedLayer& layer : bands.front().stack->layers)
    if (std::isfinite(layer.thickness))
      geometry.coats += 2.0f * static_cast<float>(layer.thickness);

  // How much comes through where light is even, in the band that thick parts transmit best.
  const auto clearest = static_cast<std::size_t>(
      std::ranges::max_element(
          slabs, {},
          [](const auto& of_band) { return of_band[of_band.size() / 2].transmittance; }) -
      slabs.begin());
  const std::size_t cells = positions.size();
  const detail::SlabProfiles<N> of_all(bands, factors, blur, detail::SlabLight::all);
  CellField<N> even = gather(graph, geometry.facing, of_all, geometry.coats,
                             CellField<N>(cells, BandValues<N>::filled(1.0f)), Ways::slabs);
  ThinParts<N> thin;
  thin.passing.assign(cells, BandValues<N>::filled(1.0f));
  thin.reflectance = thin.passing;
  thin.thickness.resize(cells);
  for_cells(cells, [&](std::size_t i) {
    thin.thickness[i] = thickness_of(slabs[clearest], even[i][static_cast<int>(clearest)]);
  });
  even = {};
  const CellField<N> sigma_a = seen_absorption<N>(graph, bands);
  for (std::size_t b = 0; b < bands.size(); ++b) {
    const int lane = static_cast<int>(b);
    const detail::SlabLayer layer = detail::last_layer(*bands[b].stack);
    constexpr auto least = static_cast<double>(least_transmittance);
    constexpr double most_clearer = 1.5;
    for_cells(cells, [&](std::size_t i) {
      const auto thickness = static_cast<double>(thin.thickness[i]);
      if (!(thickness > 0.0)) return;
      const SlabResponse slab = detail::multipole_slab(
          layer, static_cast<double>(std::max(sigma_a[i][lane], 1e-6f)), thickness);
      const SlabResponse factor = detail::between_slabs(factors[b].slabs, thickness);
      const double usual =
          detail::multipole_slab(layer, bands[b].reference.back(), thickness).transmittance;
      // Of what hardly passes the ratio says little, and ways shorter than this thickness are
      // changed by less: it must not amplify their light.
      thin.passing[i][lane] = static_cast<float>(
          std::min(std::sqrt((slab.transmittance + least) / (usual + least)), most_clearer));
      thin.reflectance[i][lane] =
          std::min(static_cast<float>(slab.reflectance * factor.reflectance), 1.0f);
    });
  }
  thin.geometry = std::make_shared<const typename ThinParts<N>::Geometry>(std::move(geometry));
  return thin;
}

template <int N>
CellField<N> pass_through(const CellGraph& graph, const ThinParts<N>& thin,
                          const CellField<N>& down) {
  CellField<N> light(down.size());
  for_cells(down.size(), [&](std::size_t i) { light[i] = thin.passing[i] * down[i]; });
  const auto& [facing, profiles, coats] = *thin.geometry;
  CellField<N> up = gather(graph, facing, profiles, coats, std::move(light), Ways::all);
  for_cells(up.size(), [&](std::size_t i) { up[i] *= thin.passing[i]; });
  return up;
}

#define LAMINA_INSTANTIATE(N)                                                                  \
  template ThinParts<N> make_thin_parts<N>(const CellGraph&, std::span<const Vec3f>,           \
                                           std::span<const Vec3f>, std::span<const ThinBand>); \
  template CellField<N> pass_through(const CellGraph&, const ThinParts<N>&, const CellField<N>&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
