// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/planning/find_seen_surface.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "lamina/base/core/parallel.h"
#include "lamina/base/io/cpu_time.h"
#include "lamina/render/paths/path_tracer.h"
#include "lamina/scene/description/materials_in_use.h"

namespace lamina {
namespace {

/// Stands in for the transport of a material: keeps the points where light would leave. None does.
template <int N>
class Recorder final : public SubsurfaceMethod<N> {
 public:
  explicit Recorder(std::vector<SurfacePoint>& points) : points_(points) {}
  BandValues<N> leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& /*light*/,
                                 PixelSamples& /*samples*/) const override {
    const std::scoped_lock lock(mutex_);
    points_.push_back(exit.point);
    return {};
  }
  BandValues<N> local_reflectance(const SurfacePoint& /*point*/) const override {
    return BandValues<N>::filled(0.5f);
  }

 private:
  std::vector<SurfacePoint>& points_;
  mutable std::mutex mutex_;
};

/// A path tracer that records what it sees.
template <int N>
struct Scout {
  Scout(const RenderScene& scene, const BandConversion<N>& conversion, const ThinSheets<N>& sheets,
        const Coverings<N>& coverings, int max_bounces)
      : points(scene.scene->materials.size()),
        transports(points.size()),
        layered(points.size()),
        tracer({scene,
                conversion,
                transports,
                layered,
                sheets,
                coverings,
                {.max_bounces = max_bounces}}) {
    for (const std::uint32_t m : translucent_materials_in_use(*scene.scene))
      transports[m] = std::make_unique<Recorder<N>>(points[m]);
  }
  std::vector<std::vector<SurfacePoint>> points;
  SubsurfaceMethods<N> transports;
  LayeredMaterials<N> layered;
  PathTracer<N> tracer;
};

}  // namespace

template <int N>
SeenSurface find_seen_surface(const RenderScene& scene, const BandConversion<N>& conversion,
                              const ThinSheets<N>& sheets, const Coverings<N>& coverings,
                              const CameraRays& camera) {
  constexpr double most_rays = 5e5;
  const int width = scene.scene->film.width, height = scene.scene->film.height;
  const int step = static_cast<int>(
      std::ceil(std::sqrt(static_cast<double>(width) * static_cast<double>(height) / most_rays)));
  const auto trace = [&](const PathTracer<N>& tracer, int x, int y) {
    PixelSamples random(scene.settings.seed, static_cast<std::uint32_t>(y * width + x), 0);
    const Ray ray = camera.make_ray(x, y, random);
    (void)tracer.trace_camera_ray(ray, camera.pixel_angle(), random);
  };
  const Scout<N> scout(scene, conversion, sheets, coverings, 0);
  const int columns = (width + step - 1) / step, rows = (height + step - 1) / step;
  parallel_for(static_cast<std::size_t>(rows), [&](std::size_t row) {
    for (int column = 0; column < columns; ++column)
      trace(scout.tracer, column * step, static_cast<int>(row) * step);
  });
  const Scout<N> timed(scene, conversion, sheets, coverings, scene.settings.max_bounces);
  constexpr std::size_t few = 300;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const double seconds = seconds_of(few, [&](std::size_t i) {
    const std::size_t pixel = i * 2654435761u % pixels;  // spread evenly
    const auto wide = static_cast<std::size_t>(width);
    trace(timed.tracer, static_cast<int>(pixel % wide), static_cast<int>(pixel / wide));
  });
  std::vector<SurfacePoint> most_seen;  // of one material
  for (const auto& points : scout.points)
    if (points.size() > most_seen.size()) most_seen = points;
  const double of_estimate = seconds_of(most_seen.empty() ? 0 : few, [&](std::size_t i) {
    PixelSamples random(scene.settings.seed, static_cast<std::uint32_t>(i), 0);
    (void)timed.tracer.entering_irradiance(most_seen[i * 2654435761u % most_seen.size()], random);
  });
  return {.points = scout.points,
          .rays = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows),
          .pixels_between = static_cast<float>(step),
          .seconds_per_ray = seconds,
          .seconds_per_estimate = of_estimate};
}

#define LAMINA_INSTANTIATE(N)                                                             \
  template SeenSurface find_seen_surface<N>(const RenderScene&, const BandConversion<N>&, \
                                            const ThinSheets<N>&, const Coverings<N>&,    \
                                            const CameraRays&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
