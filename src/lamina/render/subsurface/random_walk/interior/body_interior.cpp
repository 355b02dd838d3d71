// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/interior/body_interior.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/shading/refracted_entry.h"

namespace lamina {
namespace {

constexpr int most_reflections = 10'000;  // of a path between two events
// In free paths: an empty ball that spares the ray which finds what leaves; the length of that ray.
constexpr float enough_clearance = 1.0f, near = 2.0f;
constexpr float least_remaining = 0.05f;  // of a reflected path, without Russian roulette

float sample_length(float extinction, float u) {
  return extinction > 0.0f ? -std::log(1.0f - u) / extinction : 1e9f;
}

}  // namespace

Vec3f reflect_inside(const SurfacePoint& point, const Vec3f& direction) {
  const auto reflected = [&](const Vec3f& n) { return direction - 2.0f * dot(direction, n) * n; };
  const Vec3f smooth = reflected(point.smooth_normal);
  return normalize(dot(smooth, point.geometric_normal) < 0.0f ? smooth
                                                              : reflected(point.geometric_normal));
}

template <int N>
BodyInterior<N>::BodyInterior(const RenderScene& scene, const BandConversion<N>& conversion,
                              std::uint32_t material, float ior, int bands, float free_path)
    : scene_(scene),
      conversion_(conversion),
      material_(material),
      ior_(ior),
      bands_(bands),
      free_path_(free_path),
      region_(box_of_material(*scene.scene, material)),
      is_dark_outside_(std::ranges::none_of(scene.scene->lights, [](const Light& light) {
        return std::holds_alternative<EnvironmentLight>(light);
      })) {
  narrow_to(region_);
}

template <int N>
void BodyInterior<N>::narrow_to(const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    region_.low[axis] = std::clamp(box.low[axis], region_.low[axis], region_.high[axis]);
    region_.high[axis] = std::clamp(box.high[axis], region_.low[axis], region_.high[axis]);
  }
  distance_ = std::make_unique<DistanceField>(scene_.geometry, scene_.scene->meshes,
                                              lattice(0.7f * free_path_, 1e6),
                                              lattice(1.4f * free_path_, 1.3e5));
}

template <int N>
bool BodyInterior<N>::is_inside(const Vec3f& position) const {
  const Hit hit = scene_.geometry.first_hit({position, {0, 0, 1}}, 0.0f);
  if (!hit.is_hit()) return false;
  const SurfacePoint above = make_bare_surface_point(scene_.scene->meshes, hit);
  return above.material != material_ || above.geometric_normal.z > 0.0f;
}

template <int N>
void BodyInterior<N>::reflect_diffusely(WalkPath<N>& path, const SurfacePoint& point,
                                        const Hit& hit, Vec2f u) const {
  const auto* diffuse =
      std::get_if<DiffuseSurface>(&scene_.scene->materials[point.material].surface);
  path.throughput *= diffuse
                         ? conversion_.from_rgb(scene_.textures.color(
                               diffuse->color, make_surface_point(scene_.scene->meshes, hit, 0.0f)))
                         : Bands{};
  Vec3f n = point.geometric_normal;
  if (dot(n, path.ray.direction) > 0.0f) n = -n;
  const float r = std::sqrt(u.x), phi = 2.0f * std::numbers::pi_v<float> * u.y;
  path.ray.direction = normalize(make_frame(n).to_world(
      {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(1.0f - r * r, 0.0f))}));
}

template <int N>
typename BodyInterior<N>::Transmission BodyInterior<N>::transmission_at(
    const SurfacePoint& point, const Vec3f& direction) const {
  if (is_blocker(point, direction)) return {};
  const Vec3f n = point.smooth_normal;
  const float cos_inside = dot(n, direction);
  const float sin2_outside = ior_ * ior_ * (1.0f - cos_inside * cos_inside);
  if (!(cos_inside > 0.0f) || sin2_outside >= 1.0f) return {};
  const float cos_outside = std::sqrt(1.0f - sin2_outside);
  const Vec3f outside = normalize(ior_ * direction + (cos_outside - ior_ * cos_inside) * n);
  if (!(dot(outside, point.geometric_normal) > 0.0f)) return {};
  return {1.0f - static_cast<float>(fresnel(std::min(cos_inside, 1.0f), 1.0f / ior_)), outside};
}

template <int N>
void BodyInterior<N>::reflect(WalkPath<N>& path, const SurfacePoint& point, const Hit& hit,
                              Vec2f u) const {
  Vec3f& direction = path.ray.direction;
  const bool is_blocked = is_blocker(point, direction);
  if (is_blocked) {
    reflect_diffusely(path, point, hit, u);
  } else {
    direction = reflect_inside(point, direction);
  }
  path.ray.origin = leave_surface(point, direction);
  path.is_reflected_once = path.has_scattered && !is_blocked;
  path.is_reflected_diffusely = path.is_reflected_diffusely || is_blocked;
  path.has_scattered = false;
  path.clearance = 0.0f;
}

template <int N>
typename BodyInterior<N>::Segment BodyInterior<N>::segment_to(const Hit& hit) const {
  return {.length = hit.distance,
          .hit = hit,
          .point = make_bare_surface_point(scene_.scene->meshes, hit)};
}

template <int N>
typename BodyInterior<N>::Segment BodyInterior<N>::sample_segment(const WalkPath<N>& path,
                                                                  const WalkMedium<N>& medium,
                                                                  Vec2f u) const {
  const float drawn = sample_length(medium.sigma_t[sample_band(path.throughput, u.x)], u.y);
  const Vec3f end = path.ray.origin + drawn * path.ray.direction;
  if (drawn < path.clearance + std::max(distance_->at(end), 0.0f)) return {.length = drawn};
  const Hit hit = scene_.geometry.first_hit(
      path.ray, path.has_scattered ? 0.0f : least_distance(scene_), drawn);
  return hit.is_hit() ? segment_to(hit) : Segment{.length = drawn};
}

/// Forced scattering: as above, but each band loses what leaves before one is sampled, and a
/// segment is sampled from what scatters before the surface or is reflected there.
template <int N>
typename BodyInterior<N>::Segment BodyInterior<N>::sample_forced_segment(
    const WalkPath<N>& path, const WalkMedium<N>& medium, Vec2f u, Random& random,
    const OnEscape<N>& on_escape) const {
  // To `sure` there is no surface: free paths are sampled there as if there were none at all.
  float sure = path.clearance;
  Hit hit;
  if (!(sure > enough_clearance * medium.longest_free_path)) {
    const float reach = near * medium.longest_free_path;
    hit = scene_.geometry.first_hit(path.ray, path.has_scattered ? 0.0f : least_distance(scene_),
                                    reach);
    sure = hit.is_hit() ? 0.0f : reach;
  }
  int band = 0;
  if (!hit.is_hit()) {
    band = sample_band(path.throughput, u.x);
    const float drawn = sample_length(medium.sigma_t[band], u.y);
    if (drawn < sure) return {.length = drawn};
    hit = scene_.geometry.first_hit(path.ray, sure);
    if (!hit.is_hit()) return {.length = drawn};  // through a hole
  }
  Segment segment = segment_to(hit);
  const Transmission transmitted = transmission_at(segment.point, path.ray.direction);
  const Bands reaching = exp_minus(hit.distance * medium.sigma_t) * path.throughput;
  const Bands beyond_sure =
      sure > 0.0f ? exp_minus(sure * medium.sigma_t) * path.throughput : path.throughput;
  const Bands staying = max(beyond_sure - transmitted.fraction * reaching, Bands{});
  const float leaving = transmitted.fraction * sum_of_bands(reaching) / sum_of_bands(beyond_sure);
  if (leaving > 0.0f && (path.leaves_for_certain() || random.uniform_float() < leaving)) {
    WalkPath<N> own = path;
    const float share = path.leaves_for_certain() ? leaving : 1.0f;
    own.throughput = (share * sum_of_bands(path.throughput) / sum_of_bands(reaching)) * reaching;
    on_escape(own, {segment.point, transmitted.outside});
  }
  segment.remaining = 1.0f - leaving;
  if (!(segment.remaining > 0.0f)) return segment;
  if (sure > 0.0f) {  // reuse what is left of u
    const float sure_passing = std::exp(-sure * medium.sigma_t[band]);
    u = {random.uniform_float(),
         std::clamp((u.y - (1.0f - sure_passing)) / sure_passing, 0.0f, 1.0f)};
  }
  band = sample_band(staying, u.x);
  const float drawn =
      sure + sample_length(medium.sigma_t[band], u.y * (staying[band] / beyond_sure[band]));
  if (!(drawn < hit.distance)) return segment;
  return {.length = drawn, .remaining = segment.remaining};
}

template <int N>
bool BodyInterior<N>::advance(WalkPath<N>& path, const WalkMedium<N>& medium, WalkNumbers& numbers,
                              const OnEscape<N>& on_escape) const {
  float remaining = 1.0f;
  for (int reflections = 0; reflections < most_reflections; ++reflections) {
    const Vec2f u = numbers.pair();
    Random& random = numbers.stream();
    const bool is_forced = is_dark_outside_ || path.leaves_for_certain();
    const Segment segment = is_forced ? sample_forced_segment(path, medium, u, random, on_escape)
                                      : sample_segment(path, medium, u);
    const bool scatters = !segment.hit.is_hit();
    // exp(-sigma_t s) of each band; what all share cancels.
    Bands reaching = exp_minus(segment.length * medium.sigma_t_over_least) * path.throughput;
    const Bands density = scatters ? medium.sigma_t * reaching : reaching;
    if (scatters) reaching *= medium.sigma_s;
    const float density_of_mixture = sum_of_bands(density);
    // Beyond what floats hold:
    if (!(density_of_mixture > 0.0f && segment.remaining > 0.0f)) return false;
    path.throughput =
        (segment.remaining * sum_of_bands(path.throughput) / density_of_mixture) * reaching;
    if (scatters) {
      path.ray.origin += segment.length * path.ray.direction;
      path.clearance = std::max(distance_->at(path.ray.origin), 0.0f);
      ++path.events;
      path.has_scattered = true;
      path.is_reflected_once = path.is_reflected_diffusely = false;
      return true;
    }
    const Vec2f u_turn = numbers.pair();
    if (!is_forced) {
      const Transmission at_surface = transmission_at(segment.point, path.ray.direction);
      if (random.uniform_float() < at_surface.fraction) {
        on_escape(path, {segment.point, at_surface.outside});
        return false;
      }
    }
    reflect(path, segment.point, segment.hit, u_turn);
    // Russian roulette for paths that are reflected often.
    remaining *= segment.remaining;
    if (remaining < least_remaining) {
      if (!(random.uniform_float() < remaining)) return false;
      path.throughput *= 1.0f / remaining;
      remaining = 1.0f;
    }
  }
  return false;
}

template class BodyInterior<4>;
template class BodyInterior<8>;
template class BodyInterior<16>;

}  // namespace lamina
