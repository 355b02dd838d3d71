// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/random_walk.h"

#include <algorithm>
#include <array>
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
constexpr int walks = 4;           // from where a ray of the eye enters
constexpr int dealt_events = 4;    // of a path, whose random numbers are stratified
constexpr int searches_of_node = 8;
constexpr float least_chance = 0.04f;  // of a search where the light of lamps is known

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
  float safe = 0.0f;           ///< least distance to a surface

  /// The density by which each segment was drawn is the mean of what it is by each band.
  void normalize(int bands) {
    float sum = 0.0f;
    for (int b = 0; b < bands; ++b) sum += density[b];
    const float scale = static_cast<float>(bands) / sum;
    carried *= scale;
    density *= scale;
  }
};

/// The random numbers of a path: stratified over a pixel's samples for the first events.
template <int N>
class RandomWalk<N>::Numbers {
 public:
  explicit Numbers(PixelSamples& samples)
      : samples_(samples), random_(make_stream(samples)), left_(2 * dealt_events) {}
  [[nodiscard]] Vec2f pair() {
    if (left_ > 0) {
      --left_;
      return samples_.next_2d();
    }
    const float x = random_.uniform_float();
    return {x, random_.uniform_float()};
  }
  [[nodiscard]] Random& stream() { return random_; }

 private:
  PixelSamples& samples_;
  Random random_;
  int left_;
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
  for (const Light& lamp : scene.scene->lights)
    has_lamps_ = has_lamps_ || !std::holds_alternative<EnvironmentLight>(lamp);
  medium_ = make_first_order<N>(stacks);
  sigma_s_ = medium_.layers[0].sigma_s;
  sigma_t_ = medium_.layers[0].sigma_t;
  float least = sigma_t_[0], most = least;
  for (int b = 1; b < bands_; ++b) {
    least = std::min(least, sigma_t_[b]);
    most = std::max(most, sigma_t_[b]);
  }
  // Lanes beyond the bands are copies of the last, and decay as it does.
  for (int b = 0; b < N; ++b) sigma_t_over_least_[b] = sigma_t_[b] - least;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Vec3f low{infinity, infinity, infinity}, high = -low;
  for (const Mesh& mesh : scene.scene->meshes)
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.material[t] == material)
        for (const std::uint32_t vertex : mesh.triangles[t])
          for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], mesh.positions[vertex][axis]);
            high[axis] = std::max(high[axis], mesh.positions[vertex][axis]);
          }
  if (!(low.x <= high.x)) low = high = {};  // the material is on no mesh
  const float free_path = 1.0f / std::max(most, 1e-6f);
  safe_ = std::make_unique<SafeDistances>(scene.geometry, scene.scene->meshes,
                                          NodeLattice(low, high, 0.7f * free_path, 1e6));
  lamp_field_ = std::make_unique<LampField<N>>(NodeLattice(low, high, free_path, 2e5));
}

template <int N>
BandValues<N> RandomWalk<N>::local_reflectance(const SurfacePoint& /*point*/) const {
  return reflectance_;
}

template <int N>
void RandomWalk<N>::scatter(Path& path, Vec2f u, double u_lobe) const {
  const auto cos_theta = static_cast<float>(sample_cos_theta(
      phases_[static_cast<std::size_t>(path.drawing_band)], static_cast<double>(u.x), u_lobe));
  const float sin_theta = std::sqrt(std::max(1.0f - cos_theta * cos_theta, 0.0f));
  const float phi = 2.0f * pi * u.y;
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
template <class OnWay>
void RandomWalk<N>::for_ways_in(const Vec3f& inside, const LightSample& lamp,
                                const OnWay& on_way) const {
  // As if the nearest surface went on flat, which is often near the way; then the straight way.
  const Vec3f n = safe_->nearest_normal(inside);
  if (dot(n, lamp.direction) > 0.0f)
    if (const auto entry = find_refracted_entry(scene_, inside, material_, ior_, lamp,
                                                refract_inside(lamp.direction, n, ior_))) {
      on_way(*entry);
      return;
    }
  if (const auto entry =
          find_refracted_entry(scene_, inside, material_, ior_, lamp, lamp.direction))
    on_way(*entry);
}

template <int N>
template <class OnLight>
void RandomWalk<N>::search_lamp(const Vec3f& inside, float u_light, Vec2f u,
                                const LightGatherer<N>& light, const OnLight& on_light) const {
  const LightSample lamp = scene_.lights.sample_light(inside, u_light, u);
  const bool is_sky = !lamp.is_delta && !std::isfinite(lamp.distance);
  if (!(lamp.pdf > 0.0f) || is_sky) return;
  for_ways_in(inside, lamp, [&](const RefractedEntry& entry) {
    const float entering = 1.0f - fresnel_float(entry.cos_outside, ior_);
    const Bands clear =
        light.clear_fraction({leave_surface(entry.point, entry.to_light), entry.to_light},
                             0.9999f * entry.light_distance);
    const Bands fluence = (entering * entry.focus / (ior_ * ior_ * lamp.pdf)) *
                          exp_minus(entry.length * sigma_t_) * clear *
                          conversion_.from_rgb(lamp.radiance);
    on_light(fluence, entry.to_surface);
  });
}

/// The mean of searches around a node, from places inside.
template <int N>
LampLight<N> RandomWalk<N>::lamp_light_around(std::size_t node, const Vec3f& position,
                                              const LightGatherer<N>& light) const {
  Random random = make_random(scene_.scene->render.seed, node);
  const float width = lamp_field_->spacing();
  std::array<float, searches_of_node> found{};
  LampLight<N> sum;
  float brightness = 0.0f;
  std::size_t count = 0;
  for (int i = 0; i < searches_of_node; ++i) {
    const auto offset = [&] { return width * (random.uniform_float() - 0.5f); };
    const Vec3f place = position + Vec3f{offset(), offset(), offset()};
    const float u_light = (static_cast<float>(i) + random.uniform_float()) / searches_of_node;
    const Vec2f u{random.uniform_float(), random.uniform_float()};
    const Hit hit = scene_.geometry.first_hit({place, {0, 0, 1}}, 0.0f);
    if (!hit.is_hit()) continue;
    const SurfacePoint above = make_surface_point(scene_.scene->meshes, hit, 0.0f);
    if (above.material == material_ && !(above.geometric_normal.z > 0.0f)) continue;
    search_lamp(place, u_light, u, light, [&](const Bands& fluence, const Vec3f& direction) {
      const float here = largest(fluence);
      sum.fluence += fluence;
      sum.direction += here * direction;
      brightness += here;
      found[count] += here;
    });
    ++count;
  }
  if (count == 0) return {};
  const float mean = brightness / static_cast<float>(count);
  sum.fluence *= 1.0f / static_cast<float>(count);
  if (brightness > 0.0f) sum.direction *= 1.0f / brightness;
  for (std::size_t i = 0; i < count; ++i)
    sum.spread = std::max(sum.spread, std::abs(found[i] - mean));
  sum.weight = 1.0f;
  return sum;
}

template <int N>
BandValues<N> RandomWalk<N>::light_from_lamps(const Path& path, const LightGatherer<N>& light,
                                              Random& random) const {
  const auto phase = [&](float cos_turn) {
    return first_order::layer_phase(medium_, medium_.layers[0],
                                    Bands::filled(std::clamp(cos_turn, -1.0f, 1.0f)));
  };
  const LampLight<N> known =
      lamp_field_->at(path.ray.origin, [&](std::size_t node, const Vec3f& position) {
        return lamp_light_around(node, position, light);
      });
  const Bands expected = phase(dot(known.direction, path.ray.direction)) * known.fluence;
  // About what one search may change the light of the path by, over that light.
  const float significance = 0.7f * known.spread * largest(path.carried) /
                             std::max(scene_.lights.typical_irradiance(), 1e-30f);
  const float chance = known.weight > 0.0f ? std::clamp(significance, least_chance, 1.0f) : 1.0f;
  if (!(random.uniform_float() < chance)) return expected;
  const float u_light = random.uniform_float();
  const Vec2f u{random.uniform_float(), random.uniform_float()};
  Bands found;
  search_lamp(path.ray.origin, u_light, u, light,
              [&](const Bands& fluence, const Vec3f& direction) {
                found += phase(dot(direction, path.ray.direction)) * fluence;
              });
  return expected + (1.0f / chance) * (found - expected);
}

template <int N>
bool RandomWalk<N>::is_found_by_lamps(const Path& path, const SurfacePoint& exit,
                                      const Ray& outside, float lamp_distance) const {
  if (!path.has_scattered) return false;
  const Vec3f offset = outside.origin + lamp_distance * outside.direction - path.ray.origin;
  const LightSample sample{.direction = normalize(offset), .distance = length(offset), .pdf = 1.0f};
  bool is_found = false;
  for_ways_in(path.ray.origin, sample, [&](const RefractedEntry& entry) {
    is_found = is_found || length(entry.point.position - exit.position) < same_way * entry.length;
  });
  return is_found;
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
                                 Vec2f u, float u_boundary) const {
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
    const float r = std::sqrt(u.x), phi = 2.0f * pi * u.y;
    path.ray.direction = normalize(make_frame(n).to_world(
        {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(1.0f - r * r, 0.0f))}));
    path.ray.origin = leave_surface(point, path.ray.direction);
    return false;
  }
  const Vec3f n = point.smooth_normal;
  const float cos_inside = dot(n, path.ray.direction);
  const float sin2_outside = ior_ * ior_ * (1.0f - cos_inside * cos_inside);
  const bool is_reflected = !(cos_inside > 0.0f) || sin2_outside >= 1.0f ||
                            u_boundary < fresnel_float(cos_inside, 1.0f / ior_);
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
  const Vec3f inward = -refract_inside(exit.to_eye, exit.point.normal, ior_);
  if (!(dot(inward, exit.point.geometric_normal) < 0.0f)) return {};
  Bands radiance;
  for (std::uint32_t i = 0; i < walks; ++i) {
    PixelSamples own = samples.branch(i, walks);
    radiance += walk(exit, inward, light, own);
  }
  return (1.0f / walks) * radiance;
}

template <int N>
BandValues<N> RandomWalk<N>::walk(const ExitPoint& exit, const Vec3f& inward,
                                  const LightGatherer<N>& light, PixelSamples& samples) const {
  Vec2f u_segment = samples.next_2d();  // a band, and how far it goes
  Numbers numbers(samples);
  Path path{.ray = {leave_surface(exit.point, inward), inward},
            .carried = Bands::filled(1.0f - reflectance(exit.boundary, exit.cos_o)),
            .density = Bands::filled(1.0f),
            .drawing_band =
                std::min(static_cast<int>(u_segment.x * static_cast<float>(bands_)), bands_ - 1)};
  const float extinction = sigma_t_[path.drawing_band];
  Bands radiance;
  for (int event = 0; event < most_events; ++event) {
    const float drawn = extinction > 0.0f ? -std::log1p(-u_segment.y) / extinction : 1e9f;
    const Vec3f end = path.ray.origin + drawn * path.ray.direction;
    const float safe_at_end = safe_->at(end);
    Hit hit;
    if (!(drawn < path.safe + std::max(safe_at_end, 0.0f)))
      hit = scene_.geometry.first_hit(path.ray, path.has_scattered ? 0.0f : least_distance(scene_),
                                      drawn);
    // exp(-sigma_t s) of each band over that of the one that draws; what they share cancels.
    const Bands relative = exp_minus((hit.is_hit() ? hit.distance : drawn) * sigma_t_over_least_);
    const float of_drawing = relative[path.drawing_band];
    if (!(of_drawing > 0.0f)) break;  // beyond what floats hold
    path.carried *= relative;
    path.density *= relative;
    path.normalize(bands_);
    const Vec2f u = numbers.pair();
    if (hit.is_hit()) {
      Vec3f outside;
      SurfacePoint point;
      const Path before = path;
      if (meet_surface(path, hit, outside, point, u, numbers.stream().uniform_float())) {
        radiance += path.carried * light_from_outside(before, point, outside, light, samples);
        break;
      }
      path.safe = 0.0f;
    } else {
      if (!(extinction > 0.0f)) break;  // through a hole
      path.carried *= (1.0f / extinction) * sigma_s_;
      path.density *= (1.0f / extinction) * sigma_t_;
      path.normalize(bands_);
      path.ray.origin = end;
      path.safe = std::max(safe_at_end, 0.0f);
      if (has_lamps_) radiance += path.carried * light_from_lamps(path, light, numbers.stream());
      scatter(path, u, numbers.stream().uniform());
      path.has_scattered = true;
    }
    const float survival = std::min(largest(path.carried), 1.0f);
    if (event >= 2 && survival < 0.7f) {
      if (!(numbers.stream().uniform_float() < survival)) break;
      path.carried *= 1.0f / survival;
    }
    u_segment = numbers.pair();
  }
  return radiance;
}

template class RandomWalk<4>;
template class RandomWalk<8>;
template class RandomWalk<16>;

}  // namespace lamina
