// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/random_walk.h"

#include <algorithm>
#include <atomic>
#include <numbers>
#include <string>
#include <utility>
#include <variant>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/render/geometry/hemisphere.h"
#include "lamina/render/subsurface/random_walk/internal/walker.h"
#include "lamina/render/subsurface/random_walk/walk_refusal.h"
#include "lamina/render/subsurface/surface_points.h"

namespace lamina {
namespace {

// Walks that learn what light there is by depth, in each of two rounds: the second knows what the
// first one found. In as many chunks. Noise over time: benchmarks/subsurface_methods.
constexpr std::size_t learning_walks = 4096, chunks = 64;
constexpr std::uint32_t walks = 4;  // from where a ray of the eye enters
// Radiance over that of the scene below which noise does not matter.
constexpr float least_reference = 5e-4f;

/// @throws InvalidInput if a mesh of the material has another medium, too
void require_one_medium(const Scene& scene, const NestedDielectrics& bodies,
                        std::uint32_t material) {
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
    if (std::ranges::find(scene.meshes[m].material, material) != scene.meshes[m].material.end() &&
        bodies.material_of(m) != material)
      throw InvalidInput("mesh \"" + scene.meshes[m].name + "\": random_walk takes one medium " +
                         "inside a mesh, but this one has \"" + scene.materials[material].name +
                         "\" and \"" + scene.materials[bodies.material_of(m)].name +
                         "\"; split it");
}

/// @throws InvalidInput for lights that no path finds through layers
template <int N>
void require_lights_with_area(const Scene& scene, const BodyMedium<N>& medium,
                              std::uint32_t material) {
  if (medium.is_rough) return;  // which sends their light in all directions
  const WalkLayers<N>& layers = medium.layers;
  if (has_lights_without_area(scene) && !layers.sees_out(layers.by_depth().count() - 1))
    throw InvalidInput(
        "material \"" + scene.materials[material].name +
        "\": random_walk does not find point, spot and distant lights through layers of "
        "different ior; use rectangles, one ior or a rough surface");
}

}  // namespace

template <int N>
std::shared_ptr<WalkMedia<N>> make_walk_media(const RenderScene& scene,
                                              const BandConversion<N>& conversion, bool are_quiet) {
  return std::make_shared<WalkMedia<N>>(scene, conversion, are_quiet);
}

template <int N>
RandomWalk<N>::RandomWalk(std::shared_ptr<WalkMedia<N>> media, std::uint32_t material)
    : media_(std::move(media)),
      material_(material),
      medium_(media_->of_material(material)),
      least_reference_(least_reference * std::max(media_->scene().lights.typical_irradiance() /
                                                      std::numbers::pi_v<float>,
                                                  1e-30f)) {
  const Scene& scene = *media_->scene().scene;
  if (const auto why = walk_refusal(scene, material)) throw InvalidInput(*why);
  if (medium_->is_homogeneous) return;
  require_one_medium(scene, media_->bodies(), material);
  require_lights_with_area(scene, *medium_, material);
}

template <int N>
bool RandomWalk<N>::prepare(const Preparation<N>& with) {
  // What is kept serves other cameras, which see other places.
  const auto& seen = with.seen.points[material_];
  const bool is_for_camera = !with.cache.is_wanted() && !seen.empty();
  if (is_for_camera) medium_->narrow_to(seen);
  if (!solve_radiance_field(with.light, with.progress) ||
      !trace_light_vertices(with.light, with.progress))
    return false;
  if (!medium_->depth_radiance) return true;
  const auto points = is_for_camera ? some_of(seen, learning_walks)
                                    : points_all_over(*with.scene.scene, material_, learning_walks);
  return learn_depth_radiance(points, with.light, with.progress);
}

template <int N>
SubsurfaceCost RandomWalk<N>::expected_cost(const Preparation<N>& /*with*/) const {
  // A second to solve the radiance field; then a path takes so much of one without it. Measured on
  // one core of a Zen 4.
  if (medium_->field) return {.preparation = 1.0, .lookup = {}, .prepared_fraction = 0.02};
  return {};
}

template <int N>
bool RandomWalk<N>::solve_radiance_field(const LightGatherer<N>& light, const Progress& progress,
                                         float scale) {
  if (!medium_->field) return true;
  if (!medium_->field->solve(light, progress)) return false;
  if (scale != 1.0f) medium_->field->scale(scale);
  return true;
}

template <int N>
bool RandomWalk<N>::trace_light_vertices(const LightGatherer<N>& light, const Progress& progress) {
  return !medium_->light_vertices || medium_->light_vertices->trace(light, progress);
}

template <int N>
bool RandomWalk<N>::learn_depth_radiance(std::span<const SurfacePoint> points,
                                         const LightGatherer<N>& light, const Progress& progress,
                                         float scale) {
  DepthRadiance<N>* learner = medium_->depth_radiance.get();
  if (!learner || points.empty()) return true;
  const RenderScene& scene = media_->scene();
  std::vector<typename DepthRadiance<N>::Lessons> lessons;
  for (std::size_t round = 0; round < 2; ++round) {
    lessons.assign(chunks, learner->make_lessons());
    const auto walk = [&](std::size_t i) {
      PixelSamples samples(scene.settings.seed + 0x51ed270bu, static_cast<std::uint32_t>(i),
                           static_cast<std::uint32_t>(round));
      const SurfacePoint& point = points[i * points.size() / learning_walks];
      const Vec3f direction =
          make_frame(point.smooth_normal).to_world(sample_cosine_hemisphere(samples.next_2d()));
      const float cosine = dot(direction, point.smooth_normal);
      if (!(cosine > 0.0f && dot(direction, point.geometric_normal) > 0.0f)) return;
      const SurfaceBoundary boundary = boundary_at(scene, point);
      const auto entry =
          media_->sample_entry({point, boundary, cosine, direction}, material_, samples);
      if (!entry) return;
      const WalkPath<N> path{.ray = {leave_surface(point, entry->inward), entry->inward},
                             .throughput = Bands::filled(1.0f)};
      WalkRecord<N> record;
      Walker<N> walker(*media_, entry->place, path, light, samples, least_reference_);
      walker.record_to(record);
      learner->add(record, walker.trace(false), light, lessons[i * chunks / learning_walks]);
    };
    std::atomic<bool> is_stopped = false;
    parallel_for(chunks, [&](std::size_t c) {
      for (std::size_t i = c * learning_walks / chunks; i < (c + 1) * learning_walks / chunks;
           ++i) {
        if (!is_stopped && !report_progress(progress, 0.0)) is_stopped = true;
        if (is_stopped) return;
        walk(i);
      }
    });
    if (is_stopped) return false;
    for (std::size_t c = 1; c < chunks; ++c) lessons[0].add(lessons[c]);
    learner->learn(lessons[0]);
  }
  if (scale != 1.0f) learner->scale(scale);
  return true;
}

template <int N>
BandValues<N> RandomWalk<N>::radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                      PixelSamples& samples, bool with_unscattered) const {
  const float transmitted = 1.0f - reflectance(exit.boundary, exit.cos_o);
  Bands radiance;
  for (std::uint32_t i = 0; i < walks; ++i) {
    PixelSamples own = samples.branch(i, walks);
    const auto entry = media_->sample_entry(exit, material_, own);
    if (!entry) continue;
    const WalkPath<N> path{.ray = {leave_surface(exit.point, entry->inward), entry->inward},
                           .throughput = Bands::filled(transmitted)};
    radiance += Walker<N>(*media_, entry->place, path, light, own, least_reference_)
                    .trace(with_unscattered);
  }
  return (1.0f / static_cast<float>(walks)) * radiance;
}

template <int N>
BandValues<N> RandomWalk<N>::local_reflectance(const SurfacePoint& /*point*/) const {
  return medium_->layers.diffuse_reflectance();
}

#define LAMINA_INSTANTIATE(N)                                                             \
  template std::shared_ptr<WalkMedia<N>> make_walk_media(const RenderScene&,              \
                                                         const BandConversion<N>&, bool); \
  template class RandomWalk<N>
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
