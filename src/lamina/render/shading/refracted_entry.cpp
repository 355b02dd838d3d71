// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/shading/refracted_entry.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lamina/layers/optics/fresnel.h"

namespace lamina {
namespace {

constexpr float least_exit_cosine = 1e-3f;
constexpr int most_newton_steps = 10, most_halvings = 2;
constexpr float miss_tolerance = 1e-4f;  // of the miss, over the path's length
constexpr float small_step = 0.1f;       // over that length: within a triangle it needs no ray

/// What a ray from inside meets, if it is the boundary.
std::optional<BoundaryHit> boundary_at(const RenderScene& scene, const Hit& hit,
                                       const Vec3f& direction, std::uint32_t material) {
  if (!hit.is_hit()) return std::nullopt;
  const SurfacePoint point = make_bare_surface_point(scene.scene->meshes, hit);
  if (point.material != material || !(dot(point.geometric_normal, direction) > 0.0f))
    return std::nullopt;
  return BoundaryHit{point, hit};
}

std::optional<BoundaryHit> meet_boundary(const RenderScene& scene, const Vec3f& inside,
                                         const Vec3f& direction, std::uint32_t material) {
  return boundary_at(scene, scene.geometry.first_hit({inside, direction}, 0.0f), direction,
                     material);
}

struct Refraction {
  Vec3f inside;
  float cos_outside, cos_inside;
};

Refraction refraction(const Vec3f& outside, const Vec3f& n, float ior) {
  const float c = dot(outside, n);
  const float c_inside = std::sqrt(std::max(1.0f - (1.0f - c * c) / (ior * ior), 0.0f));
  return {(1.0f / ior) * outside + (c_inside - c / ior) * n, c, c_inside};
}

/// How the entry and what hangs on it change along the two edges of its triangle.
struct Derivatives {
  std::array<Vec3f, 2> edge, across;  ///< of the entry; of the beam where it passes the point
};

Derivatives derivatives(const Mesh& mesh, const BoundaryHit& entry, const Refraction& r,
                        const Vec3f& to_light, float light_distance, float length, float ior) {
  const auto& t = mesh.triangles[entry.hit.triangle];
  const Vec3f n = entry.point.smooth_normal;
  const float w1 = entry.hit.u, w2 = entry.hit.v;
  const Vec3f unnormalized =
      (1.0f - w1 - w2) * mesh.normals[t[0]] + w1 * mesh.normals[t[1]] + w2 * mesh.normals[t[2]];
  const float scale = 1.0f / std::max(lamina::length(unnormalized), 1e-6f);
  Derivatives d;
  for (std::size_t k = 0; k < 2; ++k) {
    d.edge[k] = mesh.positions[t[k + 1]] - mesh.positions[t[0]];
    const Vec3f dm = scale * (mesh.normals[t[k + 1]] - mesh.normals[t[0]]);
    const Vec3f dn = dm - dot(dm, n) * n;
    const Vec3f d_light =
        (-1.0f / light_distance) * (d.edge[k] - dot(d.edge[k], to_light) * to_light);
    const float dc = dot(d_light, n) + dot(to_light, dn);
    const float dc_inside = r.cos_outside * dc / (ior * ior * r.cos_inside);
    const Vec3f d_inside = (1.0f / ior) * d_light + (r.cos_inside - r.cos_outside / ior) * dn +
                           (dc_inside - dc / ior) * n;
    const Vec3f moved = d.edge[k] - length * d_inside;
    d.across[k] = moved - dot(moved, r.inside) * r.inside;
  }
  return d;
}

/// @param find  direction to the boundary met, if any
template <class Find>
std::optional<RefractedEntry> find_entry_by_newton(const RenderScene& scene, const Vec3f& inside,
                                                   float ior, const LightSample& light,
                                                   const Vec3f& first, const Find& find) {
  const bool is_far = !std::isfinite(light.distance);
  const Vec3f light_position = is_far ? Vec3f{} : inside + light.distance * light.direction;
  const auto find_towards = [&](const Vec3f& place) -> std::optional<BoundaryHit> {
    const Vec3f way = place - inside;
    const float distance = length(way);
    if (!(distance > 0.0f && std::isfinite(distance))) return std::nullopt;
    return find(way / distance);
  };
  auto found = find(first);
  Vec3f last, move;  // the last point that the light reaches, and the step from there
  int halvings = 0;
  for (int step = 0; found && step < most_newton_steps; ++step) {
    const SurfacePoint& point = found->point;
    const Vec3f offset = light_position - point.position;
    const Vec3f to_light = is_far ? light.direction : normalize(offset);
    const float light_distance = is_far ? light.distance : length(offset);
    const Refraction r = refraction(to_light, point.smooth_normal, ior);
    if (!(r.cos_outside > least_exit_cosine)) {
      // Too far, over the horizon of the light: near grazing light steps must be small.
      if (step == 0 || halvings++ == most_halvings) return std::nullopt;
      move *= 0.5f;
      found = find_towards(last + move);
      continue;
    }
    const float length = dot(point.position - inside, r.inside);
    if (!(length > 0.0f)) return std::nullopt;
    const Vec3f miss = point.position - length * r.inside - inside;
    const Derivatives d = derivatives(scene.scene->meshes[point.mesh], *found, r, to_light,
                                      light_distance, length, ior);
    const Vec3f area = cross(d.across[0], d.across[1]);
    const float area2 = dot(area, area);
    if (!(area2 > 0.0f)) return std::nullopt;
    const float near = miss_tolerance * length + 0.5f * least_distance(scene);
    if (dot(miss, miss) < near * near) {
      const float nearer = is_far ? 1.0f : light.distance / light_distance;
      return RefractedEntry{.point = point,
                            .hit = found->hit,
                            .to_light = to_light,
                            .light_distance = light_distance,
                            .to_surface = r.inside,
                            .length = length,
                            .cos_outside = r.cos_outside,
                            .cos_inside = r.cos_inside,
                            .geometry_term = nearer * nearer *
                                             std::abs(dot(cross(d.edge[0], d.edge[1]), to_light)) /
                                             std::sqrt(area2)};
    }
    // The step along the edges that closes the miss, by Cramer's rule in the plane across the beam.
    const float a = -dot(cross(miss, d.across[1]), area) / area2;
    const float b = -dot(cross(d.across[0], miss), area) / area2;
    last = point.position;
    move = a * d.edge[0] + b * d.edge[1];
    const float size = lamina::length(move), most = 2.0f * length;
    if (!std::isfinite(size)) return std::nullopt;  // a focus: no step leads there
    if (size > most) move *= most / size;
    const float w1 = found->hit.u + a, w2 = found->hit.v + b;
    if (size < small_step * length && w1 >= 0.0f && w2 >= 0.0f && w1 + w2 <= 1.0f) {
      found->hit.u = w1;
      found->hit.v = w2;
      found->point = make_bare_surface_point(scene.scene->meshes, found->hit);
    } else {
      found = find_towards(point.position + move);
    }
  }
  return std::nullopt;
}

}  // namespace

Vec3f refract_inside(const Vec3f& outside, const Vec3f& n, float ior) {
  return refraction(outside, n, ior).inside;
}

std::optional<RefractedEntry> find_straight_entry(const RenderScene& scene, const Vec3f& inside,
                                                  std::uint32_t material, float ior,
                                                  const LightSample& light) {
  const auto found = meet_boundary(scene, inside, light.direction, material);
  if (!found || !(found->hit.distance < light.distance)) return std::nullopt;
  const Refraction r = refraction(light.direction, found->point.smooth_normal, ior);
  if (!(r.cos_outside > least_exit_cosine)) return std::nullopt;
  return RefractedEntry{.point = found->point,
                        .hit = found->hit,
                        .to_light = light.direction,
                        .light_distance = light.distance - found->hit.distance,
                        .to_surface = r.inside,
                        .length = found->hit.distance * r.cos_outside / r.cos_inside,
                        .cos_outside = r.cos_outside,
                        .cos_inside = r.cos_inside,
                        .geometry_term = r.cos_outside / r.cos_inside};
}

std::optional<RefractedEntry> find_refracted_entry(const RenderScene& scene, const Vec3f& inside,
                                                   std::uint32_t material, float ior,
                                                   const LightSample& light, const Vec3f& first) {
  return find_entry_by_newton(scene, inside, ior, light, first, [&](const Vec3f& direction) {
    return meet_boundary(scene, inside, direction, material);
  });
}

std::optional<RefractedEntry> find_refracted_entry(const RenderScene& scene, const Vec3f& inside,
                                                   const FindBoundary& find_boundary, float ior,
                                                   const LightSample& light, const Vec3f& first) {
  return find_entry_by_newton(scene, inside, ior, light, first, find_boundary);
}

bool is_flat(const SurfacePoint& point) {
  return dot(point.smooth_normal, point.geometric_normal) > 0.99999f;
}

std::optional<RefractedEntry> find_reflected_entry(const RenderScene& scene, const Vec3f& inside,
                                                   const SurfacePoint& mirror, float ior,
                                                   const LightSample& light, const Vec3f& first) {
  const Vec3f n = mirror.geometric_normal;
  const auto reflect = [&](const Vec3f& v) { return v - 2.0f * dot(v, n) * n; };
  const float depth = dot(mirror.position - inside, n);
  const Vec3f image = inside + 2.0f * depth * n;
  const auto is_mirror = [&](const SurfacePoint& at) {
    constexpr float most_offset = 1e-3f;
    return dot(at.geometric_normal, n) > 0.99999f && is_flat(at) &&
           std::abs(dot(at.position - inside, n) - depth) <=
               most_offset * depth + least_distance(scene);
  };
  const FindBoundary find = [&](const Vec3f& direction) -> std::optional<BoundaryHit> {
    const auto met = meet_boundary(scene, inside, reflect(direction), mirror.material);
    if (!met || !is_mirror(met->point)) return std::nullopt;
    const Hit hit =
        scene.geometry.first_hit({leave_surface(met->point, direction), direction}, 0.0f);
    return boundary_at(scene, hit, direction, mirror.material);
  };
  LightSample seen = light;
  if (std::isfinite(light.distance)) {
    const Vec3f offset = inside + light.distance * light.direction - image;
    seen.distance = length(offset);
    seen.direction = normalize(offset);
  }
  if (!(dot(seen.direction, n) < 0.0f)) return std::nullopt;
  auto entry = find_refracted_entry(scene, image, find, ior, seen, first);
  // The search may have ended where the mirror does not reach.
  if (!entry || !find(entry->to_surface)) return std::nullopt;
  if (std::isfinite(light.distance)) {
    const float nearer = light.distance / seen.distance;
    entry->geometry_term *= nearer * nearer;
  }
  const float cosine = std::abs(dot(entry->to_surface, n));
  entry->to_surface = reflect(entry->to_surface);
  entry->reflectance = static_cast<float>(fresnel(std::min(cosine, 1.0f), 1.0f / ior));
  return entry;
}

}  // namespace lamina
