// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/random_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include "lamina/core/error.h"
#include "lamina/optics/fresnel.h"
#include "lamina/scattering/first_order-inl.h"
#include "lamina/scattering/layered_diffusion.h"

namespace lamina {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr int most_events = 100'000;
constexpr float same_way = 0.02f;  // distance of two exits that are one, over the path to them

float fresnel_float(float cos_i, float eta) {
  return static_cast<float>(
      fresnel(std::clamp(static_cast<double>(cos_i), 0.0, 1.0), static_cast<double>(eta)));
}

}  // namespace

/// A path that came from the eye and is inside.
template <int N>
struct RandomWalk<N>::Path {
  Ray ray;
  Bands carried;  ///< of the light that is met, to the eye
  Bands density;  ///< with which each band would have drawn the path, over their mean
  int drawing_band = 0;
  bool has_scattered = false;  ///< and met no surface since

  /// The density by which each segment was drawn is the mean of what it is by each band.
  void normalize(int bands) {
    float sum = 0.0f;
    for (int b = 0; b < bands; ++b) sum += density[b];
    const float scale = static_cast<float>(bands) / sum;
    carried *= scale;
    density *= scale;
  }
};

template <int N>
RandomWalk<N>::RandomWalk(const RenderScene& scene, const BandConversion<N>& conversion,
                          std::uint32_t material)
    : scene_(scene), conversion_(conversion), material_(material) {
  const SurfaceMaterial& surface = scene.scene->materials[material];
  const Material& layers = std::get<SubsurfaceSurface>(surface.surface).material;
  if (layers.layers.size() != 1)
    throw InvalidInput("material \"" + surface.name +
                       "\": random_walk takes one homogeneous layer, but it has " +
                       std::to_string(layers.layers.size()));
  for (const Mesh& mesh : scene.scene->meshes)
    if (!mesh.is_closed && std::ranges::find(mesh.material, material) != mesh.material.end())
      throw InvalidInput("mesh \"" + mesh.name +
                         "\": random_walk needs a closed surface, with an inside that light can "
                         "walk in, but this one is open; close it or use another method");
  bands_ = static_cast<int>(layers.bands.size());
  std::vector<LayerStack> stacks;
  double ior = 0.0;
  for (std::size_t b = 0; b < layers.bands.size(); ++b) {
    stacks.push_back(layer_stack(layers, b));
    phases_.push_back(phase_function(stacks[b].layers()[0]));
    is_same_phase_ = is_same_phase_ && phases_[b] == phases_[0];
    ior += layers.layers[0].ior[b] / layers.ior_above[b] / static_cast<double>(bands_);
    reflectance_[static_cast<int>(b)] =
        static_cast<float>(diffusion_totals(stacks[b], {.is_diffuse = true}).diffuse_reflectance);
  }
  ior_ = static_cast<float>(ior);
  medium_ = make_first_order<N>(stacks);
  sigma_s_ = medium_.layers[0].sigma_s;
  sigma_t_ = medium_.layers[0].sigma_t;
}

template <int N>
BandValues<N> RandomWalk<N>::local_reflectance(const SurfacePoint& /*point*/) const {
  return reflectance_;
}

template <int N>
void RandomWalk<N>::scatter(Path& path, float distance, Random& random) const {
  path.ray.origin += distance * path.ray.direction;
  const double u_cos = random.uniform(), u_lobe = random.uniform();
  const auto cos_theta = static_cast<float>(
      sample_cos_theta(phases_[static_cast<std::size_t>(path.drawing_band)], u_cos, u_lobe));
  const float sin_theta = std::sqrt(std::max(1.0f - cos_theta * cos_theta, 0.0f));
  const float phi = 2.0f * pi * random.uniform_float();
  const Framef frame = make_frame(path.ray.direction);
  path.ray.direction =
      normalize(frame.to_world({sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta}));
  if (is_same_phase_) return;
  const Bands phase =
      first_order::layer_phase(medium_, medium_.layers[0], Bands::filled(cos_theta));
  const float drawn = phase[path.drawing_band];
  path.carried *= (1.0f / drawn) * phase;
  path.density *= (1.0f / drawn) * phase;
  path.normalize(bands_);
}

template <int N>
BandValues<N> RandomWalk<N>::light_from_lamps(const Path& path, const LightGatherer<N>& light,
                                              Random& random) const {
  const float u_light = random.uniform_float();
  const Vec2f u{random.uniform_float(), random.uniform_float()};
  const Vec3f inside = path.ray.origin;
  const LightSample lamp = scene_.lights.sample_light(inside, u_light, u);
  const bool is_sky = !lamp.is_delta && !std::isfinite(lamp.distance);
  if (!(lamp.pdf > 0.0f) || is_sky) return {};
  const auto entry = find_refracted_entry(scene_, inside, material_, ior_, lamp);
  if (!entry) return {};
  const Bands way_in = exp_minus(entry->length * sigma_t_);
  const float cos_turn = std::clamp(-dot(entry->to_surface, -path.ray.direction), -1.0f, 1.0f);
  const Bands phase = first_order::layer_phase(medium_, medium_.layers[0], Bands::filled(cos_turn));
  const float entering = 1.0f - fresnel_float(entry->cos_outside, ior_);
  const Bands clear =
      light.clear_fraction({leave_surface(entry->point, entry->to_light), entry->to_light},
                           0.9999f * entry->light_distance);
  return (entering * entry->focus / (ior_ * ior_ * lamp.pdf)) * phase * way_in * clear *
         conversion_.from_rgb(lamp.radiance);
}

template <int N>
bool RandomWalk<N>::is_found_by_lamps(const Path& path, const SurfacePoint& exit,
                                      const Ray& outside, float lamp_distance) const {
  if (!path.has_scattered) return false;
  const Vec3f lamp = outside.origin + lamp_distance * outside.direction;
  const Vec3f offset = lamp - path.ray.origin;
  const LightSample sample{.direction = normalize(offset), .distance = length(offset), .pdf = 1.0f};
  const auto entry = find_refracted_entry(scene_, path.ray.origin, material_, ior_, sample);
  return entry && length(entry->point.position - exit.position) < same_way * entry->length;
}

template <int N>
BandValues<N> RandomWalk<N>::light_from_outside(const Path& path, const SurfacePoint& point,
                                                const Vec3f& outside, const LightGatherer<N>& light,
                                                PixelSamples& samples) const {
  const Ray ray{leave_surface(point, outside), outside};
  Bands radiance = light.arriving_radiance(ray, samples);
  scene_.lights.for_lights_seen(
      ray, 0.0f, std::numeric_limits<float>::max(), false, [&](const LightSeen& seen) {
        if (seen.is_lamp && !is_found_by_lamps(path, point, ray, seen.distance))
          radiance += conversion_.from_rgb(seen.radiance) *
                      light.clear_fraction(ray, 0.9999f * seen.distance);
      });
  return radiance;
}

/// Turns a path at what it meets from inside. True if it leaves, towards `outside`.
template <int N>
bool RandomWalk<N>::meet_surface(Path& path, const Hit& hit, Vec3f& outside, SurfacePoint& point,
                                 Random& random) const {
  point = make_surface_point(scene_.scene->meshes, hit, 0.0f);
  const SurfaceMaterial& material = scene_.scene->materials[point.material];
  path.has_scattered = false;
  if (point.material != material_ || !(dot(point.geometric_normal, path.ray.direction) > 0.0f)) {
    // A blocker: its base, without its boundary.
    const auto* diffuse = std::get_if<DiffuseSurface>(&material.surface);
    path.carried *=
        diffuse ? conversion_.from_rgb(scene_.textures.color(diffuse->color, point)) : Bands{};
    Vec3f n = point.geometric_normal;
    if (dot(n, path.ray.direction) > 0.0f) n = -n;
    const float r = std::sqrt(random.uniform_float()), phi = 2.0f * pi * random.uniform_float();
    path.ray.direction = normalize(make_frame(n).to_world(
        {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(1.0f - r * r, 0.0f))}));
    path.ray.origin = leave_surface(point, path.ray.direction);
    return false;
  }
  const Vec3f n = point.smooth_normal;
  const float cos_inside = dot(n, path.ray.direction);
  const float sin2_outside = ior_ * ior_ * (1.0f - cos_inside * cos_inside);
  const bool is_reflected = !(cos_inside > 0.0f) || sin2_outside >= 1.0f ||
                            random.uniform_float() < fresnel_float(cos_inside, 1.0f / ior_);
  if (!is_reflected) {
    const float cos_outside = std::sqrt(1.0f - sin2_outside);
    outside = normalize(ior_ * path.ray.direction + (cos_outside - ior_ * cos_inside) * n);
    if (dot(outside, point.geometric_normal) > 0.0f) return true;
  }
  // A mirrored direction must stay inside the facet, whatever the smooth normal says.
  Vec3f mirrored = path.ray.direction - 2.0f * cos_inside * n;
  if (!(dot(mirrored, point.geometric_normal) < 0.0f))
    mirrored = path.ray.direction -
               2.0f * dot(path.ray.direction, point.geometric_normal) * point.geometric_normal;
  path.ray.direction = normalize(mirrored);
  path.ray.origin = leave_surface(point, path.ray.direction);
  return false;
}

template <int N>
BandValues<N> RandomWalk<N>::leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                              PixelSamples& samples) const {
  const Vec2f u_first = samples.next_2d();
  Random random(static_cast<std::uint64_t>(samples.next_1d() * 0x1p24f) << 24 |
                static_cast<std::uint64_t>(samples.next_1d() * 0x1p24f));
  const Vec3f inward = -refract_inside(exit.to_eye, exit.point.normal, ior_);
  if (!(dot(inward, exit.point.geometric_normal) < 0.0f)) return {};
  Path path{.ray = {leave_surface(exit.point, inward), inward},
            .carried = Bands::filled(1.0f - reflectance(exit.boundary, exit.cos_o)),
            .density = Bands::filled(1.0f),
            .drawing_band =
                std::min(static_cast<int>(u_first.x * static_cast<float>(bands_)), bands_ - 1)};
  Bands radiance;
  for (int event = 0; event < most_events; ++event) {
    const float extinction = sigma_t_[path.drawing_band];
    const float u = event == 0 ? u_first.y : random.uniform_float();
    const float drawn = extinction > 0.0f ? -std::log1p(-u) / extinction : 1e9f;
    const Hit hit = scene_.geometry.first_hit(
        path.ray, path.has_scattered ? 0.0f : least_distance(scene_), drawn);
    const float distance = hit.is_hit() ? hit.distance : drawn;
    // exp(-sigma_t s) of each band over that of the one that draws.
    Bands relative;
    for (int b = 0; b < N; ++b)
      relative[b] = std::exp(std::min((extinction - sigma_t_[b]) * distance, 60.0f));
    path.carried *= relative;
    path.density *= relative;
    path.normalize(bands_);
    if (hit.is_hit()) {
      Vec3f outside;
      SurfacePoint point;
      const Path before = path;
      if (meet_surface(path, hit, outside, point, random)) {
        radiance += path.carried * light_from_outside(before, point, outside, light, samples);
        break;
      }
    } else {
      if (!(extinction > 0.0f)) break;  // through a hole
      path.carried *= (1.0f / extinction) * sigma_s_;
      path.density *= (1.0f / extinction) * sigma_t_;
      path.normalize(bands_);
      Path here = path;
      here.ray.origin += distance * path.ray.direction;
      radiance += path.carried * light_from_lamps(here, light, random);
      scatter(path, distance, random);
      path.has_scattered = true;
    }
    const float survival = std::min(largest(path.carried), 1.0f);
    if (event >= 2 && survival < 0.7f) {
      if (!(random.uniform_float() < survival)) break;
      path.carried *= 1.0f / survival;
    }
  }
  return radiance;
}

template class RandomWalk<4>;
template class RandomWalk<8>;
template class RandomWalk<16>;

}  // namespace lamina
