// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/material_profiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/core/parallel.h"
#include "lamina/optics/fresnel.h"
#include "lamina/reflectance/material_totals.h"
#include "lamina/render/subsurface/colored_transport.h"

namespace lamina {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

/// Mean number of probes along the two tangents and the normal. On a flat surface the tangents find
/// nothing, so the normal is always probed and one of the others every other time.
constexpr std::array<float, 3> probes_along = {0.25f, 0.25f, 1.0f};

bool is_half_space(const Material& material) {
  return !std::isfinite(material.layers.back().thickness);
}

/// What turns a profile into one per flux that entered. A profile per flux arriving along the
/// normal holds the transmittance of that direction.
template <int N>
BandValues<N> per_entered(const Profile& profile, const Material& material) {
  BandValues<N> factor;
  for (std::size_t b = 0; b < profile.bands; ++b) {
    const double eta = material.layers.front().ior[b] / material.ior_above[b];
    factor[static_cast<int>(b)] = profile.per == ProfilePer::entered_flux
                                      ? 1.0f
                                      : static_cast<float>(1.0 / (1.0 - fresnel(1.0, eta)));
  }
  return factor;
}

}  // namespace

template <int N>
ProfileTransport<N>::ProfileTransport(const RenderScene& scene, const BandConversion<N>& conversion,
                                      std::uint32_t material, const ProfileMaker& make_profile,
                                      bool is_printed_exit)
    : scene_(scene),
      conversion_(conversion),
      surface_(std::get<SubsurfaceSurface>(scene.scene->materials[material].surface)),
      material_(material),
      is_printed_exit_(is_printed_exit) {
  const Material& layers = surface_.material;
  // Slabs from a hardly scattering one to one that lets nothing through, three to an octave.
  std::vector<Material> variants;
  std::vector<Profile> profiles;
  if (is_half_space(layers)) {
    const double thinnest = std::max(2.5 * thickness_of_upper_layers(layers), 0.05);
    for (double thickness = thinnest; thickness < 200.0; thickness *= std::numbers::sqrt2) {
      variants.push_back(make_slab(layers, thickness));
      profiles.push_back(make_profile(variants.back()));
      thicknesses_.push_back(static_cast<float>(thickness));
      const auto& through = profiles.back().total_transmittance;
      if (*std::max_element(through.begin(), through.end()) < 2e-3) break;
    }
  }
  variants.push_back(layers);
  profiles.push_back(make_profile(layers));
  const std::size_t slabs = variants.size();
  if (surface_.color_use == SubsurfaceSurface::ColorUse::invert)
    for (double factor = 1.0 / 64.0; factor < 3000.0; factor *= 2.0) {
      variants.push_back(with_absorption(layers, std::vector<double>(layers.bands.size(), factor)));
      profiles.push_back(make_profile(variants.back()));
    }
  // Of the material itself; inversion may need one of an eighth of its absorption.
  std::vector<Profile> widest = {profiles[slabs - 1]};
  if (profiles.size() > slabs) widest.push_back(profiles[slabs + 3]);
  const RadiusGrid grid = make_radius_grid(widest);
  bands_ = static_cast<int>(layers.bands.size());
  reach_ = grid.last;
  for (std::size_t i = 0; i < variants.size(); ++i)
    (i < slabs ? by_thickness_ : by_absorption_)
        .emplace_back(profiles[i], grid, per_entered<N>(profiles[i], variants[i]));
  if (surface_.color_use == SubsurfaceSurface::ColorUse::scale)
    mean_color_ = mean_of_map(scene.textures, surface_.color);
}

template <int N>
float ProfileTransport<N>::thickness_at(const SurfacePoint& point) const {
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
Vec3f ProfileTransport<N>::color_at(const SurfacePoint& point) const {
  return surface_.color_use == SubsurfaceSurface::ColorUse::none
             ? Vec3f{1, 1, 1}
             : scene_.textures.color(surface_.color, point);
}

template <int N>
BandValues<N> ProfileTransport<N>::color_scale(const Vec3f& color) const {
  return conversion_.from_rgb({std::max(color.x / mean_color_.x, 0.0f),
                               std::max(color.y / mean_color_.y, 0.0f),
                               std::max(color.z / mean_color_.z, 0.0f)});
}

template <int N>
typename ProfileTransport<N>::Local ProfileTransport<N>::profiles_for(float thickness,
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
void ProfileTransport<N>::invert_albedo(const Bands& target, Local& local) const {
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
    local.share[b] = std::max(target[b], 1e-3f);
    all += local.share[b];
  }
  // Where the object is thin, half of the samples are for what passes it.
  local.share *= (local.low == &by_thickness_.back() ? 1.0f : 0.5f) / std::max(all, 1e-6f);
}

template <int N>
BandValues<N> ProfileTransport<N>::shade_of(const Bands& reflectance) const {
  Local local;
  local.low = &by_thickness_.back();
  invert_albedo(reflectance, local);
  Bands shade;
  for (int b = 0; b < bands_; ++b)
    shade[b] = static_cast<float>(local.node[static_cast<std::size_t>(b)]) + local.node_blend[b];
  return shade;
}

template <int N>
float ProfileTransport<N>::draw_radius(const Local& local, float u) const {
  if (!local.is_inverted) return local.sampling->draw_radius(u);
  float share = 0.0f;
  for (int b = 0; b < bands_; ++b, u -= share) {
    share = local.share[b];
    if (u >= share) continue;
    const std::size_t i =
        local.node[static_cast<std::size_t>(b)] + (local.node_blend[b] > 0.5f ? 1u : 0u);
    return by_absorption_[i].draw_radius(u / share, b);
  }
  const float rest = local.low == &by_thickness_.back() ? 1.0f : 0.5f;
  return local.sampling->draw_radius(std::clamp(u / rest, 0.0f, 0x1.fffffep-1f));
}

template <int N>
float ProfileTransport<N>::density(const Local& local, float r) const {
  if (!local.is_inverted) return local.sampling->density(r);
  float total = local.low == &by_thickness_.back() ? 0.0f : 0.5f * local.sampling->density(r);
  for (int b = 0; b < bands_; ++b) {
    const std::size_t i =
        local.node[static_cast<std::size_t>(b)] + (local.node_blend[b] > 0.5f ? 1u : 0u);
    total += local.share[b] * by_absorption_[i].density(r, b);
  }
  return total;
}

template <int N>
BandValues<N> ProfileTransport<N>::spread(const Local& local, const Vec3f& offset,
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
    // The half-space of the colour wanted, thinned by as much as the material itself is.
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
BandValues<N> ProfileTransport<N>::leaving_radiance(const ExitPoint& exit,
                                                    const LightGatherer<N>& light,
                                                    PixelSamples& samples) const {
  const SurfacePoint& point = exit.point;
  const Local local = profiles_at(point);
  const Framef frame = make_frame(point.smooth_normal);
  const std::array<Vec3f, 3> axes = {frame.x, frame.y, frame.z};

  // One of all hits, drawn by its weight.
  float total = 0.0f, chosen_weight = 0.0f, u_left = samples.next_1d();
  Bands chosen_spread;
  SurfacePoint entry;
  const auto probe_along = [&](std::size_t axis, Vec2f u) {
    const Vec3f &probe = axes[axis], &across = axes[(axis + 1) % 3], &along = axes[(axis + 2) % 3];
    const float r = draw_radius(local, u.x), phi = 2.0f * pi * u.y;
    const float half = std::sqrt(std::max(reach_ * reach_ - r * r, 1e-6f * reach_ * reach_));
    const Vec3f origin =
        point.position + r * (std::cos(phi) * across + std::sin(phi) * along) + half * probe;
    ProbeHits found;
    scene_.geometry.all_hits({origin, -probe}, 2.0f * half, material_, found);
    for (const Hit& hit : found.all()) {
      const SurfacePoint candidate = make_surface_point(scene_.scene->meshes, hit, point.footprint);
      const Vec3f offset = candidate.position - point.position;
      // Each point belongs to the axis that its facet faces most, and counts on that one alone.
      const Vec3f facing{std::abs(dot(candidate.geometric_normal, axes[0])),
                         std::abs(dot(candidate.geometric_normal, axes[1])),
                         std::abs(dot(candidate.geometric_normal, axes[2]))};
      const std::size_t own_axis = facing.z >= facing.x && facing.z >= facing.y ? 2
                                   : facing.x >= facing.y                       ? 0
                                                                                : 1;
      if (own_axis != axis) continue;
      const float height = dot(offset, probe);
      const float across_probe = std::sqrt(std::max(dot(offset, offset) - height * height, 0.0f));
      // Mean number of probes that find the point, per area of the surface.
      const float density =
          probes_along[axis] * facing[static_cast<int>(axis)] * this->density(local, across_probe);
      if (!(density > 0.0f)) continue;
      const Bands spread_here =
          (1.0f / density) * spread(local, offset, point.smooth_normal, candidate.smooth_normal);
      const float weight = sum(spread_here);
      if (!(weight > 0.0f)) continue;
      total += weight;
      // Reservoir: the new one replaces the old with chance weight / total; u is used up in parts.
      const float chance = weight / total;
      if (u_left < chance) {
        u_left /= chance;
        chosen_spread = spread_here;
        chosen_weight = weight;
        entry = candidate;
      } else {
        u_left = (u_left - chance) / std::max(1.0f - chance, 1e-9f);
      }
    }
  };
  probe_along(2, samples.next_2d());
  const float u_axis = samples.next_1d();
  const Vec2f u_tangent = samples.next_2d();
  if (u_axis < probes_along[0])
    probe_along(0, u_tangent);
  else if (u_axis < probes_along[0] + probes_along[1])
    probe_along(1, u_tangent);
  if (!(total > 0.0f)) return {};
  const SurfaceMaterial& material = scene_.scene->materials[material_];
  if (material.bump || material.normal_map)
    entry.normal = bent_normal(scene_.textures, material, entry);
  return (leaving_share(exit) * total / chosen_weight) * chosen_spread *
         light.entering_irradiance(entry, samples);
}

template <int N>
float ProfileTransport<N>::leaving_share(const ExitPoint& exit) const {
  return is_printed_exit_ ? (1.0f - reflectance(exit.boundary, exit.cos_o)) / pi
                          : exit_distribution(exit.boundary, exit.cos_o);
}

template <int N>
BandValues<N> ProfileTransport<N>::local_reflectance(const SurfacePoint& point) const {
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

template class ProfileTransport<4>;
template class ProfileTransport<8>;
template class ProfileTransport<16>;

}  // namespace lamina
