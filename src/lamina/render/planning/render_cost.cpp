// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/planning/render_cost.h"

#include <algorithm>
#include <cstddef>

#include "lamina/base/io/cpu_time.h"

namespace lamina {
namespace {

/// Mean time of a sample of a pixel, all included [CPU s].
template <int N>
double seconds_per_sample(const Preparation<N>& with, const PathTracer<N>& tracer) {
  const Scene& scene = *with.scene.scene;
  const auto wide = static_cast<std::size_t>(scene.film.width);
  const std::size_t pixels = wide * static_cast<std::size_t>(scene.film.height);
  return seconds_of(1000, [&](std::size_t i) {
    const std::size_t pixel = i * 2654435761u % pixels;  // spread evenly
    const int x = static_cast<int>(pixel % wide), y = static_cast<int>(pixel / wide);
    PixelSamples random(with.scene.settings.seed, static_cast<std::uint32_t>(pixel), 0);
    const Ray ray = with.camera.make_ray(x, y, random);
    (void)tracer.trace_camera_ray(ray, with.camera.pixel_angle(), random);
  });
}

/// Of all materials of a picture: what is prepared adds up, the slowest lookup counts.
template <int N>
SubsurfaceCost total_cost(const SubsurfaceMethods<N>& methods, const Preparation<N>& with) {
  SubsurfaceCost total;
  for (const auto& method : methods) {
    if (!method) continue;
    const SubsurfaceCost cost = method->expected_cost(with);
    total.preparation += cost.preparation + cost.refinement;
    if (cost.lookup) total.lookup = std::max(total.lookup.value_or(0.0), *cost.lookup);
    total.prepared_fraction = std::min(total.prepared_fraction, cost.prepared_fraction);
  }
  return total;
}

}  // namespace

template <int N>
double expected_cpu_seconds(const SubsurfaceMethods<N>& methods, const Preparation<N>& with,
                            const PathTracer<N>& tracer, double share) {
  const Scene& scene = *with.scene.scene;
  const double samples = share * static_cast<double>(scene.film.width) *
                         static_cast<double>(scene.film.height) *
                         with.scene.settings.samples_per_pixel;
  const double above = samples * with.seen.seconds_per_ray;
  const SubsurfaceCost cost = total_cost(methods, with);
  if (cost.lookup) {
    const double below = samples * static_cast<double>(with.seen.count()) /
                         static_cast<double>(std::max<std::size_t>(with.seen.rays, 1));
    return cost.preparation + above + below * *cost.lookup;
  }
  const double below = samples * seconds_per_sample(with, tracer) - above;
  return cost.preparation + above + cost.prepared_fraction * below;
}

template double expected_cpu_seconds(const SubsurfaceMethods<4>&, const Preparation<4>&,
                                     const PathTracer<4>&, double);
template double expected_cpu_seconds(const SubsurfaceMethods<8>&, const Preparation<8>&,
                                     const PathTracer<8>&, double);
template double expected_cpu_seconds(const SubsurfaceMethods<16>&, const Preparation<16>&,
                                     const PathTracer<16>&, double);

}  // namespace lamina
