// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/material_profiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/subsurface/profiles/colored_transport.h"
#include "lamina/render/subsurface/profiles/once_in_even_light.h"
#include "lamina/scene/surface/map_range.h"
#include "lamina/solve/reflectance/material_totals.h"

namespace lamina {
namespace {

/// What turns a profile into one per flux that entered. A profile per flux arriving along the
/// normal holds the transmittance of that direction.
template <int N>
BandValues<N> per_entered(const Profile& profile, std::span<const LayerStack> bands) {
  BandValues<N> factor;
  for (std::size_t b = 0; b < profile.bands; ++b) {
    const double eta = bands[b].layers().front().medium.ior / bands[b].ior_above();
    factor[static_cast<int>(b)] = profile.per == ProfilePer::entered_flux
                                      ? 1.0f
                                      : static_cast<float>(1.0 / (1.0 - fresnel(1.0, eta)));
  }
  return factor;
}

using ColorUse = SubsurfaceSurface::ColorUse;

/// The one with the least absorption that is not all but white: of that light goes far, and tables
/// that held it would be coarse for others.
const Profile& widest_profile(const AbsorptionSeries& series) {
  constexpr double whitest = 0.99;
  std::size_t i = 0;
  while (i + 1 < series.size() &&
         *std::ranges::max_element(series.profiles()[i].total_reflectance) > whitest)
    ++i;
  return series.profiles()[i];
}

}  // namespace

template <int N>
MaterialProfiles<N>::MaterialProfiles(const RenderScene& scene, const BandConversion<N>& conversion,
                                      std::uint32_t material, const ProfileMaker& make_profile)
    : scene_(scene),
      conversion_(conversion),
      surface_(std::get<SubsurfaceSurface>(scene.scene->materials[material].surface)),
      material_(material) {
  const std::vector<LayerStack> layers = layer_stacks(surface_.material);  // [band]
  bands_ = static_cast<int>(layers.size());
  std::vector<Profile> profiles;
  if (is_semi_infinite(layers.front())) {
    const auto [nearest, reach] = ProfileMaker::slab_thicknesses(layers.front());
    ProfileMaker::ByThickness made = make_profile.by_thickness(
        surface_.material, layers,
        thinnest_place(static_cast<float>(0.1 * nearest), static_cast<float>(reach)));
    profiles = std::move(made.slabs);
    profiles.push_back(std::move(made.half_space));
    thicknesses_.assign(made.thickness.begin(), made.thickness.end());
  } else {
    profiles.push_back(make_profile(surface_.material, layers));
  }
  std::vector<Profile> widest = {profiles.back()};
  series_ = make_series(layers, make_profile);
  if (series_) widest.push_back(widest_profile(*series_));
  const RadiusGrid grid = make_radius_grid(widest);
  support_radius_ = grid.last;
  for (const Profile& profile : profiles)
    by_thickness_.emplace_back(profile, grid, per_entered<N>(profile, layers));
  if (series_)
    for (std::size_t i = 0; i < series_->size(); ++i)
      by_absorption_.emplace_back(series_->profiles()[i], grid,
                                  per_entered<N>(series_->profiles()[i], series_->layers(i)));
  if (surface_.color_use == ColorUse::scale)
    mean_color_ = mean_of_map(scene.textures, surface_.color);
  if (scene.settings.single_scattering != RenderSettings::SingleScattering::none)
    once_ = OnceInEvenLight<N>(layers).largest_share();
  if (series_) brightest_index_ = albedo_index(range_of(scene.textures, surface_.color).second);
}

/// As far as the colors of the map go.
template <int N>
std::optional<AbsorptionSeries> MaterialProfiles<N>::make_series(
    const std::vector<LayerStack>& layers, const ProfileMaker& make_profile) const {
  if (surface_.color_use != ColorUse::invert) return std::nullopt;
  const auto [low, high] = range_of(scene_.textures, surface_.color);
  const auto reflectance = [&](const Vec3f& color) {
    const Bands bands = conversion_.from_rgb(color);
    return std::vector<double>(bands.v, bands.v + layers.size());
  };
  return AbsorptionSeries(layers, {.darkest = reflectance(low), .brightest = reflectance(high)},
                          make_profile.of_any_absorption(surface_.material, layers));
}

template <int N>
float MaterialProfiles<N>::thickness_at(const SurfacePoint& point) const {
  if (thicknesses_.empty()) return std::numeric_limits<float>::infinity();
  const float given = scene_.textures.scalar(surface_.thickness, point);
  if (surface_.thickness.value > 0.0f) return std::max(given, 0.0f);
  return distance_to_far_side(point.position, point.smooth_normal, 0.1f * thicknesses_.front(),
                              thicknesses_.back());
}

template <int N>
float MaterialProfiles<N>::distance_to_far_side(const Vec3f& position, const Vec3f& normal,
                                                float nearest, float reach) const {
  ProbeHits found;
  scene_.geometry.all_hits({position, -normal}, reach, material_, found);
  float distance = std::numeric_limits<float>::infinity();
  for (const Hit& hit : found.all()) {
    if (hit.distance >= distance || hit.distance < nearest) continue;
    const SurfacePoint far_side = make_surface_point(scene_.scene->meshes, hit, 0.0f);
    if (dot(far_side.geometric_normal, normal) < 0.0f) distance = hit.distance;
  }
  return distance;
}

template <int N>
float MaterialProfiles<N>::thinnest_place(float nearest, float reach) const {
  if (surface_.thickness.value > 0.0f)
    return std::max(range_of(scene_.textures, {&surface_.thickness, 1}).first, 0.0f);
  // Rays of a hundredth of a second: test MaterialProfiles.MakesSlabsThatObjectsAskFor.
  constexpr std::size_t most_places = 16384;
  const std::vector<Mesh>& meshes = scene_.scene->meshes;
  std::size_t triangles = 0;
  for (const Mesh& mesh : meshes) triangles += std::ranges::count(mesh.material, material_);
  const std::size_t step = triangles / most_places + 1,
                    per_triangle = std::clamp<std::size_t>(most_places / (triangles + 1), 1, 64);
  float thinnest = std::numeric_limits<float>::infinity();
  std::size_t seen = 0;
  for (std::uint32_t m = 0; m < meshes.size(); ++m)
    for (std::uint32_t t = 0; t < meshes[m].triangles.size(); ++t) {
      if (meshes[m].material[t] != material_ || seen++ % step != 0) continue;
      for (std::size_t i = 0; i < per_triangle; ++i) {
        // Evenly over the triangle; the first is its middle.
        const auto part = [i](double first, double by) {
          const double x = first + by * static_cast<double>(i);
          return static_cast<float>(x - std::floor(x));
        };
        float u = part(1.0 / 3.0, 0.7548776662), v = part(1.0 / 3.0, 0.5698402910);
        if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
        const SurfacePoint place =
            make_surface_point(meshes, {.u = u, .v = v, .mesh = m, .triangle = t}, 0.0f);
        thinnest = std::min(thinnest, distance_to_far_side(place.position, place.smooth_normal,
                                                           nearest, reach));
      }
    }
  return thinnest;
}

template <int N>
Vec3f MaterialProfiles<N>::color_at(const SurfacePoint& point) const {
  return surface_.color_use == ColorUse::none ? Vec3f{1, 1, 1}
                                              : scene_.textures.color(surface_.color, point);
}

template <int N>
BandValues<N> MaterialProfiles<N>::color_over_mean(const Vec3f& color) const {
  return max(conversion_.from_rgb(
                 {color.x / mean_color_.x, color.y / mean_color_.y, color.z / mean_color_.z}),
             Bands{});
}

template <int N>
BandValues<N> MaterialProfiles<N>::total_leaving(float thickness) const {
  const auto [low, high, blend] = slabs_of(thickness);
  const auto leaving = [](const ProfileTable<N>& table) {
    return table.total_reflectance() + table.total_transmittance();
  };
  return leaving(*low) + blend * (leaving(*high) - leaving(*low));
}

template <int N>
BandValues<N> MaterialProfiles<N>::largest_scale(float thickness) const {
  const Bands all = total_leaving(thickness) + once_;
  Bands most = Bands::filled(1.0f);
  for (int b = 0; b < bands_; ++b) most[b] = 1.0f / std::clamp(all[b], 1e-6f, 1.0f);
  return most;
}

template <int N>
BandValues<N> MaterialProfiles<N>::entering_color(float thickness, const Vec3f& color) const {
  if (!scales_color()) return Bands::filled(1.0f);
  const Bands scale = color_over_mean(color);
  return largest(scale) > 1.0f ? min(scale, largest_scale(thickness)) : scale;
}

template <int N>
BandValues<N> MaterialProfiles<N>::entering_color(const SurfacePoint& point) const {
  if (!scales_color()) return Bands::filled(1.0f);
  const Bands scale = color_over_mean(color_at(point));
  return largest(scale) > 1.0f ? min(scale, largest_scale(thickness_at(point))) : scale;
}

template <int N>
BandValues<N> MaterialProfiles<N>::absorption_factor(const Vec3f& color) const {
  Bands factor = Bands::filled(1.0f);
  if (!series_) return factor;
  const Bands wanted = conversion_.from_rgb(color);
  for (int b = 0; b < bands_; ++b)
    factor[b] = static_cast<float>(
        series_->factor(static_cast<double>(wanted[b]), static_cast<std::size_t>(b)));
  return factor;
}

template <int N>
typename MaterialProfiles<N>::Slabs MaterialProfiles<N>::slabs_of(float thickness) const {
  if (thicknesses_.empty() || !(thickness < thicknesses_.back()))
    return {&by_thickness_.back(), &by_thickness_.back(), 0.0f};
  std::size_t i = 0;
  while (i + 1 < thicknesses_.size() && thicknesses_[i + 1] < thickness) ++i;
  const std::size_t next = std::min(i + 1, thicknesses_.size() - 1);
  const float place = std::log(std::max(thickness / thicknesses_[i], 1.0f));
  const float step = std::log(thicknesses_[next] / thicknesses_[i]);
  return {&by_thickness_[i], &by_thickness_[next],
          step > 0.0f ? std::min(place / step, 1.0f) : 0.0f};
}

template <int N>
typename MaterialProfiles<N>::Local MaterialProfiles<N>::profiles_for(float thickness,
                                                                      const Vec3f& color) const {
  Local local{slabs_of(thickness)};
  if (surface_.color_use != ColorUse::invert) return local;
  local.is_inverted = true;
  const Bands wanted = conversion_.from_rgb(color);
  for (int b = 0; b < bands_; ++b) {
    const auto [node, blend] = find_reflectance(wanted[b], b);
    local.albedo_index[b] = static_cast<float>(node) + blend;
    const float low = by_absorption_[node].total_reflectance()[b],
                high = by_absorption_[node + 1].total_reflectance()[b];
    // What absorption alone cannot give: brighter than the whitest, darker than the blackest.
    local.scale[b] = std::max(wanted[b], 0.0f) / std::max(low + blend * (high - low), 1e-6f);
  }
  return local;
}

template <int N>
typename MaterialProfiles<N>::Between MaterialProfiles<N>::find_reflectance(float reflectance,
                                                                            int band) const {
  const auto total = [&](std::size_t i) { return by_absorption_[i].total_reflectance()[band]; };
  Between found;
  while (found.node + 2 < by_absorption_.size() && total(found.node + 1) > reflectance)
    ++found.node;
  const float low = total(found.node), high = total(found.node + 1);
  found.blend = std::clamp((low - reflectance) / std::max(low - high, 1e-9f), 0.0f, 1.0f);
  return found;
}

template <int N>
BandValues<N> MaterialProfiles<N>::albedo_index(const Vec3f& color) const {
  Bands index;
  if (by_absorption_.empty()) return index;
  const Bands wanted = conversion_.from_rgb(color);
  for (int b = 0; b < bands_; ++b) {
    const auto [node, blend] = find_reflectance(wanted[b], b);
    index[b] = static_cast<float>(node) + blend;
  }
  return index;
}

template <int N>
RadiusMixture<N> MaterialProfiles<N>::radius_mixture(const Local& local) const {
  using Table = ProfileTable<N>;
  RadiusMixture<N> mixture;
  const float low = 1.0f - local.blend, high = local.blend;
  constexpr float least = 1e-6f;  // of a black slab
  if (!local.is_inverted) {
    mixture.add(*local.low, Table::all_bands, low * std::max(local.low->sampled_light(), least));
    mixture.add(*local.high, Table::all_bands, high * std::max(local.high->sampled_light(), least));
    return mixture;
  }
  // Brighter bands reach further and get more than their share ([Hery2003] §3 draws all points for
  // the one that reaches furthest): others are as bright near by, where all have enough samples.
  // Dark ones keep some for their steep middle.
  Bands light, preference;
  for (int b = 0; b < bands_; ++b) {
    const auto [node, blend] = between(local.albedo_index[b]);
    const float dark = by_absorption_[node + 1].total_reflectance()[b],
                bright = by_absorption_[node].total_reflectance()[b];
    light[b] = std::max(bright + blend * (dark - bright), 1e-3f);
    preference[b] = light[b] * light[b];
  }
  preference *= 0.9f / sum(preference);
  for (int b = 0; b < bands_; ++b)
    preference[b] = sum(light) * (preference[b] + 0.1f / static_cast<float>(bands_));
  const auto add_band = [&](int b, float index, float weight) {
    const auto [node, blend] = between(index);
    const float bright = (1.0f - blend) * by_absorption_[node].total_reflectance()[b],
                dark = blend * by_absorption_[node + 1].total_reflectance()[b];
    weight /= std::max(bright + dark, 1e-9f);
    mixture.add(by_absorption_[node], b, weight * bright);
    mixture.add(by_absorption_[node + 1], b, weight * dark);
  };
  constexpr float for_widest = 0.25f;
  for (int b = 0; b < bands_; ++b) {
    const float index = local.albedo_index[b];
    // With the brightest entry light spreads by the profile halfway to it.
    const float widest = 0.5f * (index + brightest_index_[b]);
    const bool has_wider = index - widest > 0.5f;
    add_band(b, index, preference[b] * (has_wider ? 1.0f - for_widest : 1.0f));
    if (has_wider) add_band(b, widest, preference[b] * for_widest);
  }
  mixture.add(*local.low, Table::passing, low * sum(local.low->total_transmittance()));
  mixture.add(*local.high, Table::passing, high * sum(local.high->total_transmittance()));
  return mixture;
}

template <int N>
BandValues<N> MaterialProfiles<N>::evaluate(const Local& local, const Vec3f& offset,
                                            const Vec3f& exit_normal, const Vec3f& entry_normal,
                                            const Bands& entry_index) const {
  const float facing = std::clamp(dot(exit_normal, entry_normal), -1.0f, 1.0f);
  const float r2 = dot(offset, offset), r = std::sqrt(r2);
  const auto blended = [&](const Bands& a, const Bands& b) { return a + local.blend * (b - a); };
  Bands reflected;
  if (facing > -1.0f) {
    reflected = local.low->reflectance_profile(r);
    if (local.blend > 0.0f) reflected = blended(reflected, local.high->reflectance_profile(r));
  }
  if (local.is_inverted) {
    // The half-space of the colors, thinned by as much as the material itself is.
    const Bands thick = by_thickness_.back().reflectance_profile(r);
    for (int b = 0; b < bands_; ++b) {
      const float index = 0.5f * (local.albedo_index[b] + entry_index[b]);
      const auto [node, blend] = between(index);
      const float low = by_absorption_[node].reflectance_profile(r, b);
      const float high = by_absorption_[node + 1].reflectance_profile(r, b);
      const float thinned = thick[b] > 0.0f ? reflected[b] / thick[b] : 0.0f;
      reflected[b] = thinned * (low + blend * (high - low));
    }
  }
  Bands total = 0.5f * (1.0f + facing) * reflected;
  if (facing < 1.0f && largest(local.low->total_transmittance()) > 0.0f) {
    const float along = dot(offset, exit_normal);
    const float lateral = std::sqrt(std::max(r2 - along * along, 0.0f));
    Bands transmitted = local.low->transmittance_profile(lateral);
    if (local.blend > 0.0f)
      transmitted = blended(transmitted, local.high->transmittance_profile(lateral));
    total += 0.5f * (1.0f - facing) * transmitted;
  }
  return total * local.scale;
}

template <int N>
BandValues<N> MaterialProfiles<N>::local_reflectance(const SurfacePoint& point) const {
  const Bands& total = by_thickness_.back().total_reflectance();
  if (surface_.color_use == ColorUse::none) return total;
  const Vec3f color = scene_.textures.color(surface_.color, point);
  constexpr float thick = std::numeric_limits<float>::infinity();
  return min(max(surface_.color_use == ColorUse::invert ? conversion_.from_rgb(color)
                                                        : total * entering_color(thick, color),
                 Bands{}),
             Bands::filled(1.0f));
}

template class MaterialProfiles<4>;
template class MaterialProfiles<8>;
template class MaterialProfiles<16>;

}  // namespace lamina
