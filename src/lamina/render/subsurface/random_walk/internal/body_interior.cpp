// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/body_interior.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <variant>

#include "lamina/core/error.h"
#include "lamina/optics/fresnel.h"
#include "lamina/render/shading/refracted_entry.h"

namespace lamina {
namespace {

constexpr int most_mirrors = 10'000;  // of a path between two events
// In free paths: a ball that spares the ray that finds out what leaves; the length of that ray.
constexpr float enough_safety = 1.0f, near = 2.0f;
constexpr float least_kept = 0.05f;  // of a path that is mirrored, without a roulette

float draw_length(float extinction, float u) {
  return extinction > 0.0f ? -std::log(1.0f - u) / extinction : 1e9f;
}

}  // namespace

template <int N>
WalkMedium<N> make_walk_medium(const BandValues<N>& sigma_s, const BandValues<N>& sigma_t,
                               int bands) {
  WalkMedium<N> medium{.sigma_s = sigma_s, .sigma_t = sigma_t};
  const float least = *std::min_element(sigma_t.v, sigma_t.v + bands);
  medium.longest_free_path = 1.0f / least;
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

namespace {

/// `part "scalp, hair" is open: 12 edges do not join two faces, the first at (1, 2, 3) mm`.
std::string what_is_open(const Mesh& mesh, std::uint32_t material) {
  std::size_t others = 0;
  const OpenPart* first = nullptr;
  for (const OpenPart& part : mesh.open_parts) {
    if (std::ranges::find(part.materials, material) == part.materials.end()) continue;
    if (first) ++others;
    if (!first) first = &part;
  }
  if (!first) return "this one is open";
  std::ostringstream text;
  text << (first->name.empty() ? "this one" : "part \"" + first->name + "\"")
       << " is open: " << first->edges << (first->edges == 1 ? " edge does" : " edges do")
       << " not join two faces, the first at (" << first->place.x << ", " << first->place.y << ", "
       << first->place.z << ") mm";
  if (others > 0) text << ", and so " << (others == 1 ? "is " : "are ") << others << " more";
  return text.str();
}

}  // namespace

void require_closed_meshes(const Scene& scene, std::uint32_t material) {
  for (const Mesh& mesh : scene.meshes)
    if (std::ranges::find(mesh.material, material) != mesh.material.end() &&
        !is_closed(mesh, material))
      throw InvalidInput("mesh \"" + mesh.name +
                         "\": random_walk needs a closed surface, with an inside that light can "
                         "walk in, but " +
                         what_is_open(mesh, material) +
                         "; close it, give it another material or use another method");
}

template <int N>
WalkSpace<N>::WalkSpace(const RenderScene& scene, const BandConversion<N>& conversion,
                        std::uint32_t material, float ior, int bands, float free_path)
    : scene_(scene),
      conversion_(conversion),
      material_(material),
      ior_(ior),
      bands_(bands),
      box_(box_of_material(*scene.scene, material)),
      is_dark_outside_(std::ranges::none_of(scene.scene->lights, [](const Light& light) {
        return std::holds_alternative<EnvironmentLight>(light);
      })) {
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
typename WalkSpace<N>::Passing WalkSpace<N>::passing_at(const SurfacePoint& point,
                                                        const Vec3f& direction) const {
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
void WalkSpace<N>::turn(WalkPath<N>& path, const SurfacePoint& point, const Hit& hit,
                        Vec2f u) const {
  Vec3f& direction = path.ray.direction;
  if (is_blocker(point, direction)) {
    bounce(path, point, hit, u);
  } else {
    const auto mirrored = [&](const Vec3f& n) { return direction - 2.0f * dot(direction, n) * n; };
    // A mirrored direction must stay inside the facet, whatever the smooth normal says.
    const Vec3f smooth = mirrored(point.smooth_normal);
    direction = normalize(
        dot(smooth, point.geometric_normal) < 0.0f ? smooth : mirrored(point.geometric_normal));
  }
  path.ray.origin = leave_surface(point, direction);
  path.has_scattered = false;
  path.safe = 0.0f;
}

template <int N>
typename WalkSpace<N>::Part WalkSpace<N>::part_to(const Hit& hit) const {
  return {.length = hit.distance,
          .hit = hit,
          .point = make_bare_surface_point(scene_.scene->meshes, hit)};
}

template <int N>
typename WalkSpace<N>::Part WalkSpace<N>::draw_part(const WalkPath<N>& path,
                                                    const WalkMedium<N>& medium, Vec2f u) const {
  const float drawn = draw_length(medium.sigma_t[draw_band(path.carried, u.x)], u.y);
  const Vec3f end = path.ray.origin + drawn * path.ray.direction;
  if (drawn < path.safe + std::max(safe_->at(end), 0.0f)) return {.length = drawn};
  const Hit hit = scene_.geometry.first_hit(
      path.ray, path.has_scattered ? 0.0f : least_distance(scene_), drawn);
  return hit.is_hit() ? part_to(hit) : Part{.length = drawn};
}

/// As above, but what leaves is taken from each band before one draws, by the share of it that
/// scatters before the surface or is mirrored there.
template <int N>
typename WalkSpace<N>::Part WalkSpace<N>::draw_part_inside(const WalkPath<N>& path,
                                                           const WalkMedium<N>& medium, Vec2f u,
                                                           Random& random,
                                                           const OnLeaving<N>& on_leaving) const {
  // To `sure` there is no surface: paths scatter there as if there were none at all.
  float sure = path.safe;
  Hit hit;
  if (!(sure > enough_safety * medium.longest_free_path)) {
    const float reach = near * medium.longest_free_path;
    hit = scene_.geometry.first_hit(path.ray, path.has_scattered ? 0.0f : least_distance(scene_),
                                    reach);
    sure = hit.is_hit() ? 0.0f : reach;
  }
  int band = 0;
  if (!hit.is_hit()) {
    band = draw_band(path.carried, u.x);
    const float drawn = draw_length(medium.sigma_t[band], u.y);
    if (drawn < sure) return {.length = drawn};
    hit = scene_.geometry.first_hit(path.ray, sure);
    if (!hit.is_hit()) return {.length = drawn};  // through a hole
  }
  Part part = part_to(hit);
  const Passing passing = passing_at(part.point, path.ray.direction);
  const Bands reaching = exp_minus(hit.distance * medium.sigma_t) * path.carried;
  const Bands beyond_sure =
      sure > 0.0f ? exp_minus(sure * medium.sigma_t) * path.carried : path.carried;
  const Bands staying = max(beyond_sure - passing.share * reaching, Bands{});
  const float leaving = passing.share * sum_of_bands(reaching) / sum_of_bands(beyond_sure);
  if (random.uniform_float() < leaving) {
    WalkPath<N> own = path;
    own.carried = (sum_of_bands(path.carried) / sum_of_bands(reaching)) * reaching;
    on_leaving(own, {part.point, passing.outside});
  }
  part.kept = 1.0f - leaving;
  if (!(part.kept > 0.0f)) return part;
  if (sure > 0.0f) {  // what is left of u after the draw above
    const float sure_passing = std::exp(-sure * medium.sigma_t[band]);
    u = {random.uniform_float(),
         std::clamp((u.y - (1.0f - sure_passing)) / sure_passing, 0.0f, 1.0f)};
  }
  band = draw_band(staying, u.x);
  const float drawn =
      sure + draw_length(medium.sigma_t[band], u.y * (staying[band] / beyond_sure[band]));
  if (!(drawn < hit.distance)) return part;
  return {.length = drawn, .kept = part.kept};
}

template <int N>
bool WalkSpace<N>::advance(WalkPath<N>& path, const WalkMedium<N>& medium, WalkNumbers& numbers,
                           const OnLeaving<N>& on_leaving) const {
  float kept = 1.0f;
  for (int mirrors = 0; mirrors < most_mirrors; ++mirrors) {
    const Vec2f u = numbers.pair();
    Random& random = numbers.stream();
    const Part part = is_dark_outside_ ? draw_part_inside(path, medium, u, random, on_leaving)
                                       : draw_part(path, medium, u);
    const bool scatters = !part.hit.is_hit();
    // exp(-sigma_t s) of each band; what all share cancels.
    Bands passing = exp_minus(part.length * medium.sigma_t_over_least) * path.carried;
    const Bands density = scatters ? medium.sigma_t * passing : passing;
    if (scatters) passing *= medium.sigma_s;
    const float drawn_density = sum_of_bands(density);
    // Beyond what floats hold:
    if (!(drawn_density > 0.0f && part.kept > 0.0f)) return false;
    path.carried = (part.kept * sum_of_bands(path.carried) / drawn_density) * passing;
    if (scatters) {
      path.ray.origin += part.length * path.ray.direction;
      path.safe = std::max(safe_->at(path.ray.origin), 0.0f);
      path.has_scattered = true;
      return true;
    }
    const Vec2f u_turn = numbers.pair();
    if (!is_dark_outside_) {
      const Passing at_surface = passing_at(part.point, path.ray.direction);
      if (random.uniform_float() < at_surface.share) {
        on_leaving(path, {part.point, at_surface.outside});
        return false;
      }
    }
    turn(path, part.point, part.hit, u_turn);
    // One that is mirrored often carries little.
    kept *= part.kept;
    if (kept < least_kept) {
      if (!(random.uniform_float() < kept)) return false;
      path.carried *= 1.0f / kept;
      kept = 1.0f;
    }
  }
  return false;
}

template WalkMedium<4> make_walk_medium(const BandValues<4>&, const BandValues<4>&, int);
template WalkMedium<8> make_walk_medium(const BandValues<8>&, const BandValues<8>&, int);
template WalkMedium<16> make_walk_medium(const BandValues<16>&, const BandValues<16>&, int);
template class WalkSpace<4>;
template class WalkSpace<8>;
template class WalkSpace<16>;

}  // namespace lamina
