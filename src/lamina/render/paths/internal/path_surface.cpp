// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/paths/internal/path_surface.h"

#include <cmath>
#include <numbers>

namespace lamina {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

}  // namespace

Vec3f sample_cosine_hemisphere(Vec2f u) {
  // Concentric map of the square to the disc: it keeps the strata of the samples compact.
  const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
  float r = 0.0f, phi = 0.0f;
  if (std::abs(a) > std::abs(b)) {
    r = a;
    phi = 0.25f * pi * (b / a);
  } else if (b != 0.0f) {
    r = b;
    phi = 0.5f * pi - 0.25f * pi * (a / b);
  }
  return {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.0f, 1.0f - r * r))};
}

Vec3f make_visible(const Vec3f& n, const Vec3f& wo) {
  constexpr float least = 0.02f;
  const float cos_o = dot(n, wo);
  return cos_o >= least ? n : normalize(n + (least - cos_o) * wo);
}

bool leaves_by_its_side(const SurfacePoint& point, const Vec3f& direction, const Vec3f& local) {
  return local.z * dot(direction, point.geometric_normal) > 0.0f;
}

template <int N>
PathSurface<N> make_path_surface(const PathWorld<N>& world, const SurfacePoint& point,
                                 const Vec3f& towards_eye) {
  const ThinSheet<N>* sheet = world.sheets[point.material].get();
  const bool is_inside = dot(point.geometric_normal, towards_eye) < 0.0f;
  PathSurface<N> surface{.point = point,
                         .boundary = boundary_at(world.scene, point, sheet && is_inside)};
  SurfacePoint& p = surface.point;
  if (is_inside) {
    p.geometric_normal = -p.geometric_normal;
    p.smooth_normal = -p.smooth_normal;
    p.normal = -p.normal;
  }
  p.normal = make_visible(p.normal, towards_eye);
  surface.frame = make_frame(p.normal);
  surface.wo = surface.frame.to_local(towards_eye);
  const auto& material = world.scene.scene->materials[p.material];
  const auto color_of = [&](const ColorParameter& parameter) {
    const Vec3f c = world.scene.textures.color(parameter, p);
    return world.conversion.from_rgb(
        {std::clamp(c.x, 0.0f, 1.0f), std::clamp(c.y, 0.0f, 1.0f), std::clamp(c.z, 0.0f, 1.0f)});
  };
  if (const auto* diffuse = std::get_if<DiffuseSurface>(&material.surface)) {
    surface.reflectance = color_of(diffuse->color);
  } else if (sheet) {
    surface.sheet = sheet;
    surface.place = sheet->place_at(world.scene.textures, p);
    surface.side = is_inside ? 1 : 0;
    surface.color = color_of(std::get<ThinSurface>(material.surface).color);
    surface.beyond = boundary_at(world.scene, point, !is_inside);
    const auto at = sheet->fractions(surface.place, surface.side, surface.wo.z);
    surface.reflectance = surface.color * at.reflected;
    surface.transmittance = surface.color * at.transmitted;
  } else if (const auto* transport = world.transports[p.material].get()) {
    surface.reflectance = transport->local_reflectance(p);
    if (!is_inside) surface.transport = transport;  // the inner side of an open mesh is diffuse
  } else if (const auto* layered = world.layered[p.material].get()) {
    surface.layered = layered->at(p, surface.boundary, surface.wo);
    surface.reflectance = surface.layered->reflectance();
    surface.mirrored = surface.layered->mirrored_inside();
    const float mirrored = sum(surface.mirrored);
    surface.mirrored_chance = mirrored / (mirrored + sum(surface.reflectance) + 1e-6f);
  }
  return surface;
}

template <int N>
float base_lobe(const PathSurface<N>& surface, const Vec3f& wi) {
  if (wi.z < 0.0f && !surface.sheet) return 0.0f;
  if (surface.layered) return 1.0f / pi;  // to weigh lights; the bsdf itself is not for that
  const float entering =
      1.0f - reflectance(wi.z > 0.0f ? surface.boundary : surface.beyond, std::abs(wi.z));
  return entering * exit_distribution(surface.boundary, surface.wo.z);
}

template <int N>
BandValues<N> base_color(const PathSurface<N>& surface, const Vec3f& wi) {
  if (!surface.sheet) return surface.reflectance;
  const float cos_o = surface.wo.z;
  return surface.color *
         (wi.z > 0.0f ? surface.sheet->reflection(surface.place, surface.side, wi.z, cos_o)
                      : surface.sheet->transmission(surface.place, 1 - surface.side, -wi.z, cos_o));
}

template <int N>
float pdf_base(const PathSurface<N>& surface, const Vec3f& wi) {
  const float beyond = surface.beyond_chance();
  return (wi.z > 0.0f ? 1.0f - beyond : beyond) * std::abs(wi.z) / pi;
}

template <int N>
float specular_chance(const PathSurface<N>& surface) {
  if (surface.boundary.count == 0) return 0.0f;
  const float mirrored = reflectance(surface.boundary, surface.wo.z);
  const float base = (1.0f - mirrored) * largest(surface.reflectance + surface.transmittance);
  return std::clamp(mirrored / (mirrored + base + 1e-6f), 0.1f, 0.9f);
}

template PathSurface<4> make_path_surface(const PathWorld<4>&, const SurfacePoint&, const Vec3f&);
template float base_lobe(const PathSurface<4>&, const Vec3f&);
template BandValues<4> base_color(const PathSurface<4>&, const Vec3f&);
template float pdf_base(const PathSurface<4>&, const Vec3f&);
template float specular_chance(const PathSurface<4>&);
template PathSurface<8> make_path_surface(const PathWorld<8>&, const SurfacePoint&, const Vec3f&);
template float base_lobe(const PathSurface<8>&, const Vec3f&);
template BandValues<8> base_color(const PathSurface<8>&, const Vec3f&);
template float pdf_base(const PathSurface<8>&, const Vec3f&);
template float specular_chance(const PathSurface<8>&);
template PathSurface<16> make_path_surface(const PathWorld<16>&, const SurfacePoint&, const Vec3f&);
template float base_lobe(const PathSurface<16>&, const Vec3f&);
template BandValues<16> base_color(const PathSurface<16>&, const Vec3f&);
template float pdf_base(const PathSurface<16>&, const Vec3f&);
template float specular_chance(const PathSurface<16>&);

}  // namespace lamina
