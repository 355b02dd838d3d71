// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/material_profiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "lamina/optics/fresnel.h"
#include "lamina/reflectance/material_totals.h"
#include "lamina/render/subsurface/colored_transport.h"

namespace lamina {
namespace {

/// The same change to all bands.
template <class Change>
std::vector<LayerStack> changed(std::span<const LayerStack> bands, const Change& change) {
  std::vector<LayerStack> result;
  for (const LayerStack& stack : bands) result.push_back(change(stack));
  return result;
}

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

}  // namespace

template <int N>
MaterialProfiles<N>::MaterialProfiles(const RenderScene& scene, const BandConversion<N>& conversion,
                                      std::uint32_t material, const ProfileMaker& make_profile)
    : scene_(scene),
      conversion_(conversion),
      surface_(std::get<SubsurfaceSurface>(scene.scene->materials[material].surface)),
      material_(material) {
  using Layers = std::vector<LayerStack>;  // [band]
  const Layers layers = layer_stacks(surface_.material);
  bands_ = static_cast<int>(layers.size());
  std::vector<Layers> variants;
  std::vector<Profile> profiles;
  const auto add = [&](Layers variant) {
    profiles.push_back(make_profile(surface_.material, variant));
    variants.push_back(std::move(variant));
  };
  // Slabs from a hardly scattering one to one that lets nothing through, three to an octave.
  if (is_semi_infinite(layers.front())) {
    const double thinnest = std::max(2.5 * thickness_of_upper_layers(layers.front()), 0.05);
    for (double thickness = thinnest; thickness < 200.0; thickness *= std::numbers::sqrt2) {
      add(changed(layers, [&](const LayerStack& stack) { return make_slab(stack, thickness); }));
      thicknesses_.push_back(static_cast<float>(thickness));
      const auto& through = profiles.back().total_transmittance;
      if (*std::max_element(through.begin(), through.end()) < 2e-3) break;
    }
  }
  add(layers);
  const std::size_t slabs = variants.size();
  if (surface_.color_use == SubsurfaceSurface::ColorUse::invert)
    for (double factor = 1.0 / 64.0; factor < 3000.0; factor *= 2.0)
      add(changed(layers, [&](const LayerStack& stack) { return with_absorption(stack, factor); }));
  // Of the material itself; inversion may need one of an eighth of its absorption.
  std::vector<Profile> widest = {profiles[slabs - 1]};
  if (profiles.size() > slabs) widest.push_back(profiles[slabs + 3]);
  const RadiusGrid grid = make_radius_grid(widest);
  support_radius_ = grid.last;
  for (std::size_t i = 0; i < variants.size(); ++i)
    (i < slabs ? by_thickness_ : by_absorption_)
        .emplace_back(profiles[i], grid, per_entered<N>(profiles[i], variants[i]));
  if (surface_.color_use == SubsurfaceSurface::ColorUse::scale)
    mean_color_ = mean_of_map(scene.textures, surface_.color);
}

template <int N>
float MaterialProfiles<N>::thickness_at(const SurfacePoint& point) const {
  if (thicknesses_.empty()) return std::numeric_limits<float>::infinity();
  const float given = scene_.textures.scalar(surface_.thickness, point);
  if (surface_.thickness.value > 0.0f) return std::max(given, 0.0f);
  // The far side is where the ray along the inward normal leaves the object.
  ProbeHits found;
  scene_.geometry.all_hits({point.position, -point.smooth_normal}, thicknesses_.back(), material_,
                           found);
  float nearest = std::numeric_limits<float>::infinity();
  for (const Hit& hit : found.all()) {
    if (hit.distance >= nearest || hit.distance < 0.1f * thicknesses_.front()) continue;
    const SurfacePoint far_side = make_surface_point(scene_.scene->meshes, hit, 0.0f);
    if (dot(far_side.geometric_normal, point.smooth_normal) < 0.0f) nearest = hit.distance;
  }
  return nearest;
}

template <int N>
Vec3f MaterialProfiles<N>::color_at(const SurfacePoint& point) const {
  return surface_.color_use == SubsurfaceSurface::ColorUse::none
             ? Vec3f{1, 1, 1}
             : scene_.textures.color(surface_.color, point);
}

template <int N>
BandValues<N> MaterialProfiles<N>::color_scale(const Vec3f& color) const {
  return conversion_.from_rgb({std::max(color.x / mean_color_.x, 0.0f),
                               std::max(color.y / mean_color_.y, 0.0f),
                               std::max(color.z / mean_color_.z, 0.0f)});
}

template <int N>
typename MaterialProfiles<N>::Local MaterialProfiles<N>::profiles_for(float thickness,
                                                                      const Vec3f& color) const {
  Local local;
  local.low = local.high = local.sampling = &by_thickness_.back();
  if (!thicknesses_.empty() && thickness < thicknesses_.back()) {
    std::size_t i = 0;
    while (i + 1 < thicknesses_.size() && thicknesses_[i + 1] < thickness) ++i;
    local.low = &by_thickness_[i];
    local.high = &by_thickness_[std::min(i + 1, thicknesses_.size() - 1)];
    const float at = std::log2(std::max(thickness / thicknesses_[i], 1.0f)) * 2.0f;
    local.blend = std::min(at, 1.0f);
    local.sampling = local.blend < 0.5f ? local.low : local.high;
  }
  using ColorUse = SubsurfaceSurface::ColorUse;
  if (surface_.color_use == ColorUse::scale)
    local.scale = color_scale(color);
  else if (surface_.color_use == ColorUse::invert)
    invert_albedo(conversion_.from_rgb(color), local);
  return local;
}

template <int N>
void MaterialProfiles<N>::invert_albedo(const Bands& target, Local& local) const {
  local.is_inverted = true;
  float all = 0.0f;
  for (int b = 0; b < bands_; ++b) {
    const auto total = [&](std::size_t i) { return by_absorption_[i].total_reflectance()[b]; };
    if (!(total(0) > 0.0f)) continue;
    std::size_t i = 0;
    while (i + 2 < by_absorption_.size() && total(i + 1) > target[b]) ++i;
    const float blend =
        std::clamp((total(i) - target[b]) / std::max(total(i) - total(i + 1), 1e-9f), 0.0f, 1.0f);
    local.node[static_cast<std::size_t>(b)] = static_cast<std::uint8_t>(i);
    local.node_blend[b] = blend;
    // What absorption alone cannot give: brighter than the whitest, darker than the blackest.
    const float reached = total(i) + blend * (total(i + 1) - total(i));
    local.scale[b] = std::max(target[b], 0.0f) / std::max(reached, 1e-6f);
    local.fraction[b] = std::max(target[b], 1e-3f);
    all += local.fraction[b];
  }
  // Where the object is thin, half of the samples are for what passes it.
  local.fraction *= (local.low == &by_thickness_.back() ? 1.0f : 0.5f) / std::max(all, 1e-6f);
}

template <int N>
BandValues<N> MaterialProfiles<N>::albedo_index(const Bands& reflectance) const {
  Local local;
  local.low = &by_thickness_.back();
  invert_albedo(reflectance, local);
  Bands index;
  for (int b = 0; b < bands_; ++b)
    index[b] = static_cast<float>(local.node[static_cast<std::size_t>(b)]) + local.node_blend[b];
  return index;
}

template <int N>
float MaterialProfiles<N>::sample_radius(const Local& local, float u) const {
  if (!local.is_inverted) return local.sampling->sample_radius(u);
  float fraction = 0.0f;
  for (int b = 0; b < bands_; ++b, u -= fraction) {
    fraction = local.fraction[b];
    if (u >= fraction) continue;
    const std::size_t i =
        local.node[static_cast<std::size_t>(b)] + (local.node_blend[b] > 0.5f ? 1u : 0u);
    return by_absorption_[i].sample_radius(u / fraction, b);
  }
  const float rest = local.low == &by_thickness_.back() ? 1.0f : 0.5f;
  return local.sampling->sample_radius(std::clamp(u / rest, 0.0f, 0x1.fffffep-1f));
}

template <int N>
float MaterialProfiles<N>::density(const Local& local, float r) const {
  if (!local.is_inverted) return local.sampling->density(r);
  float total = local.low == &by_thickness_.back() ? 0.0f : 0.5f * local.sampling->density(r);
  for (int b = 0; b < bands_; ++b) {
    const std::size_t i =
        local.node[static_cast<std::size_t>(b)] + (local.node_blend[b] > 0.5f ? 1u : 0u);
    total += local.fraction[b] * by_absorption_[i].density(r, b);
  }
  return total;
}

template <int N>
BandValues<N> MaterialProfiles<N>::evaluate(const Local& local, const Vec3f& offset,
                                            const Vec3f& exit_normal,
                                            const Vec3f& entry_normal) const {
  const float facing = std::clamp(dot(exit_normal, entry_normal), -1.0f, 1.0f);
  const float r2 = dot(offset, offset), r = std::sqrt(r2);
  const auto blended = [&](const Bands& a, const Bands& b) { return a + local.blend * (b - a); };
  Bands reflected;
  if (facing > -1.0f) {
    reflected = local.low->reflectance_profile(r);
    if (local.blend > 0.0f) reflected = blended(reflected, local.high->reflectance_profile(r));
  }
  if (local.is_inverted) {
    // The half-space of the color wanted, thinned by as much as the material itself is.
    const Bands thick = by_thickness_.back().reflectance_profile(r);
    for (int b = 0; b < bands_; ++b) {
      const std::size_t i = local.node[static_cast<std::size_t>(b)];
      const float low = by_absorption_[i].reflectance_profile(r, b);
      const float high = by_absorption_[i + 1].reflectance_profile(r, b);
      const float thinned = thick[b] > 0.0f ? reflected[b] / thick[b] : 0.0f;
      reflected[b] = thinned * (low + local.node_blend[b] * (high - low));
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
  using ColorUse = SubsurfaceSurface::ColorUse;
  const Bands& total = by_thickness_.back().total_reflectance();
  if (surface_.color_use == ColorUse::none) return total;
  const Vec3f color = scene_.textures.color(surface_.color, point);
  const auto limited = [](Bands values) {
    for (int b = 0; b < N; ++b) values[b] = std::clamp(values[b], 0.0f, 1.0f);
    return values;
  };
  if (surface_.color_use == ColorUse::invert) return limited(conversion_.from_rgb(color));
  return limited(total * conversion_.from_rgb({color.x / mean_color_.x, color.y / mean_color_.y,
                                               color.z / mean_color_.z}));
}

template class MaterialProfiles<4>;
template class MaterialProfiles<8>;
template class MaterialProfiles<16>;

}  // namespace lamina
