// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/radiance/light_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "lamina/base/core/parallel_chunks.h"
#include "lamina/layers/optics/fresnel.h"

namespace lamina {
namespace {

// Noise over time: benchmarks/subsurface_methods; no mean depends on it.
constexpr std::size_t first_rays = 4096, most_rays = 65536, rays_at_once = 256;
/// Of the power that enters, below which vertices are not worth their time.
constexpr float least_lost = 1e-3f;
constexpr float cell_in_free_paths = 2.0f;
constexpr int most_mirrors = 8;  // that light meets inside
constexpr int cells_around = 27;
constexpr float least_cosine_outside = 1e-3f;

}  // namespace

template <int N>
LightVertices<N>::LightVertices(const BodyInterior<N>& interior,
                                const ManifoldNextEvent<N>& next_event, const WalkLayers<N>& layers)
    : interior_(interior), next_event_(next_event), layers_(layers) {
  const Box box = box_of_material(*interior.scene().scene, interior.material());
  cell_size_ = cell_in_free_paths *
               std::min(layers.medium(0).longest_free_path, 0.1f * length(box.high - box.low));
}

template <int N>
void LightVertices<N>::find_surface() {
  const auto& meshes = interior_.scene().scene->meshes;
  const Box& region = interior_.region();
  triangles_.clear();
  area_to_end_.clear();
  double area = 0.0;
  for (std::uint32_t m = 0; m < meshes.size(); ++m)
    for (std::uint32_t t = 0; t < meshes[m].triangles.size(); ++t) {
      if (meshes[m].material[t] != interior_.material()) continue;
      std::array<Vec3f, 3> corner;
      for (std::size_t k = 0; k < 3; ++k)
        corner[k] = meshes[m].positions[meshes[m].triangles[t][k]];
      bool is_near = true;
      for (int axis = 0; axis < 3; ++axis) {
        const auto [least, most] = std::minmax({corner[0][axis], corner[1][axis], corner[2][axis]});
        is_near = is_near && least <= region.high[axis] && most >= region.low[axis];
      }
      if (!is_near) continue;
      area +=
          0.5 * static_cast<double>(length(cross(corner[1] - corner[0], corner[2] - corner[0])));
      triangles_.push_back({.mesh = m, .triangle = t});
      area_to_end_.push_back(area);
    }
}

template <int N>
float LightVertices<N>::density_of_light(const SurfacePoint& entry, const Vec3f& to_light,
                                         float pdf) const {
  const float ior = interior_.ior();
  const Box& region = interior_.region();
  for (int axis = 0; axis < 3; ++axis)
    if (entry.position[axis] < region.low[axis] || entry.position[axis] > region.high[axis])
      return 0.0f;
  // Etendue: area times projected solid angle outside is ior² times that inside.
  const float cosine = std::max(dot(entry.smooth_normal, to_light), least_cosine_outside);
  return static_cast<float>(rays_ / surface_area()) * pdf * ior * ior / cosine;
}

template <int N>
SurfacePoint LightVertices<N>::sample_surface(Random& random) const {
  const double drawn = static_cast<double>(random.uniform_float()) * surface_area();
  const auto end = std::ranges::upper_bound(area_to_end_, drawn);
  Hit at = triangles_[std::min(static_cast<std::size_t>(end - area_to_end_.begin()),
                               triangles_.size() - 1)];
  const float root = std::sqrt(random.uniform_float());
  at.u = root * random.uniform_float();
  at.v = root - at.u;
  return make_bare_surface_point(interior_.scene().scene->meshes, at);
}

template <int N>
auto LightVertices<N>::sample_beam(const LightGatherer<N>& light, Random& random) const
    -> std::optional<Beam> {
  const float ior = interior_.ior();
  const SurfacePoint entry = sample_surface(random);
  const float u_light = random.uniform_float(), u = random.uniform_float();
  const LightSample sample =
      interior_.scene().lights.sample_light(entry.position, u_light, {u, random.uniform_float()});
  if (!(sample.pdf > 0.0f && sample.next_event_share > 0.0f)) return std::nullopt;
  const Vec3f n = entry.smooth_normal;
  const float cosine = dot(n, sample.direction);
  if (!(cosine > least_cosine_outside && dot(entry.geometric_normal, sample.direction) > 0.0f))
    return std::nullopt;
  const float density =
      density_of_light(entry, sample.direction, sample.is_delta ? 1e30f : sample.pdf);
  if (!(density > 0.0f)) return std::nullopt;
  const Vec3f direction = -refract_inside(sample.direction, n, ior);
  // Smooth normals change what area a beam has, as paths from the eye see it.
  const float of_normals = dot(entry.geometric_normal, direction) / dot(n, direction);
  if (!(of_normals > 0.0f && dot(n, direction) < 0.0f)) return std::nullopt;
  const Ray outside{leave_surface(entry, sample.direction), sample.direction};
  const Bands clear = light.shadow_transmittance(outside, 0.9999f * sample.distance);
  const float entering = 1.0f - static_cast<float>(fresnel(std::min(cosine, 1.0f), ior));
  const float of_area = static_cast<float>(surface_area() / rays_);
  const Bands power = (sample.next_event_share * entering * cosine * of_normals * of_area /
                       (sample.pdf * ior * ior)) *
                      clear * interior_.conversion().from_rgb(sample.radiance);
  if (!(sum_of_bands(power) > 0.0f)) return std::nullopt;
  return Beam{.entry = entry,
              .outside = outside,
              .light_distance = sample.distance,
              .density = density,
              .inside = {leave_surface(entry, direction), direction},
              .power = power};
}

template <int N>
auto LightVertices<N>::sample_event(const Beam& beam, const Bands& passing, Random& random) const
    -> std::optional<Vertex> {
  const WalkMedium<N>& medium = layers_.medium(0);
  const Bands stopped = beam.power * (Bands::filled(1.0f) - passing);
  const float power_stopped = sum_of_bands(stopped);
  if (!(power_stopped > 0.0f)) return std::nullopt;
  const int band = sample_band(stopped, interior_.bands(), random.uniform_float());
  const float distance =
      -std::log1p(-random.uniform_float() * (1.0f - passing[band])) / medium.sigma_t[band];
  const Bands reaching = exp_minus(distance * medium.sigma_t) * beam.power;
  const float pdf = sum_of_bands(medium.sigma_t * reaching) / power_stopped;
  if (!(pdf > 0.0f && std::isfinite(distance))) return std::nullopt;
  const auto& [origin, direction] = beam.inside;
  return Vertex{origin + distance * direction, -direction, (1.0f / pdf) * medium.sigma_s * reaching,
                beam.density};
}

template <int N>
bool LightVertices<N>::reflect(Beam& beam, const SurfacePoint& mirror) const {
  const Vec3f direction = beam.inside.direction;
  if (interior_.is_blocker(mirror, direction)) return false;
  const float cos_inside = std::min(dot(mirror.smooth_normal, direction), 1.0f);
  if (!(cos_inside > 0.0f)) return false;
  const Vec3f onward = reflect_inside(mirror, direction);
  const float of_normals =
      -dot(mirror.geometric_normal, onward) / dot(mirror.geometric_normal, direction);
  beam.power *= of_normals * static_cast<float>(fresnel(cos_inside, 1.0f / interior_.ior()));
  beam.inside = {leave_surface(mirror, onward), onward};
  return true;
}

template <int N>
float LightVertices<N>::trace_ray(const LightGatherer<N>& light, Random random,
                                  std::vector<Vertex>& found) const {
  const RenderScene& scene = interior_.scene();
  std::optional<Beam> beam = sample_beam(light, random);
  if (!beam) return 0.0f;
  const float entering = sum_of_bands(beam->power);
  for (int reflections = 0; reflections <= most_mirrors; ++reflections) {
    const Hit hit = scene.geometry.first_hit(beam->inside, least_distance(scene));
    if (!hit.is_hit()) break;
    const Bands passing = exp_minus(hit.distance * layers_.medium(0).sigma_t);
    const auto event = sample_event(*beam, passing, random);
    if (event && !next_event_.finds(event->position, reflections, beam->entry, beam->outside,
                                    {.distance = beam->light_distance}))
      found.push_back(*event);
    beam->power *= passing;
    if (!reflect(*beam, make_bare_surface_point(scene.scene->meshes, hit))) break;
    // Russian roulette.
    const float remaining = sum_of_bands(beam->power) / entering;
    if (!(random.uniform_float() < remaining)) break;
    beam->power *= 1.0f / std::min(remaining, 1.0f);
  }
  return entering;
}

template <int N>
bool LightVertices<N>::trace(const LightGatherer<N>& light, const Progress& progress) {
  vertices_.clear();
  cells_.clear();
  if (!next_event_.has_lights()) return true;
  find_surface();
  if (!(surface_area() > 0.0)) return true;
  const std::uint64_t seed = interior_.scene().settings.seed + 3;
  for (const std::size_t rays : {first_rays, most_rays}) {
    rays_ = static_cast<double>(rays);
    std::vector<std::vector<Vertex>> found(rays / rays_at_once);
    std::vector<float> entering(rays);
    const auto trace_one = [&](std::size_t i) {
      entering[i] = trace_ray(light, make_random(seed, i), found[i / rays_at_once]);
    };
    if (!parallel_chunks(rays, rays_at_once, trace_one, progress)) return false;
    vertices_.clear();
    for (const auto& some : found) vertices_.insert(vertices_.end(), some.begin(), some.end());
    double power = 0.0;
    for (const Vertex& vertex : vertices_)
      for (int b = 0; b < interior_.bands(); ++b) power += static_cast<double>(vertex.power[b]);
    const double all = std::accumulate(entering.begin(), entering.end(), 0.0);
    if (power > static_cast<double>(least_lost) * all) continue;
    vertices_.clear();
    return true;
  }
  sort_by_cells();
  return true;
}

template <int N>
std::uint64_t LightVertices<N>::cell_at(const Vec3f& p) const {
  std::uint64_t cell = 0;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr float most = (1 << 20) - 1;
    const float at = (p[axis] - interior_.region().low[axis]) / cell_size_ + 0.5f * most;
    cell = cell << 21 | static_cast<std::uint64_t>(std::clamp(at, 0.0f, most));
  }
  return cell;
}

template <int N>
void LightVertices<N>::sort_by_cells() {
  std::vector<std::pair<std::uint64_t, std::size_t>> order(vertices_.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = {cell_at(vertices_[i].position), i};
  std::ranges::sort(order);
  std::vector<Vertex> sorted;
  sorted.reserve(order.size());
  for (const auto& [cell, i] : order) {
    sorted.push_back(vertices_[i]);
    cells_.push_back(cell);
  }
  vertices_ = std::move(sorted);
}

template <int N>
auto LightVertices<N>::vertices_in(std::uint64_t cell) const -> std::span<const Vertex> {
  const auto range = std::ranges::equal_range(cells_, cell);
  return std::span(vertices_).subspan(static_cast<std::size_t>(range.begin() - cells_.begin()),
                                      range.size());
}

template <int N>
auto LightVertices<N>::choose(const Vec3f& from, Vec2f u) const -> std::optional<Choice> {
  const int drawn = std::min(static_cast<int>(u.x * cells_around), cells_around - 1);
  const Vec3f step{static_cast<float>(drawn % 3 - 1), static_cast<float>(drawn / 3 % 3 - 1),
                   static_cast<float>(drawn / 9 - 1)};
  const auto near = vertices_in(cell_at(from + cell_size_ * step));
  if (near.empty()) return std::nullopt;
  const auto count = static_cast<float>(near.size());
  const auto i = std::min(static_cast<std::size_t>(u.y * count), near.size() - 1);
  return Choice{near[i], 1.0f / (cells_around * count), near.size() - 1};
}

template <int N>
float LightVertices<N>::vertices_over_paths(const Way& way, std::size_t others) const {
  const Vec3f offset = way.to - way.from;
  const float distance2 = dot(offset, offset);
  const float passing = std::exp(-std::sqrt(distance2) / layers_.medium(0).longest_free_path);
  const float of_paths = way.phases * passing / std::max(distance2, 1e-20f);
  return way.density / (cells_around * static_cast<float>(others + 1) * std::max(of_paths, 1e-30f));
}

template <int N>
float LightVertices<N>::weight(const Way& way, std::size_t others) const {
  return power_heuristic(std::min(vertices_over_paths(way, others), 1e15f), 1.0f);
}

template <int N>
float LightVertices<N>::weight_of_path(const Way& way) const {
  const std::uint64_t to = cell_at(way.to), from = cell_at(way.from);
  for (int axis = 0; axis < 3; ++axis) {
    const auto coordinate = [&](std::uint64_t cell) {
      return static_cast<std::int64_t>(cell >> 21 * axis & ((1u << 21) - 1));
    };
    if (std::abs(coordinate(to) - coordinate(from)) > 1) return 1.0f;
  }
  return power_heuristic(1.0f, std::min(vertices_over_paths(way, vertices_in(to).size()), 1e15f));
}

template class LightVertices<4>;
template class LightVertices<8>;
template class LightVertices<16>;

}  // namespace lamina
