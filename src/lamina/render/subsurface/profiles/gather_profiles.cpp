// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/gather_profiles.h"

#include <algorithm>

namespace lamina {

template <int N>
GatherProfiles<N>::GatherProfiles(const MaterialProfiles<N>& profiles, float blur)
    : by_thickness_(make_gather_tables<N>(profiles.by_thickness(), blur)),
      by_absorption_(make_gather_tables<N>(profiles.by_absorption(), blur)) {}

template <int N>
typename GatherProfiles<N>::Exit GatherProfiles<N>::exit_at(
    const Vec3f& normal, const typename MaterialProfiles<N>::Local& local,
    const MaterialProfiles<N>& profiles) const {
  const auto* first = profiles.by_thickness().data();
  return {.normal = normal,
          .low = &by_thickness_[static_cast<std::size_t>(local.low - first)],
          .high = &by_thickness_[static_cast<std::size_t>(local.high - first)],
          .blend = local.blend,
          .is_inverted = local.is_inverted,
          .albedo_index = local.albedo_index,
          .scale = local.scale};
}

/// The half-space of the colors, thinned by as much as the material itself is.
template <int N>
BandValues<N> GatherProfiles<N>::of_color(const Exit& exit, const Bands& reflected, float r2,
                                          const Bands& albedo_index) const {
  const bool is_thin = exit.low != &by_thickness_.back();
  const Bands of_thick = is_thin ? thick_reflectance().at(r2) : reflected;
  Bands result;
  for (int b = 0; b < N; ++b) {
    const float at = 0.5f * (exit.albedo_index[b] + albedo_index[b]);
    const std::size_t i = std::min(static_cast<std::size_t>(at), by_absorption_.size() - 2);
    const auto [k, f] = by_absorption_[i].reflectance.place(r2);
    const auto value = [&](std::size_t table) {
      const RadialTable<N>& t = by_absorption_[table].reflectance;
      return f > 0.0f ? t[k][b] + f * (t[k + 1][b] - t[k][b]) : t[k][b];
    };
    const float light = value(i), dark = value(i + 1);
    const float thinned = !is_thin ? 1.0f : of_thick[b] > 0.0f ? reflected[b] / of_thick[b] : 0.0f;
    result[b] = thinned * (light + (at - static_cast<float>(i)) * (dark - light));
  }
  return result;
}

template class GatherProfiles<4>;
template class GatherProfiles<8>;
template class GatherProfiles<16>;

}  // namespace lamina
