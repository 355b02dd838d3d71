// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/lights/lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "lamina/base/core/float_pi.h"
#include "lamina/base/core/vec.h"

namespace lamina {
namespace {

/// A rectangle as seen from a point: its solid angle, and what sampling it evenly needs.
/// Source: [Urena2013] §4. Its angles are taken by their sines and cosines, which multiply as
/// complex numbers where angles add: but one function of an angle is asked for, and few digits are
/// lost.
struct SphericalRectangle {
  float x0, x1, y0, y1, z0;  ///< extent in the rectangle's axes seen from the point, z0 < 0
  Vec3f axis_z;
  float b0, b1;        ///< z of the normals of the planes through the edges y0 and y1
  float level0;        ///< sqrt(1 - b0²)
  float cos_k, sin_k;  ///< of what angles start from
  float solid_angle;
};

SphericalRectangle see_rectangle(const Vec3f& corner, const Vec3f& axis_u, const Vec3f& axis_v,
                                 const Vec3f& normal, float size_u, float size_v,
                                 const Vec3f& from) {
  SphericalRectangle s;
  const Vec3f d = corner - from;
  s.x0 = dot(d, axis_u);
  s.y0 = dot(d, axis_v);
  s.x1 = s.x0 + size_u;
  s.y1 = s.y0 + size_v;
  const float z = dot(d, normal);
  s.axis_z = z > 0.0f ? -normal : normal;
  s.z0 = -std::abs(z);
  // Planes through the point and an edge y0, x1, y1, x0: z of their normals, and 1 less its square.
  constexpr int edges = 4;
  const float z2 = s.z0 * s.z0;
  const std::array<float, edges> edge = {-s.y0, s.x1, s.y1, -s.x0};
  std::array<float, edges + 1> n, level2;
  for (std::size_t i = 0; i < edges; ++i) {
    const float over = 1.0f / (z2 + edge[i] * edge[i]);
    n[i] = edge[i] * std::sqrt(over);
    level2[i] = z2 * over;
  }
  n[edges] = n[0];
  level2[edges] = level2[0];
  std::array<float, edges> cosine, sine;  // of the angles between one and the next
  for (std::size_t i = 0; i < edges; ++i) {
    cosine[i] = -n[i] * n[i + 1];
    sine[i] = std::sqrt(level2[i] + n[i] * n[i] * level2[i + 1]);
  }
  const float cos_01 = cosine[0] * cosine[1] - sine[0] * sine[1];
  const float sin_01 = cosine[0] * sine[1] + sine[0] * cosine[1];
  s.b0 = n[0];
  s.b1 = n[2];
  s.level0 = std::sqrt(level2[0]);
  s.cos_k = cosine[2] * cosine[3] - sine[2] * sine[3];  // k is 2 pi less both
  s.sin_k = -cosine[2] * sine[3] - sine[2] * cosine[3];
  s.solid_angle = std::atan2(sin_01 * s.cos_k - cos_01 * s.sin_k,  // the first two less k
                             cos_01 * s.cos_k + sin_01 * s.sin_k);
  if (s.solid_angle < 0.0f) s.solid_angle += 2.0f * float_pi;
  return s;
}

/// A point of it in its axes, evenly over the solid angle. Source: [Urena2013] §4.
Vec2f sample_evenly(const SphericalRectangle& s, Vec2f u) {
  const float angle = u.x * s.solid_angle, sin_angle = std::sin(angle), cos_angle = std::cos(angle);
  const float sin_au = s.sin_k * cos_angle + s.cos_k * sin_angle;
  const float cos_au = s.cos_k * cos_angle - s.sin_k * sin_angle;
  // With f = run / sin_au the cosine is c = sign(f) / sqrt(f² + b0²), and x = -z0 c / sqrt(1 - c²).
  const float run = cos_au * s.b0 - s.b1, rise = s.level0 * sin_au;
  const float left = std::max((run - rise) * (run + rise), 1e-12f * run * run + 1e-30f);
  const float x =
      std::clamp(-s.z0 * std::copysign(sin_au, run * sin_au) / std::sqrt(left), s.x0, s.x1);
  const float d2 = x * x + s.z0 * s.z0;
  const float h0 = s.y0 / std::sqrt(d2 + s.y0 * s.y0), h1 = s.y1 / std::sqrt(d2 + s.y1 * s.y1);
  const float h = h0 + u.y * (h1 - h0), level2 = 1.0f - h * h;
  return {x, std::clamp(level2 > 1e-6f ? h * std::sqrt(d2 / level2) : s.y1, s.y0, s.y1)};
}

/// Below this solid angle few digits of it are left, and area sampling is as good.
constexpr float smallest_solid_angle = 3e-3f;

/// Of a sky to paths that leave translucent objects, over the typical radiance. By the least work
/// for the same noise under a studio, with some room for skies that are almost even.
constexpr float most_left = 1.5f;

/// Few lights, each sampled by itself where that can be done; and where not, chosen in part as if
/// all gave as much: the brightest may be hidden from where another shines.
constexpr std::size_t most_strata = 4;
constexpr float even_share = 0.25f;

}  // namespace

Lights::Lights(const Scene& scene, const Vec3f& low, const Vec3f& high) {
  const Vec3f middle = 0.5f * (low + high);
  const float radius = std::max(0.5f * length(high - low), 1e-3f);
  const auto distance2_to_middle = [&](const Vec3f& where) {
    return std::max(dot(where - middle, where - middle), 0.25f * radius * radius);
  };
  for (const Light& light : scene.lights) {
    if (const auto* point = std::get_if<PointLight>(&light)) {
      const Vec3f where = to_float(point->position);
      delta_lights_.push_back({where, point->intensity, false,
                               mean_of_channels(point->intensity) / distance2_to_middle(where)});
    } else if (const auto* spot = std::get_if<SpotLight>(&light)) {
      const Vec3f where = to_float(spot->position);
      delta_lights_.push_back({where, spot->intensity, false,
                               mean_of_channels(spot->intensity) / distance2_to_middle(where),
                               normalize(to_float(spot->direction)), spot->cos_inner,
                               spot->cos_outer});
    } else if (const auto* ball = std::get_if<SphereLight>(&light)) {
      const Vec3f center = to_float(ball->center);
      const auto ball_radius = static_cast<float>(ball->radius);
      if (!(ball_radius > 0.0f)) continue;
      const float seen = float_pi * ball_radius * ball_radius / distance2_to_middle(center);
      ball_lights_.push_back({center, ball_radius, ball->radiance,
                              mean_of_channels(ball->radiance) * std::min(seen, 2.0f * float_pi)});
    } else if (const auto* far_light = std::get_if<DirectionalLight>(&light)) {
      delta_lights_.push_back({normalize(to_float(far_light->direction)), far_light->irradiance,
                               true, mean_of_channels(far_light->irradiance)});
    } else if (const auto* rectangle = std::get_if<RectangleLight>(&light)) {
      AreaLight area_light;
      area_light.edge_u = to_float(rectangle->edge_u);
      area_light.edge_v = to_float(rectangle->edge_v);
      area_light.corner =
          to_float(rectangle->center) - 0.5f * (area_light.edge_u + area_light.edge_v);
      area_light.size_u = length(area_light.edge_u);
      area_light.size_v = length(area_light.edge_v);
      const Vec3f area_normal = cross(area_light.edge_u, area_light.edge_v);
      const float area = length(area_normal);
      if (!(area > 0.0f)) continue;
      area_light.axis_u = area_light.edge_u / area_light.size_u;
      area_light.axis_v = area_light.edge_v / area_light.size_v;
      area_light.normal = area_normal / area;
      area_light.radiance = rectangle->radiance;
      const float d2 = distance2_to_middle(to_float(rectangle->center));
      area_light.probability =
          mean_of_channels(area_light.radiance) * std::min(area / d2, 2.0f * float_pi);
      area_lights_.push_back(area_light);
    } else {
      const auto& sky = std::get<EnvironmentLight>(light);
      if (sky.image)
        infinite_lights_.push_back(
            {Environment(scene.images[*sky.image], sky.scale, sky.rotation), sky.is_visible, 0.0f});
      else
        infinite_lights_.push_back({Environment(sky.scale), sky.is_visible, 0.0f});
      const Environment& environment = infinite_lights_.back().environment;
      infinite_lights_.back().probability = float_pi * environment.mean_sampled();
      typical_irradiance_ +=
          float_pi * (mean_of_channels(environment.mean_radiance()) - environment.mean_sampled());
    }
  }
  for (std::uint32_t m = 0; m < scene.materials.size(); ++m) {
    const Vec3f& emission = scene.materials[m].emission;
    if (!(mean_of_channels(emission) > 0.0f)) continue;
    ShiningTriangles triangles(scene.meshes, m);
    if (!(triangles.area() > 0.0f)) continue;
    // As from the middle, but from no farther than four times its size: a lamp stands among things.
    const float area = triangles.area();
    const float d2 = std::min(distance2_to_middle(triangles.middle()), 16.0f * area);
    const float seen = 0.25f * area / d2;
    surface_light_of_.resize(scene.materials.size(), no_index);
    surface_light_of_[m] = static_cast<std::uint32_t>(surface_lights_.size());
    surface_lights_.push_back({std::move(triangles), emission,
                               mean_of_channels(emission) * std::min(seen, 2.0f * float_pi)});
  }
  normalize_probabilities();
  if (!(typical_irradiance_ > 0.0f)) return;
  make_strata();
  make_clusters();
}

template <class F>
void Lights::for_probabilities(const F& f) {
  for (DeltaLight& light : delta_lights_) f(light.probability);  // in the order of sample_light
  for (AreaLight& light : area_lights_) f(light.probability);
  for (BallLight& light : ball_lights_) f(light.probability);
  for (SurfaceLight& light : surface_lights_) f(light.probability);
  for (InfiniteLight& light : infinite_lights_) f(light.probability);
}

void Lights::normalize_probabilities() {
  float total = 0.0f, count = 0.0f;
  for_probabilities([&](float irradiance) {
    total += irradiance;
    if (irradiance > 0.0f) count += 1.0f;
  });
  typical_irradiance_ += total;
  if (!(total > 0.0f)) return;
  const float even = count > most_strata ? 0.0f : even_share / count;
  for_probabilities([&](float& p) {
    if (p > 0.0f) p = even + (1.0f - even * count) * (p / total);
  });
}

void Lights::make_strata() {
  constexpr int of_environment = 8;  // directions to an area light give much the same
  float low = 0.0f;
  const auto add = [&](float probability, int candidates) {
    if (probability > 0.0f) strata_.push_back({low, probability, candidates});
    low += probability;
  };
  for (const DeltaLight& delta_light : delta_lights_)
    add(delta_light.probability, 1);  // in the order of sample_light
  for (const AreaLight& area_light : area_lights_) add(area_light.probability, 1);
  for (const BallLight& ball : ball_lights_) add(ball.probability, 1);
  for (const SurfaceLight& surface : surface_lights_) add(surface.probability, 1);
  for (const InfiniteLight& infinite_light : infinite_lights_)
    add(infinite_light.probability, of_environment);
  if (strata_.size() > most_strata) strata_ = {{}};
}

LightSample Lights::sample_light(const Vec3f& position, float u_light, Vec2f u) const {
  for (const DeltaLight& delta_light : delta_lights_) {
    u_light -= delta_light.probability;
    if (!(u_light < 0.0f)) continue;
    return sample_delta_light(delta_light, position);
  }
  for (const AreaLight& area_light : area_lights_) {
    u_light -= area_light.probability;
    if (!(u_light < 0.0f)) continue;
    LightSample sample = sample_area_light(area_light, position, u);
    sample.pdf *= area_light.probability;
    return sample;
  }
  for (const BallLight& ball : ball_lights_) {
    u_light -= ball.probability;
    if (u_light < 0.0f) return sample_ball_light(ball, position, u);
  }
  for (const SurfaceLight& surface : surface_lights_) {
    u_light -= surface.probability;
    if (u_light < 0.0f) return sample_surface_light(surface, position, u);
  }
  for (const InfiniteLight& infinite_light : infinite_lights_) {
    u_light -= infinite_light.probability;
    if (!(u_light < 0.0f) || !infinite_light.environment.can_be_sampled()) continue;
    return sample_infinite_light(infinite_light, u);
  }
  return {};
}

LightSample Lights::sample_infinite_light(const InfiniteLight& infinite_light, Vec2f u) const {
  const auto [direction, seen] = infinite_light.environment.sample(u);
  return {direction,     std::numeric_limits<float>::infinity(),
          seen.radiance, seen.pdf * infinite_light.probability,
          false,         next_event_share_of(seen.radiance)};
}

/// What is above the typical radiance and some: so paths meet nothing much brighter by chance, and
/// an even sky, which they find well, takes no next-event estimation. Typical is at least the mean
/// of the sky, so what is left to it can be sampled.
float Lights::next_event_share_of(const Vec3f& radiance) const {
  const float even = most_left * typical_irradiance_ / float_pi, whole = mean_of_channels(radiance);
  return whole > even ? 1.0f - even / whole : 0.0f;
}

bool Lights::has_next_event_light() const {
  return !area_lights_.empty() || !delta_lights_.empty() || !ball_lights_.empty() ||
         std::ranges::any_of(infinite_lights_, [&](const InfiniteLight& infinite_light) {
           const float most = infinite_light.environment.greatest_brightness();
           return next_event_share_of({most, most, most}) > 0.0f;
         });
}

LightSample Lights::sample_delta_light(const DeltaLight& delta_light, const Vec3f& position) const {
  if (delta_light.is_far)
    return {delta_light.where, std::numeric_limits<float>::infinity(), delta_light.strength,
            delta_light.probability, true};
  const Vec3f d = delta_light.where - position;
  const float distance2 = dot(d, d), distance = std::sqrt(distance2);
  if (!(distance2 > 0.0f)) return {};
  Vec3f irradiance = delta_light.strength / distance2;
  if (dot(delta_light.axis, delta_light.axis) > 0.0f)
    irradiance *= spot_share(-dot(d, delta_light.axis) / distance, delta_light.cos_inner,
                             delta_light.cos_outer);
  return {d / distance, distance, irradiance, delta_light.probability, true};
}

LightSample Lights::sample_ball_light(const BallLight& ball, const Vec3f& position, Vec2f u) {
  const auto seen = see_ball(ball.center, ball.radius, position);
  if (!seen) return {};
  const ShiningPoint target = sample_ball(ball.center, ball.radius, position, *seen, u);
  const Vec3f d = target.position - position;
  const float distance = length(d);
  if (!(distance > 0.0f)) return {};
  return {.direction = d / distance,
          .distance = distance,
          .radiance = ball.radiance,
          .pdf = ball.probability / seen->solid_angle,
          .normal = target.normal};
}

/// From inside translucent objects it is left to paths that leave them, which meet it as a surface.
LightSample Lights::sample_surface_light(const SurfaceLight& surface, const Vec3f& position,
                                         Vec2f u) {
  const ShiningPoint target = surface.triangles.sample(u);
  const Vec3f d = target.position - position;
  const float distance = length(d);
  if (!(distance > 0.0f)) return {};
  const Vec3f direction = d / distance;
  const float cos_light = -dot(direction, target.normal);
  if (!(cos_light > 1e-6f)) return {};
  return {.direction = direction,
          .distance = distance,
          .radiance = surface.radiance,
          .pdf = surface.probability * distance * distance / (cos_light * surface.triangles.area()),
          .next_event_share = 0.0f,
          .normal = target.normal};
}

std::optional<LightSeen> Lights::surface_emission(std::uint32_t material, const Vec3f& normal,
                                                  const Vec3f& direction, float distance) const {
  if (surface_light_of_.empty() || surface_light_of_[material] == no_index) return std::nullopt;
  const float cos_light = -dot(direction, normal);
  if (!(cos_light > 1e-6f)) return std::nullopt;
  const SurfaceLight& surface = surface_lights_[surface_light_of_[material]];
  return LightSeen{
      surface.radiance,
      surface.probability * distance * distance / (cos_light * surface.triangles.area()), distance,
      0.0f};
}

std::optional<LightSeen> Lights::intersect_ball(const BallLight& ball, const Ray& ray, float from,
                                                float limit) {
  const auto distance = meet_ball(ball.center, ball.radius, ray.origin, ray.direction);
  if (!distance || !(*distance > from) || *distance >= limit) return std::nullopt;
  const auto seen = see_ball(ball.center, ball.radius, ray.origin);
  if (!seen) return std::nullopt;
  return LightSeen{ball.radiance, ball.probability / seen->solid_angle, *distance};
}

LightSample Lights::sample_area_light(const AreaLight& area_light, const Vec3f& position, Vec2f u) {
  if (!(dot(position - area_light.corner, area_light.normal) > 0.0f)) return {};  // behind it
  const SphericalRectangle s =
      see_rectangle(area_light.corner, area_light.axis_u, area_light.axis_v, area_light.normal,
                    area_light.size_u, area_light.size_v, position);
  Vec3f target;
  const bool is_even = s.solid_angle > smallest_solid_angle &&  // over the solid angle
                       std::abs(dot(area_light.axis_u, area_light.axis_v)) < 1e-4f;
  if (is_even) {
    const Vec2f at = sample_evenly(s, u);
    target = position + at.x * area_light.axis_u + at.y * area_light.axis_v + s.z0 * s.axis_z;
  } else {
    target = area_light.corner + u.x * area_light.edge_u + u.y * area_light.edge_v;
  }
  const Vec3f d = target - position;
  const float distance = length(d);
  if (!(distance > 0.0f)) return {};
  const Vec3f direction = d / distance;
  const float pdf =
      is_even ? 1.0f / s.solid_angle : pdf_area_light(area_light, position, direction, distance);
  return {.direction = direction,
          .distance = distance,
          .radiance = area_light.radiance,
          .pdf = pdf,
          .normal = area_light.normal};
}

float Lights::pdf_of_area_light(const Vec3f& position, const Vec3f& direction,
                                float distance) const {
  constexpr float slack = 1e-3f;
  float pdf = 0.0f;
  for (const AreaLight& area_light : area_lights_)
    if (const auto seen = intersect_area_light(area_light, {position, direction}, 0.0f,
                                               (1.0f + slack) * distance);
        seen && seen->distance > (1.0f - slack) * distance)
      pdf = seen->pdf;
  for (const BallLight& ball : ball_lights_)
    if (const auto seen =
            intersect_ball(ball, {position, direction}, 0.0f, (1.0f + slack) * distance);
        seen && seen->distance > (1.0f - slack) * distance)
      pdf = seen->pdf;
  return pdf;
}

float Lights::pdf_area_light(const AreaLight& area_light, const Vec3f& position,
                             const Vec3f& direction, float distance) {
  if (std::abs(dot(area_light.axis_u, area_light.axis_v)) < 1e-4f) {
    const float solid_angle =
        see_rectangle(area_light.corner, area_light.axis_u, area_light.axis_v, area_light.normal,
                      area_light.size_u, area_light.size_v, position)
            .solid_angle;
    if (solid_angle > smallest_solid_angle) return 1.0f / solid_angle;
  }
  const float cos_light = -dot(direction, area_light.normal);
  const float area = length(cross(area_light.edge_u, area_light.edge_v));
  return cos_light > 1e-6f ? distance * distance / (cos_light * area) : 0.0f;
}

std::optional<LightSeen> Lights::intersect_area_light(const AreaLight& area_light, const Ray& ray,
                                                      float from, float limit) const {
  const float cos_light = -dot(ray.direction, area_light.normal);
  if (!(cos_light > 1e-6f)) return std::nullopt;  // from behind
  const float distance = dot(ray.origin - area_light.corner, area_light.normal) / cos_light;
  if (!(distance > from) || distance >= limit) return std::nullopt;
  const Vec3f at = ray.origin + distance * ray.direction - area_light.corner;
  // Coordinates along edges that need not be at right angles.
  const Vec3f area_normal = cross(area_light.edge_u, area_light.edge_v);
  const float area2 = dot(area_normal, area_normal);
  const float s = dot(cross(at, area_light.edge_v), area_normal) / area2;
  const float t = dot(cross(area_light.edge_u, at), area_normal) / area2;
  if (s < 0.0f || s > 1.0f || t < 0.0f || t > 1.0f) return std::nullopt;
  return LightSeen{
      area_light.radiance,
      pdf_area_light(area_light, ray.origin, ray.direction, distance) * area_light.probability,
      distance};
}

}  // namespace lamina
