// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/walk_space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include "lamina/core/error.h"
#include "lamina/optics/fresnel.h"
#include "lamina/render/refracted_entry.h"

namespace lamina {
namespace {

constexpr int most_mirrors = 10'000;  // of a path between two events

}  // namespace

template <int N>
WalkMedium<N> make_walk_medium(const BandValues<N>& sigma_s, const BandValues<N>& sigma_t,
                               int bands) {
  WalkMedium<N> medium{.sigma_s = sigma_s, .sigma_t = sigma_t};
  const float least = *std::min_element(sigma_t.v, sigma_t.v + bands);
  // Lanes beyond the bands are copies of the last, and decay as it does.
  for (int b = 0; b < N; ++b) medium.sigma_t_over_least[b] = sigma_t[b] - least;
  return medium;
}

Box box_of_material(const Scene& scene, std::uint32_t material) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.material[t] == material)
        for (const std::uint32_t vertex : mesh.triangles[t])
          for (int axis = 0; axis < 3; ++axis) {
            box.low[axis] = std::min(box.low[axis], mesh.positions[vertex][axis]);
            box.high[axis] = std::max(box.high[axis], mesh.positions[vertex][axis]);
          }
  return box.low.x <= box.high.x ? box : Box{};
}

void require_closed_meshes(const Scene& scene, std::uint32_t material) {
  for (const Mesh& mesh : scene.meshes)
    if (!mesh.is_closed && std::ranges::find(mesh.material, material) != mesh.material.end())
      throw InvalidInput("mesh \"" + mesh.name +
                         "\": random_walk needs a closed surface, with an inside that light can "
                         "walk in, but this one is open; close it or use another method");
}

template <int N>
WalkSpace<N>::WalkSpace(const RenderScene& scene, const BandConversion<N>& conversion,
                        std::uint32_t material, float ior, int bands, float free_path)
    : scene_(scene),
      conversion_(conversion),
      material_(material),
      ior_(ior),
      bands_(bands),
      box_(box_of_material(*scene.scene, material)) {
  safe_ = std::make_unique<SafeDistances>(scene.geometry, scene.scene->meshes,
                                          lattice(0.7f * free_path, 1e6));
}

template <int N>
bool WalkSpace<N>::is_inside(const Vec3f& position) const {
  const Hit hit = scene_.geometry.first_hit({position, {0, 0, 1}}, 0.0f);
  if (!hit.is_hit()) return false;
  const SurfacePoint above = make_bare_surface_point(scene_.scene->meshes, hit);
  return above.material != material_ || above.geometric_normal.z > 0.0f;
}

template <int N>
void WalkSpace<N>::bounce(WalkPath<N>& path, const SurfacePoint& point, const Hit& hit,
                          Vec2f u) const {
  const auto* diffuse =
      std::get_if<DiffuseSurface>(&scene_.scene->materials[point.material].surface);
  path.carried *= diffuse
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
bool WalkSpace<N>::meet_surface(WalkPath<N>& path, const Hit& hit, WalkStep& step, Vec2f u,
                                float u_boundary) const {
  const SurfacePoint& point =
      step.point.emplace(make_bare_surface_point(scene_.scene->meshes, hit));
  if (is_blocker(point, path.ray.direction)) {
    bounce(path, point, hit, u);
  } else {
    const Vec3f n = point.smooth_normal;
    const float cos_inside = dot(n, path.ray.direction);
    const float sin2_outside = ior_ * ior_ * (1.0f - cos_inside * cos_inside);
    const bool is_mirrored = !(cos_inside > 0.0f) || sin2_outside >= 1.0f ||
                             u_boundary < fresnel(std::min(cos_inside, 1.0f), 1.0f / ior_);
    if (!is_mirrored) {
      const float cos_outside = std::sqrt(1.0f - sin2_outside);
      step.outside = normalize(ior_ * path.ray.direction + (cos_outside - ior_ * cos_inside) * n);
      if (dot(step.outside, point.geometric_normal) > 0.0f) return true;
    }
    // A mirrored direction must stay inside the facet, whatever the smooth normal says.
    Vec3f mirrored = path.ray.direction - 2.0f * cos_inside * n;
    if (!(dot(mirrored, point.geometric_normal) < 0.0f))
      mirrored = path.ray.direction -
                 2.0f * dot(path.ray.direction, point.geometric_normal) * point.geometric_normal;
    path.ray.direction = normalize(mirrored);
  }
  path.ray.origin = leave_surface(point, path.ray.direction);
  path.has_scattered = false;
  path.safe = 0.0f;
  return false;
}

template <int N>
WalkStep WalkSpace<N>::advance(WalkPath<N>& path, const WalkMedium<N>& medium,
                               WalkNumbers& numbers) const {
  WalkStep step;
  for (int mirrors = 0; mirrors < most_mirrors; ++mirrors) {
    const Vec2f u = numbers.pair();
    const float extinction = medium.sigma_t[draw_band(path.carried, u.x)];
    const float drawn = extinction > 0.0f ? -std::log(1.0f - u.y) / extinction : 1e9f;
    const Vec3f end = path.ray.origin + drawn * path.ray.direction;
    const float safe_at_end = std::max(safe_->at(end), 0.0f);
    Hit hit;
    if (!(drawn < path.safe + safe_at_end))
      hit = scene_.geometry.first_hit(path.ray, path.has_scattered ? 0.0f : least_distance(scene_),
                                      drawn);
    // exp(-sigma_t s) of each band; what all share cancels.
    Bands passing =
        exp_minus((hit.is_hit() ? hit.distance : drawn) * medium.sigma_t_over_least) * path.carried;
    const Bands density = hit.is_hit() ? passing : medium.sigma_t * passing;
    if (!hit.is_hit()) passing *= medium.sigma_s;
    float carried = 0.0f, drawn_density = 0.0f;
    for (int b = 0; b < bands_; ++b) {
      carried += path.carried[b];
      drawn_density += density[b];
    }
    if (!(drawn_density > 0.0f)) return step;  // beyond what floats hold, or through a hole
    path.carried = (carried / drawn_density) * passing;
    if (!hit.is_hit()) {
      path.ray.origin = end;
      path.safe = safe_at_end;
      path.has_scattered = true;
      step.end = WalkStep::End::event;
      return step;
    }
    const Vec2f u_turn = numbers.pair();
    if (meet_surface(path, hit, step, u_turn, numbers.stream().uniform_float())) {
      step.end = WalkStep::End::leaves;
      return step;
    }
  }
  return step;
}

template WalkMedium<4> make_walk_medium(const BandValues<4>&, const BandValues<4>&, int);
template WalkMedium<8> make_walk_medium(const BandValues<8>&, const BandValues<8>&, int);
template WalkMedium<16> make_walk_medium(const BandValues<16>&, const BandValues<16>&, int);
template class WalkSpace<4>;
template class WalkSpace<8>;
template class WalkSpace<16>;

}  // namespace lamina
