// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/lights/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamina {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

float brightness(const Vec3f& c) { return (c.x + c.y + c.z) / 3.0f; }

Vec3f to_float(const Vec3& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

/// A rectangle as seen from a point: its solid angle, and what sampling it evenly needs.
/// Source: [Urena2013] §4.
struct SphericalRectangle {
  float x0, x1, y0, y1, z0;  ///< extent in the rectangle's axes seen from the point, z0 < 0
  Vec3f axis_z;
  float b0, b1, k;
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
  // Corners v00, v01, v11, v10; normals of the four planes through the point and an edge.
  const float z2 = s.z0 * s.z0;
  const float n0 = -s.y0 / std::sqrt(z2 + s.y0 * s.y0), n1 = s.x1 / std::sqrt(z2 + s.x1 * s.x1);
  const float n2 = s.y1 / std::sqrt(z2 + s.y1 * s.y1), n3 = -s.x0 / std::sqrt(z2 + s.x0 * s.x0);
  const auto angle = [](float c) { return std::acos(std::clamp(c, -1.0f, 1.0f)); };
  const float g0 = angle(-n0 * n1), g1 = angle(-n1 * n2), g2 = angle(-n2 * n3),
              g3 = angle(-n3 * n0);
  s.b0 = n0;
  s.b1 = n2;
  s.k = 2.0f * pi - g2 - g3;
  s.solid_angle = g0 + g1 - s.k;
  return s;
}

/// Below this solid angle the sum of four angles has no digits left and area sampling is as good.
constexpr float smallest_solid_angle = 3e-3f;

/// Of a sky to paths that leave translucent objects, over the typical radiance. By the least work
/// for the same noise under a studio, with some room for skies that are almost even.
constexpr float most_left = 1.5f;

}  // namespace

Lights::Lights(const Scene& scene, const Vec3f& low, const Vec3f& high) {
  const Vec3f middle = 0.5f * (low + high);
  const float radius = std::max(0.5f * length(high - low), 1e-3f);
  for (const Light& light : scene.lights) {
    if (const auto* point = std::get_if<PointLight>(&light)) {
      const Vec3f where = to_float(point->position);
      const float d2 = std::max(dot(where - middle, where - middle), 0.25f * radius * radius);
      spots_.push_back({where, point->intensity, false, brightness(point->intensity) / d2});
    } else if (const auto* far_light = std::get_if<DirectionalLight>(&light)) {
      spots_.push_back({normalize(to_float(far_light->direction)), far_light->irradiance, true,
                        brightness(far_light->irradiance)});
    } else if (const auto* rectangle = std::get_if<RectangleLight>(&light)) {
      Panel panel;
      panel.edge_u = to_float(rectangle->edge_u);
      panel.edge_v = to_float(rectangle->edge_v);
      panel.corner = to_float(rectangle->center) - 0.5f * (panel.edge_u + panel.edge_v);
      panel.size_u = length(panel.edge_u);
      panel.size_v = length(panel.edge_v);
      const Vec3f area_normal = cross(panel.edge_u, panel.edge_v);
      const float area = length(area_normal);
      if (!(area > 0.0f)) continue;
      panel.axis_u = panel.edge_u / panel.size_u;
      panel.axis_v = panel.edge_v / panel.size_v;
      panel.normal = area_normal / area;
      panel.radiance = rectangle->radiance;
      const Vec3f to_middle = middle - to_float(rectangle->center);
      const float d2 = std::max(dot(to_middle, to_middle), 0.25f * radius * radius);
      panel.probability = brightness(panel.radiance) * std::min(area / d2, 2.0f * pi);
      panels_.push_back(panel);
    } else {
      const auto& sky = std::get<EnvironmentLight>(light);
      if (sky.image)
        skies_.push_back(
            {Environment(scene.images[*sky.image], sky.scale, sky.rotation), sky.is_visible, 0.0f});
      else
        skies_.push_back({Environment(sky.scale), sky.is_visible, 0.0f});
      const Environment& environment = skies_.back().environment;
      skies_.back().probability = pi * environment.mean_drawn();
      typical_irradiance_ +=
          pi * (brightness(environment.mean_radiance()) - environment.mean_drawn());
    }
  }
  float total = 0.0f;
  for (const Panel& panel : panels_) total += panel.probability;
  for (const Spot& spot : spots_) total += spot.probability;
  for (const Sky& sky : skies_) total += sky.probability;
  typical_irradiance_ += total;
  if (!(total > 0.0f)) return;
  for (Panel& panel : panels_) panel.probability /= total;
  for (Spot& spot : spots_) spot.probability /= total;
  for (Sky& sky : skies_) sky.probability /= total;
  make_shares();
  make_parts();
}

void Lights::make_shares() {
  constexpr std::size_t most = 4;
  constexpr int of_sky = 8;  // a panel's directions give much the same, and a spot has but one
  float low = 0.0f;
  const auto add = [&](float probability, int candidates) {
    if (probability > 0.0f) shares_.push_back({low, probability, candidates});
    low += probability;
  };
  for (const Spot& spot : spots_) add(spot.probability, 1);  // in the order of sample_light
  for (const Panel& panel : panels_) add(panel.probability, 1);
  for (const Sky& sky : skies_) add(sky.probability, of_sky);
  if (shares_.size() > most) shares_ = {{}};
}

LightSample Lights::sample_light(const Vec3f& position, float u_light, Vec2f u) const {
  for (const Spot& spot : spots_) {
    u_light -= spot.probability;
    if (!(u_light < 0.0f)) continue;
    return sample_spot(spot, position);
  }
  for (const Panel& panel : panels_) {
    u_light -= panel.probability;
    if (!(u_light < 0.0f)) continue;
    LightSample sample = sample_panel(panel, position, u);
    sample.pdf *= panel.probability;
    return sample;
  }
  for (const Sky& sky : skies_) {
    u_light -= sky.probability;
    if (!(u_light < 0.0f) || !sky.environment.can_be_drawn()) continue;
    return sample_sky(sky, u);
  }
  return {};
}

LightSample Lights::sample_sky(const Sky& sky, Vec2f u) const {
  const auto [direction, seen] = sky.environment.draw(u);
  return {direction,     std::numeric_limits<float>::infinity(),
          seen.radiance, seen.pdf * sky.probability,
          false,         sought_share(seen.radiance)};
}

/// What is above the typical radiance and some: so paths meet nothing much brighter by chance, and
/// an even sky, which they find well, takes no search. Typical is at least the mean of the sky, so
/// what is sought can be drawn.
float Lights::sought_share(const Vec3f& radiance) const {
  const float even = most_left * typical_irradiance_ / pi, whole = brightness(radiance);
  return whole > even ? 1.0f - even / whole : 0.0f;
}

bool Lights::has_sought() const {
  return !panels_.empty() || !spots_.empty() || std::ranges::any_of(skies_, [&](const Sky& sky) {
    const float most = sky.environment.greatest_brightness();
    return sought_share({most, most, most}) > 0.0f;
  });
}

LightSample Lights::sample_spot(const Spot& spot, const Vec3f& position) const {
  if (spot.is_far)
    return {spot.where, std::numeric_limits<float>::infinity(), spot.strength, spot.probability,
            true};
  const Vec3f d = spot.where - position;
  const float distance2 = dot(d, d), distance = std::sqrt(distance2);
  if (!(distance2 > 0.0f)) return {};
  return {d / distance, distance, spot.strength / distance2, spot.probability, true};
}

LightSample Lights::sample_panel(const Panel& panel, const Vec3f& position, Vec2f u) {
  if (!(dot(position - panel.corner, panel.normal) > 0.0f)) return {};  // behind it
  const SphericalRectangle s = see_rectangle(panel.corner, panel.axis_u, panel.axis_v, panel.normal,
                                             panel.size_u, panel.size_v, position);
  Vec3f target;
  const bool is_even = s.solid_angle > smallest_solid_angle &&  // over the solid angle
                       std::abs(dot(panel.axis_u, panel.axis_v)) < 1e-4f;
  if (is_even) {
    const float au = u.x * s.solid_angle + s.k;
    const float sin_au = std::sin(au);
    const float fu = (std::cos(au) * s.b0 - s.b1) / (std::abs(sin_au) > 1e-9f ? sin_au : 1e-9f);
    float cu = std::copysign(1.0f / std::sqrt(fu * fu + s.b0 * s.b0), fu);
    cu = std::clamp(cu, -1.0f, 1.0f);
    const float xu =
        std::clamp(-(cu * s.z0) / std::sqrt(std::max(1.0f - cu * cu, 1e-12f)), s.x0, s.x1);
    const float d = std::sqrt(xu * xu + s.z0 * s.z0);
    const float h0 = s.y0 / std::sqrt(d * d + s.y0 * s.y0);
    const float h1 = s.y1 / std::sqrt(d * d + s.y1 * s.y1);
    const float hv = h0 + u.y * (h1 - h0), hv2 = hv * hv;
    const float yv =
        std::clamp(hv2 < 1.0f - 1e-6f ? hv * d / std::sqrt(1.0f - hv2) : s.y1, s.y0, s.y1);
    target = position + xu * panel.axis_u + yv * panel.axis_v + s.z0 * s.axis_z;
  } else {
    target = panel.corner + u.x * panel.edge_u + u.y * panel.edge_v;
  }
  const Vec3f d = target - position;
  const float distance = length(d);
  if (!(distance > 0.0f)) return {};
  const Vec3f direction = d / distance;
  const float pdf =
      is_even ? 1.0f / s.solid_angle : pdf_panel(panel, position, direction, distance);
  return {direction, distance, panel.radiance, pdf, false};
}

float Lights::pdf_panel(const Panel& panel, const Vec3f& position, const Vec3f& direction,
                        float distance) {
  if (std::abs(dot(panel.axis_u, panel.axis_v)) < 1e-4f) {
    const float solid_angle = see_rectangle(panel.corner, panel.axis_u, panel.axis_v, panel.normal,
                                            panel.size_u, panel.size_v, position)
                                  .solid_angle;
    if (solid_angle > smallest_solid_angle) return 1.0f / solid_angle;
  }
  const float cos_light = -dot(direction, panel.normal);
  const float area = length(cross(panel.edge_u, panel.edge_v));
  return cos_light > 1e-6f ? distance * distance / (cos_light * area) : 0.0f;
}

std::optional<LightSeen> Lights::look_at_panel(const Panel& panel, const Ray& ray, float from,
                                               float limit) const {
  const float cos_light = -dot(ray.direction, panel.normal);
  if (!(cos_light > 1e-6f)) return std::nullopt;  // from behind
  const float distance = dot(ray.origin - panel.corner, panel.normal) / cos_light;
  if (!(distance > from) || distance >= limit) return std::nullopt;
  const Vec3f at = ray.origin + distance * ray.direction - panel.corner;
  // Coordinates along edges that need not be at right angles.
  const Vec3f area_normal = cross(panel.edge_u, panel.edge_v);
  const float area2 = dot(area_normal, area_normal);
  const float s = dot(cross(at, panel.edge_v), area_normal) / area2;
  const float t = dot(cross(panel.edge_u, at), area_normal) / area2;
  if (s < 0.0f || s > 1.0f || t < 0.0f || t > 1.0f) return std::nullopt;
  return LightSeen{panel.radiance,
                   pdf_panel(panel, ray.origin, ray.direction, distance) * panel.probability,
                   distance};
}

}  // namespace lamina
