// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/papers/shadow_map/shadow_map_transport.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <utility>

#include "lamina/base/core/float_pi.h"
#include "lamina/base/core/parallel.h"
#include "lamina/render/subsurface/leaving_fraction.h"

namespace lamina {
namespace {

constexpr int rings = 1024;  ///< of a profile, equal fractions of its light

/// Squares of the radii within which equal fractions of the light that passes a slab leave [mm²].
template <int N>
std::vector<float> radii_of_passing(const ProfileTable<N>& table) {
  if (!(largest(table.total_transmittance()) > 0.0f)) return {};
  constexpr int fine_rings = 4096;
  const float ring = table.support_radius() * table.support_radius() / fine_rings;
  std::vector<double> within = {0.0};
  for (int i = 0; i < fine_rings; ++i) {
    const float r = std::sqrt((static_cast<float>(i) + 0.5f) * ring);
    within.push_back(within.back() + static_cast<double>(sum(table.transmittance_profile(r))));
  }
  if (!(within.back() > 0.0)) return {};
  std::vector<float> r2 = {0.0f};
  for (std::size_t i = 1; r2.size() <= rings && i < within.size(); ++i)
    while (r2.size() <= rings) {
      const double wanted = within.back() * static_cast<double>(r2.size()) / rings;
      if (wanted > within[i] && i + 1 < within.size()) break;
      const double f = std::clamp((wanted - within[i - 1]) / (within[i] - within[i - 1]), 0.0, 1.0);
      r2.push_back((static_cast<float>(i - 1) + static_cast<float>(f)) * ring);
    }
  return r2;
}

/// One of these radii.
SampledRadius sample_radius(const std::vector<float>& r2, float u) {
  const float at = u * rings;
  const auto i = std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(rings - 1));
  const float ring = std::max(r2[i + 1] - r2[i], 1e-20f);
  return {std::sqrt(r2[i] + (at - static_cast<float>(i)) * ring), 1.0f / (rings * float_pi * ring)};
}

/// The density of points around the exit that such radii have [1/mm²].
float density_of(const std::vector<float>& r2, float r) {
  const auto at = std::ranges::upper_bound(r2, r * r);
  if (at == r2.begin() || at == r2.end()) return 0.0f;
  return 1.0f / (rings * float_pi * std::max(*at - *(at - 1), 1e-20f));
}

/// Of the texel of a buffer, and of a point that is drawn in one. Measured on one core of a Zen 4
/// [CPU s].
constexpr double seconds_per_buffer_ray = 1e-6, seconds_per_buffer_lookup = 0.15e-6;

/// All buffers of a material have at most this many times the texels of one.
constexpr double most_texels = 32.0;

}  // namespace

template <int N>
ShadowMapTransport<N>::ShadowMapTransport(const RenderScene& scene,
                                          const BandConversion<N>& conversion,
                                          std::uint32_t material, const ProfileMaker& make_profile,
                                          bool is_printed_exit)
    : scene_(scene),
      conversion_(conversion),
      surface_(std::get<SubsurfaceSurface>(scene.scene->materials[material].surface)),
      material_(material),
      is_alone_(scene.scene->materials.size() == 1),
      has_opaque_(std::ranges::any_of(scene.scene->materials,
                                      [](const SurfaceMaterial& other) {
                                        return std::holds_alternative<DiffuseSurface>(
                                            other.surface);
                                      })),
      is_printed_exit_(is_printed_exit),
      profiles_(scene, conversion, material, make_profile),
      gather_profiles_(profiles_, 0.0f) {
  const ProfileTable<N>& own = profiles_.of_material();
  for (int i = 0; i <= rings; ++i) {
    const float r =
        i < rings ? own.sample_radius(static_cast<float>(i) / rings) : own.support_radius();
    r2_of_fraction_.push_back(r * r);
  }
  for (const ProfileTable<N>& table : profiles_.by_thickness())
    r2_of_passing_.push_back(radii_of_passing(table));
}

template <int N>
void ShadowMapTransport<N>::make_buffers() {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Vec3f low{infinity, infinity, infinity}, high = -low;
  for (const Mesh& mesh : scene_.scene->meshes)
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.material[t] != material_) continue;
      for (const std::uint32_t corner : mesh.triangles[t])
        for (int k = 0; k < 3; ++k) {
          low[k] = std::min(low[k], mesh.positions[corner][k]);
          high[k] = std::max(high[k], mesh.positions[corner][k]);
        }
    }
  if (!(low.x <= high.x)) return;  // no surface of the material
  const ShadowMapSettings& settings = scene_.settings.shadow_map;
  const double whole = static_cast<double>(settings.resolution) * settings.resolution;
  const auto wanted = [&](const LightView& view) { return whole / view.parts; };
  double all = 0.0;
  float total = 0.0f;
  std::vector<float> chances;
  std::vector<LightView> views =
      make_light_views(*scene_.scene, settings.lamp_views, settings.dome_views);
  const Vec3f middle = 0.5f * (low + high);
  for (const LightView& view : views) {
    all += wanted(view);
    // Even a view that the middle is behind may light something.
    const float seen = view.is_far ? 1.0f : incident_light(middle, view).irradiance;
    const float least = view.is_far ? 0.0f : 1e-3f / dot(high - low, high - low);
    const Vec3f& s = view.strength;
    chances.push_back((s.x + s.y + s.z) * std::max(seen, least));
    total += chances.back();
  }
  const double scale = std::min(1.0, most_texels * whole / std::max(all, 1.0));
  float running = 0.0f;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!(chances[i] > 0.0f)) continue;
    running += chances[i];
    chance_ends_.push_back(running / total);
    strength_.push_back((total / chances[i]) * conversion_.from_rgb(views[i].strength));
    const int texels = std::max(static_cast<int>(scale * wanted(views[i])), 64);
    buffers_.push_back({.view = views[i],
                        .grid = ShadowGrid(views[i], low, high, texels),
                        .texels = {},
                        .albedo_index = {}});
    buffers_.back().texels.resize(buffers_.back().grid.size());
    if (surface_.color_use == SubsurfaceSurface::ColorUse::invert)
      buffers_.back().albedo_index.resize(buffers_.back().grid.size());
  }
  if (!chance_ends_.empty()) chance_ends_.back() = 1.0f;
}

template <int N>
SubsurfaceCost ShadowMapTransport<N>::expected_cost(const Preparation<N>& /*with*/) const {
  // A buffer is filled by a ray to a texel; the views share the texels of one buffer per light.
  const ShadowMapSettings& settings = scene_.settings.shadow_map;
  const double lights = std::min(static_cast<double>(scene_.scene->lights.size()), 32.0);
  return {
      .preparation = seconds_per_buffer_ray * lights * settings.resolution * settings.resolution,
      .lookup = seconds_per_buffer_lookup * settings.lookups};
}

template <int N>
bool ShadowMapTransport<N>::prepare(const Preparation<N>& with) {
  make_buffers();
  constexpr std::size_t chunk = 2048;
  std::vector<std::pair<std::size_t, std::size_t>> chunks;  // buffer, first texel
  for (std::size_t b = 0; b < buffers_.size(); ++b)
    for (std::size_t k = 0; k < buffers_[b].texels.size(); k += chunk) chunks.push_back({b, k});
  std::atomic<bool> is_stopped = false;
  parallel_for(chunks.size(), [&](std::size_t c) {
    if (is_stopped) return;
    Buffer& buffer = buffers_[chunks[c].first];
    const std::size_t first = chunks[c].second;
    for (std::size_t k = first; k < std::min(first + chunk, buffer.texels.size()); ++k)
      fill_texel(buffer, k, with.light);
    if (!report_progress(with.progress, 0.0)) is_stopped = true;
  });
  return !is_stopped;
}

template <int N>
void ShadowMapTransport<N>::fill_texel(Buffer& buffer, std::size_t k,
                                       const LightGatherer<N>& light) const {
  const Ray ray = buffer.grid.ray(k);
  const Hit hit = is_alone_ ? scene_.geometry.first_hit(ray, 0.0f)
                            : scene_.geometry.first_hit_of(material_, ray, 0.0f);
  if (!hit.is_hit()) return;
  typename Buffer::Texel& texel = buffer.texels[k];
  const SurfacePoint point = surface_at(scene_, hit, buffer.grid.width(hit.distance));
  const Vec3f towards = -ray.direction;
  const float cos_facet = dot(towards, point.geometric_normal);
  const float cos_i = std::min(dot(towards, point.normal), 1.0f);
  if (!(cos_facet > 0.0f) || !(cos_i > 0.0f)) return;
  texel.distance = hit.distance;
  texel.facet = point.geometric_normal;
  texel.plane = dot(texel.facet, point.position - buffer.grid.origin());
  texel.normal = point.smooth_normal;
  // Bent normals brighten and darken the flux that the facet receives.
  constexpr float most = 4.0f;
  texel.entering = Bands::filled((1.0f - reflectance(boundary_at(scene_, point), cos_i)) *
                                 std::min(cos_i / cos_facet, most));
  texel.entering *= profiles_.entering_color(point);
  if (!buffer.albedo_index.empty())
    buffer.albedo_index[k] = profiles_.albedo_index(profiles_.color_at(point));
  if (is_alone_) return;
  const float distance =
      buffer.view.is_far ? std::numeric_limits<float>::infinity() : 0.9999f * hit.distance;
  texel.entering *= light.shadow_transmittance({leave_surface(point, towards), towards}, distance);
  if (has_opaque_) texel.blocker = nearest_blocker(ray, hit);
}

/// Distance to the opaque object that a ray meets before it leaves the translucent one.
template <int N>
float ShadowMapTransport<N>::nearest_blocker(const Ray& ray, const Hit& entry) const {
  Hit hit = entry;
  constexpr int most_surfaces = 16;
  for (int i = 0; i < most_surfaces; ++i) {
    const float from = distance_behind(hit, make_surface_point(scene_.scene->meshes, hit, 0.0f));
    hit = scene_.geometry.first_hit(ray, from);
    if (!hit.is_hit()) break;
    const std::uint32_t material = scene_.scene->meshes[hit.mesh].material[hit.triangle];
    if (material == material_) break;
    if (std::holds_alternative<DiffuseSurface>(scene_.scene->materials[material].surface))
      return hit.distance;
  }
  return std::numeric_limits<float>::infinity();
}

template <int N>
SampledRadius ShadowMapTransport<N>::sample_reflected(const Local& local,
                                                      const RadiusMixture<N>& radii,
                                                      float u) const {
  if (!local.is_inverted && local.low == &profiles_.of_material())
    return sample_radius(r2_of_fraction_, u);
  const float r = radii.sample_radius(u);
  return {r, radii.density(r)};
}

template <int N>
SampledRadius ShadowMapTransport<N>::sample_passing(const Local& local, float u) const {
  const auto* first = profiles_.by_thickness().data();
  const auto& low = r2_of_passing_[static_cast<std::size_t>(local.low - first)];
  const auto& high = r2_of_passing_[static_cast<std::size_t>(local.high - first)];
  const float light_low = (1.0f - local.blend) * sum(local.low->total_transmittance()),
              light_high = local.blend * sum(local.high->total_transmittance());
  const float share = high.empty() ? 1.0f : light_low / std::max(light_low + light_high, 1e-20f);
  const bool is_low = u < share;
  u = std::clamp(is_low ? u / share : (u - share) / (1.0f - share), 0.0f, 0x1.fffffep-1f);
  const float r = sample_radius(is_low ? low : high, u).r;
  return {r, share * density_of(low, r) + (1.0f - share) * density_of(high, r)};
}

template <int N>
BandValues<N> ShadowMapTransport<N>::leaving_radiance(const ExitPoint& exit,
                                                      const LightGatherer<N>& /*light*/,
                                                      PixelSamples& samples) const {
  const Local local = profiles_.profiles_at(exit.point);
  const auto leaving = gather_profiles_.exit_at(exit.point.smooth_normal, local, profiles_);
  const int lookups = scene_.settings.shadow_map.lookups;
  const RadiusMixture<N> radii = profiles_.radius_mixture(local);
  const auto blended = [&](float low, float high) { return low + local.blend * (high - low); };
  const float all_passing =
      blended(sum(local.low->total_transmittance()), sum(local.high->total_transmittance()));
  const float all_reflected =
      blended(sum(local.low->total_reflectance()), sum(local.high->total_reflectance()));
  Bands total;
  for (int i = 0; i < lookups && !buffers_.empty(); ++i) {
    PixelSamples own =
        samples.branch(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(lookups));
    const auto chosen = std::ranges::upper_bound(chance_ends_, own.next_1d());
    const auto b =
        static_cast<std::size_t>(std::min(chosen, chance_ends_.end() - 1) - chance_ends_.begin());
    const Buffer& buffer = buffers_[b];
    Vec2f u = own.next_2d();
    const Vec3f across = incident_light(exit.point.position, buffer.view).direction;
    // What is reflected and what passes have points of their own: one is narrow, the other wide.
    float chance = 0.0f;  // of a point for what passes
    if (all_passing > 0.0f) {
      const float facing = dot(across, exit.point.smooth_normal);
      const float back = (1.0f - facing) * all_passing;
      const float front = (std::max(facing, 0.0f) + 0.05f) * all_reflected;
      chance = std::clamp(back / (back + front), 0.02f, 0.98f);
    }
    const bool passes = u.x < chance;
    u.x = passes ? u.x / chance : (u.x - chance) / (1.0f - chance);
    const auto [r, density] =
        passes ? sample_passing(local, u.x) : sample_reflected(local, radii, u.x);
    if (!(density > 0.0f)) continue;
    // A point in the plane across the light, and where light that crosses it meets the surface.
    const Framef frame = make_frame(across);
    const float phi = 2.0f * float_pi * u.y;
    const Vec3f drawn =
        exit.point.position + r * (std::cos(phi) * frame.x + std::sin(phi) * frame.y);
    const ShadowGrid::Place place = buffer.grid.find(drawn);
    if (place.texel == ShadowGrid::outside) continue;
    const auto& texel = buffer.texels[place.texel];
    if (texel.distance == std::numeric_limits<float>::infinity()) continue;
    if (texel.blocker < place.distance) continue;
    const Vec3f entry = buffer.grid.origin() + place.ray.origin +
                        facet_distance(buffer, place) * place.ray.direction;
    const Vec3f offset = entry - exit.point.position;
    const IncidentLight from = incident_light(drawn, buffer.view);
    const float flux = from.irradiance * dot(from.direction, across);  // that crosses the plane
    const float pdf = (passes ? chance : 1.0f - chance) * density * static_cast<float>(lookups);
    const Bands albedo_index =
        buffer.albedo_index.empty() ? Bands{} : buffer.albedo_index[place.texel];
    const Bands profile = passes ? gather_profiles_.passed(leaving, offset, texel.normal)
                                 : gather_profiles_.reflected(leaving, dot(offset, offset),
                                                              texel.normal, albedo_index);
    total += (flux / pdf) * strength_[b] * texel.entering * profile;
  }
  (void)samples.next_1d(), (void)samples.next_2d();  // which the branches have used
  return leaving_fraction(exit, is_printed_exit_) * leaving.scale * total;
}

template class ShadowMapTransport<4>;
template class ShadowMapTransport<8>;
template class ShadowMapTransport<16>;

}  // namespace lamina
