// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/planning/render_cost.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lamina/render/geometry/nearest_pixel.h"
#include "lamina/render/lights/light_views.h"
#include "lamina/render/planning/internal/cpu_time.h"
#include "lamina/render/subsurface/surface_cells.h"

namespace lamina {
namespace {

// Measured on one core of a Zen 4 [CPU s], for what cannot be timed before it is prepared.
constexpr double of_cutting = 8e-6;    // a cell out of a surface, its elements included
constexpr double of_sum = 40e-6;       // the light that leaves at a sample, by hierarchy
constexpr double of_spreading = 1e-6;  // light from texel to texel, for each texel, band and term
constexpr double of_texel = 12e-6;     // cutting one, its neighbours, its skin
constexpr double of_lookup = 0.15e-6;  // a point drawn in the buffers of shadow_map
constexpr double of_lattice = 1.0;     // what is known of the light inside a body, by random_walk
/// A walk that knows what to expect takes so much of one that does not.
constexpr double share_of_informed_walk = 0.02;

/// Mean time of a sample of a pixel, all included [CPU s].
template <int N>
double seconds_per_sample(const PictureWork<N>& work) {
  const auto& film = work.scene.scene->film;
  const auto wide = static_cast<std::size_t>(film.width);
  const std::size_t pixels = wide * static_cast<std::size_t>(film.height);
  return seconds_of(1000, [&](std::size_t i) {
    const std::size_t pixel = i * 2654435761u % pixels;  // spread evenly
    const int x = static_cast<int>(pixel % wide), y = static_cast<int>(pixel / wide);
    PixelSamples random(work.scene.scene->render.seed, static_cast<std::uint32_t>(pixel), 0);
    const Ray ray = work.camera.make_ray(x, y, random);
    (void)work.tracer.trace_camera_ray(ray, work.camera.pixel_angle(), random);
  });
}

/// Of a surface that is seen [mm²], about: pixels see it at a slant.
double seen_area(const SeenSurface& seen, std::uint32_t material) {
  const auto pixel = static_cast<double>(seen.pixel_size(material) * seen.pixels_between);
  return 1.5 * static_cast<double>(seen.points[material].size()) * pixel * pixel;
}

template <int N>
double seconds_to_prepare(const PictureWork<N>& work, const HierarchyTransport<N>& hierarchy) {
  const LightSampling sampling =
      plan_sampling(hierarchy, work.scene, work.camera, work.seen, work.options);
  const auto spacing = static_cast<double>(sampling.field.spacing(0));
  const double summed = std::min(
      sampling.close_cells, 1.3 * seen_area(work.seen, hierarchy.material()) / (spacing * spacing));
  const bool is_kept = !work.options.cache.empty() && std::filesystem::exists(work.options.cache);
  const double estimates = is_kept ? 0.0 : sampling.estimates;
  return sampling.cells *
             (estimates * work.seen.seconds_per_estimate + (is_kept ? 1e-6 : of_cutting)) +
         summed * of_sum;
}

template <int N>
double seconds_to_prepare(const PictureWork<N>& work, const TextureSpaceTransport<N>& transport) {
  const Scene& scene = *work.scene.scene;
  const std::uint32_t material = transport.material();
  const auto spacing =
      static_cast<double>(transport.spacing_for(nearest_pixel(scene, work.camera, material)));
  const double area = surface_area(scene.meshes, material), texels = area / (spacing * spacing);
  const bool is_kept = !work.options.cache.empty();
  if (is_kept && std::filesystem::exists(work.options.cache)) return texels * of_texel;
  const double seen = is_kept ? 1.0 : std::min(1.0, seen_area(work.seen, material) / area);
  const int full = scene.render.texture_space.irradiance_samples;
  const double estimates = seen * full + (1.0 - seen) * std::max(1, full / 8);
  const auto& surface = std::get<SubsurfaceSurface>(scene.materials[material].surface);
  const auto bands = static_cast<double>(surface.material.bands.size());
  return texels * (of_texel + estimates * work.seen.seconds_per_estimate +
                   of_spreading * bands * (1 + scene.render.texture_space.terms));
}

template <int N>
double seconds_to_prepare(const PictureWork<N>& work) {
  // A buffer is filled by a ray to a texel; the views share the texels of one buffer per light.
  const Scene& scene = *work.scene.scene;
  const ShadowMapSettings& settings = scene.render.shadow_map;
  const double lights = std::min(static_cast<double>(scene.lights.size()), 32.0);
  const double texels = lights * settings.resolution * settings.resolution;
  return static_cast<double>(work.shadow_maps.size()) * texels * 1e-6;
}

}  // namespace

template <int N>
double expected_cpu_seconds(const PictureWork<N>& work) {
  const Scene& scene = *work.scene.scene;
  const double samples = static_cast<double>(scene.film.width) *
                         static_cast<double>(scene.film.height) * scene.render.samples_per_pixel;
  const double below = samples * static_cast<double>(work.seen.count()) /
                       static_cast<double>(std::max<std::size_t>(work.seen.rays, 1));
  const double above = samples * work.seen.seconds_per_ray;
  using Method = RenderSettings::Method;
  double total = 0.0;
  switch (scene.render.method) {
    case Method::profile:
    case Method::layered_bsdf:
    case Method::automatic:
      return samples * seconds_per_sample(work);
    case Method::hierarchy:
      for (const HierarchyTransport<N>* hierarchy : work.hierarchies)
        total += seconds_to_prepare(work, *hierarchy);
      return total + above + below * 1.5e-6;
    case Method::texture_space:
      for (const TextureSpaceTransport<N>* transport : work.texture_spaces)
        total += seconds_to_prepare(work, *transport);
      return total + above + below * 0.5e-6;
    case Method::shadow_map:
      return seconds_to_prepare(work) + above + below * scene.render.shadow_map.lookups * of_lookup;
    case Method::random_walk:
      total = samples * seconds_per_sample(work) - above;  // of walks that know nothing
      if (work.lattices > 0) total = share_of_informed_walk * total + of_lattice * work.lattices;
      return above + total;
  }
  return total;
}

template double expected_cpu_seconds(const PictureWork<4>&);
template double expected_cpu_seconds(const PictureWork<8>&);
template double expected_cpu_seconds(const PictureWork<16>&);

}  // namespace lamina
