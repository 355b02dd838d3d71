// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/thin_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lamina/core/parallel.h"
#include "lamina/scattering/diffusion/diffuse_boundary.h"
#include "lamina/scattering/diffusion/multipole.h"
#include "lamina/scattering/profile/layer_response.h"

namespace lamina {
namespace {

/// Gaussians that stand for all others, what lies between by its variance [mm²].
constexpr std::array<double, 6> variances = {0.16, 0.4, 1.0, 2.5, 6.3, 16.0};

/// How far light is followed over the surface once it is through [mm].
constexpr double reach = 4.0;

/// Place of a variance among the Gaussians, 0 at the first.
float place_of(double variance) {
  std::size_t i = 0;
  while (i + 2 < variances.size() && variance > variances[i + 1]) ++i;
  const double beyond = (variance - variances[i]) / (variances[i + 1] - variances[i]);
  return static_cast<float>(static_cast<double>(i) + std::clamp(beyond, 0.0, 1.0));
}

}  // namespace

template <int N>
ThinParts<N> make_thin_parts(const CellGraph& graph, std::vector<FarSide> far,
                             double upper_thickness) {
  ThinParts<N> thin;
  if (std::ranges::none_of(far, [&](const FarSide& side) {
        return static_cast<double>(side.thickness) > 2.0 * upper_thickness;
      }))
    return thin;
  thin.far = std::move(far);
  thin.spread.resize(thin.far.size());
  thin.transmittance.resize(thin.far.size());
  thin.reflectance.assign(thin.far.size(), BandValues<N>::filled(1.0f));
  std::array<double, variances.size()> halves{};
  std::ranges::transform(variances, halves.begin(), [](double variance) { return 0.5 * variance; });
  thin.scales = cell_scales_of_gaussians(graph, halves);
  return thin;
}

template <int N>
void add_band(int band, const MappedLayer& lower, std::span<const float> sigma_a,
              double upper_thickness, double ior_above, ThinParts<N>& thin) {
  const double inside = diffuse_reflectance_inside({}, lower.ior, ior_above, DiffuseFresnel::exact);
  const auto slab_at = [&](double absorption, double thickness, double k) {
    return response(
        make_multipole({absorption, lower.sigma_s, lower.g, lower.ior}, thickness, inside, inside),
        k);
  };
  for (std::size_t i = 0; i < thin.far.size(); ++i) {
    const double thickness = static_cast<double>(thin.far[i].thickness) - 2.0 * upper_thickness;
    if (!(thickness > 0.0)) continue;
    const auto absorption = static_cast<double>(sigma_a[i]);
    const LayerResponse slab = slab_at(absorption, thickness, 0.0);
    const LayerResponse thick = slab_at(absorption, std::numeric_limits<double>::infinity(), 0.0);
    constexpr double step = 0.01;  // [1/mm], a low frequency
    const double falling =
        slab_at(absorption, thickness, step).transmission_down / slab.transmission_down;
    const double variance = -2.0 * std::log(falling) / (step * step);
    thin.spread[i][band] = place_of(variance);
    thin.transmittance[i][band] = static_cast<float>(slab.transmission_down);
    thin.reflectance[i][band] = static_cast<float>(slab.reflection_above / thick.reflection_above);
  }
}

template <int N>
CellMixture<N> spread_through(const CellGraph& graph, const ThinParts<N>& thin) {
  CellField<N> place = thin.spread;
  std::vector<bool> takes(place.size());
  std::vector<std::uint32_t> cells;
  const auto take = [&](std::uint32_t cell, std::uint32_t like) {
    if (takes[cell]) return;
    takes[cell] = true;
    place[cell] = place[like];
    cells.push_back(cell);
  };
  for (std::uint32_t i = 0; i < place.size(); ++i)
    if (largest(thin.transmittance[i]) > 0.0f) take(i, i);
  // Where these look, and around them as far as light spreads once it is through.
  for (std::size_t k = 0, count = cells.size(); k < count; ++k) {
    const FarSide& far = thin.far[cells[k]];
    for (std::size_t c = 0; c < static_cast<std::size_t>(far.count); ++c)
      take(far.cell[c], cells[k]);
  }
  const CellLevel& fine = graph.levels.front();
  const double rings = reach / std::sqrt(static_cast<double>(fine.typical_area));
  for (std::size_t ring = 0, from = 0; static_cast<double>(ring) < rings; ++ring) {
    const std::size_t to = cells.size();
    for (; from < to; ++from)
      for (std::uint32_t k = fine.first[cells[from]]; k < fine.first[cells[from] + 1]; ++k)
        take(fine.neighbors[k].cell, cells[from]);
  }
  std::ranges::sort(cells);
  CellField<N> of_cells;
  for (const std::uint32_t cell : cells) of_cells.push_back(place[cell]);
  return make_cell_mixture(graph, std::move(cells), std::move(of_cells), thin.scales);
}

template <int N>
CellField<N> pass_through(const ThinParts<N>& thin, const CellField<N>& spread) {
  CellField<N> through(spread.size());
  constexpr std::size_t chunk = 8192;
  parallel_for((through.size() + chunk - 1) / chunk, [&](std::size_t c) {
    for (std::size_t i = c * chunk; i < std::min(through.size(), (c + 1) * chunk); ++i) {
      const FarSide& far = thin.far[i];
      for (std::size_t k = 0; k < static_cast<std::size_t>(far.count); ++k)
        through[i] += far.weight[k] * spread[far.cell[k]];
      through[i] *= thin.transmittance[i];
    }
  });
  return through;
}

template ThinParts<4> make_thin_parts<4>(const CellGraph&, std::vector<FarSide>, double);
template ThinParts<8> make_thin_parts<8>(const CellGraph&, std::vector<FarSide>, double);
template ThinParts<16> make_thin_parts<16>(const CellGraph&, std::vector<FarSide>, double);
template void add_band<4>(int, const MappedLayer&, std::span<const float>, double, double,
                          ThinParts<4>&);
template void add_band<8>(int, const MappedLayer&, std::span<const float>, double, double,
                          ThinParts<8>&);
template void add_band<16>(int, const MappedLayer&, std::span<const float>, double, double,
                           ThinParts<16>&);
#define LAMINA_INSTANTIATE(N)                                                    \
  template CellMixture<N> spread_through(const CellGraph&, const ThinParts<N>&); \
  template CellField<N> pass_through(const ThinParts<N>&, const CellField<N>&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
