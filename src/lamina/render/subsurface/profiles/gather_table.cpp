// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/gather_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/float_pi.h"

namespace lamina {
namespace {

/// exp(-x) I0(x) for x >= 0, within 2e-7. Source: [AbramowitzStegun1964] Eqs. 9.8.1, 9.8.2.
double scaled_bessel_i0(double x) {
  if (x < 3.75) {
    const double t = (x / 3.75) * (x / 3.75);
    return std::exp(-x) *
           (1.0 + t * (3.5156229 +
                       t * (3.0899424 +
                            t * (1.2067492 + t * (0.2659732 + t * (0.0360768 + t * 0.0045813))))));
  }
  const double t = 3.75 / x;
  const double tail = 0.02635537 + t * (-0.01647633 + t * 0.00392377);
  const double sum =
      0.39894228 +
      t * (0.01328592 +
           t * (0.00225319 + t * (-0.00157565 + t * (0.00916281 + t * (-0.02057706 + t * tail)))));
  return sum / std::sqrt(x);
}

/// Rings of a plane, evenly spaced in the logarithm of their radius.
struct Rings {
  std::vector<float> r, area;  ///< of the middle [mm], [mm²]
};

Rings make_rings(float reach) {
  constexpr int count = 800;
  Rings rings;
  const double first = std::log(1e-5 * static_cast<double>(reach));
  const double last = std::log(static_cast<double>(reach));
  double before = 0.0;
  for (int i = 0; i < count; ++i) {
    const double edge = std::exp(first + (last - first) * (i + 1) / count);
    rings.r.push_back(static_cast<float>(std::sqrt(0.5 * (edge * edge + before * before))));
    rings.area.push_back(static_cast<float>(std::numbers::pi * (edge * edge - before * before)));
    before = edge;
  }
  return rings;
}

/// A Gaussian around a point at distance r from the centre, averaged over the ring at distance s.
float ring_gaussian(float r, float s, float blur) {
  const double v = static_cast<double>(blur) * static_cast<double>(blur);
  const double d = static_cast<double>(r) - static_cast<double>(s);
  if (d * d > 80.0 * v) return 0.0f;
  const double product = static_cast<double>(r) * static_cast<double>(s);
  return static_cast<float>(std::exp(-0.5 * d * d / v) * scaled_bessel_i0(product / v) /
                            (2.0 * std::numbers::pi * v));
}

/// The integral over the plane of a table.
template <int N>
BandValues<N> integral(const RadialTable<N>& table) {
  BandValues<N> total = float_pi * table.node_r2(0) * table[0];
  for (std::size_t i = 0; i + 1 < table.size(); ++i)
    total +=
        0.5f * float_pi * (table.node_r2(i + 1) - table.node_r2(i)) * (table[i] + table[i + 1]);
  return total;
}

}  // namespace

template <int N>
RadialTable<N>::RadialTable(float first_r2, float last_r2)
    : first_(std::bit_cast<std::uint32_t>(first_r2) >> shift) {
  const std::uint32_t last = std::bit_cast<std::uint32_t>(last_r2) >> shift;
  values_.resize(last - first_ + 2);
}

template <int N>
std::vector<GatherTable<N>> make_gather_tables(std::span<const ProfileTable<N>> tables,
                                               float blur) {
  float reach = 0.0f;
  for (const auto& table : tables) reach = std::max(reach, table.support_radius());
  const float far = 10.0f * blur;  // beyond, a blur changes nothing
  const float first = blur > 0.0f ? std::min(0.05f * blur, 1e-3f * reach) : 1e-4f * reach;
  const float last = std::max(reach, far) + 4.0f * blur;
  const Rings rings = make_rings(reach);
  const RadialTable<N> grid(first * first, last * last);
  // How much of each ring's light comes to each radius: the same for all tables.
  std::size_t near = 0;
  while (near < grid.size() && grid.node_r2(near) < far * far) ++near;
  std::vector<float> moved(near * rings.r.size());
  for (std::size_t i = 0; i < near; ++i)
    for (std::size_t k = 0; k < rings.r.size(); ++k)
      moved[i * rings.r.size() + k] =
          rings.area[k] * ring_gaussian(std::sqrt(grid.node_r2(i)), rings.r[k], blur);

  const auto blurred = [&](const ProfileTable<N>& from, const auto& profile, bool& is_black) {
    RadialTable<N> table = grid;
    std::vector<BandValues<N>> at_ring;
    BandValues<N> total;
    for (std::size_t k = 0; k < rings.r.size(); ++k) {
      at_ring.push_back(rings.r[k] < from.support_radius() ? profile(rings.r[k]) : BandValues<N>{});
      total += rings.area[k] * at_ring.back();
    }
    is_black = !(largest(total) > 0.0f);
    if (is_black) return table;
    for (std::size_t i = 0; i + 1 < table.size(); ++i) {
      const float r = std::sqrt(table.node_r2(i));
      if (i < near) {
        for (std::size_t k = 0; k < rings.r.size(); ++k)
          table[i] += moved[i * rings.r.size() + k] * at_ring[k];
      } else if (r < from.support_radius()) {
        table[i] = profile(r);
      }
    }
    const BandValues<N> found = integral(table);
    BandValues<N> scale;
    for (int b = 0; b < N; ++b) scale[b] = found[b] > 0.0f ? total[b] / found[b] : 0.0f;
    for (std::size_t i = 0; i < table.size(); ++i) table[i] *= scale;
    return table;
  };
  std::vector<GatherTable<N>> result;
  for (const ProfileTable<N>& from : tables) {
    GatherTable<N> table;
    bool is_black = false;
    table.reflectance = blurred(
        from, [&](float r) { return from.reflectance_profile(r); }, is_black);
    table.transmittance = blurred(
        from, [&](float r) { return from.transmittance_profile(r); }, is_black);
    table.is_transmitting = !is_black;
    result.push_back(std::move(table));
  }
  return result;
}

template <int N>
float smallest_half_radius(const ProfileTable<N>& table, float least) {
  const Rings rings = make_rings(table.support_radius());
  const BandValues<N>& all = table.total_reflectance();
  BandValues<N> within;
  float smallest = table.support_radius();
  for (std::size_t k = 0; k < rings.r.size(); ++k) {
    within += rings.area[k] * table.reflectance_profile(rings.r[k]);
    for (int b = 0; b < N; ++b)
      if (all[b] > least && within[b] > 0.5f * all[b]) return std::min(smallest, rings.r[k]);
  }
  return smallest;
}

template class RadialTable<4>;
template class RadialTable<8>;
template class RadialTable<16>;
template std::vector<GatherTable<4>> make_gather_tables<4>(std::span<const ProfileTable<4>>, float);
template std::vector<GatherTable<8>> make_gather_tables<8>(std::span<const ProfileTable<8>>, float);
template std::vector<GatherTable<16>> make_gather_tables<16>(std::span<const ProfileTable<16>>,
                                                             float);
template float smallest_half_radius<4>(const ProfileTable<4>&, float);
template float smallest_half_radius<8>(const ProfileTable<8>&, float);
template float smallest_half_radius<16>(const ProfileTable<16>&, float);

}  // namespace lamina
