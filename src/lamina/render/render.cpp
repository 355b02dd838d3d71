// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/render.h"

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "lamina/core/error.h"
#include "lamina/core/parallel.h"
#include "lamina/render/camera_rays.h"
#include "lamina/render/film_accumulator.h"
#include "lamina/render/hierarchy_preparation.h"
#include "lamina/render/layered_material.h"
#include "lamina/render/path_tracer.h"
#include "lamina/render/profile_maker.h"
#include "lamina/render/profile_transport.h"
#include "lamina/render/random_walk.h"
#include "lamina/render/render_scene.h"
#include "lamina/render/single_scattering.h"

namespace lamina {
namespace {

constexpr int tile_size = 16;  // [pixel]

/// Treats subnormal numbers as 0 on this thread: Embree and the tails of profiles would be slow.
class FlushSubnormals {
 public:
#if defined(__SSE2__)
  FlushSubnormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
  ~FlushSubnormals() { _mm_setcsr(before_); }
#else
  FlushSubnormals() = default;
  ~FlushSubnormals() = default;
#endif
  FlushSubnormals(const FlushSubnormals&) = delete;
  FlushSubnormals& operator=(const FlushSubnormals&) = delete;

 private:
  unsigned before_ = 0;
};

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// The bands of all translucent materials, which must agree; else RGB.
BandSet common_bands(const Scene& scene) {
  const SurfaceMaterial* first = nullptr;
  BandSet bands = BandSet::rgb();
  for (const SurfaceMaterial& material : scene.materials) {
    const auto* subsurface = std::get_if<SubsurfaceSurface>(&material.surface);
    const auto* thin = std::get_if<ThinSurface>(&material.surface);
    if (!subsurface && !thin) continue;
    const BandSet& own = subsurface ? subsurface->material.bands : thin->material.bands;
    if (!first) {
      first = &material;
      bands = own;
    } else if (!(own == bands)) {
      throw InvalidInput("materials \"" + first->name + "\" and \"" + material.name +
                         "\": all translucent materials of a scene must have the same bands");
    }
  }
  if (bands.size() > 16)
    throw InvalidInput("material \"" + first->name +
                       "\": at most 16 bands can be rendered, but it has " +
                       std::to_string(bands.size()));
  return bands;
}

template <int N>
struct Transports {
  std::vector<std::unique_ptr<SubsurfaceTransport<N>>> of_material;  ///< null: not translucent
  std::vector<HierarchyTransport<N>*> hierarchies;  ///< those that are to sample light first
};

/// The one place where a method of subsurface transport is chosen.
template <int N>
Transports<N> make_transports(const RenderScene& scene, const BandConversion<N>& conversion,
                              const RenderOptions& options) {
  using Method = RenderSettings::Method;
  const auto& materials = scene.scene->materials;
  Transports<N> transports;
  transports.of_material.resize(materials.size());
  const ProfileMaker make_profile = profile_maker(scene.scene->render.profile);
  const bool is_printed = options.exit_angle == RenderOptions::ExitAngle::printed;
  if (scene.scene->render.method == Method::layered_bsdf) return transports;
  for (std::uint32_t i = 0; i < materials.size(); ++i) {
    const auto* surface = std::get_if<SubsurfaceSurface>(&materials[i].surface);
    if (!surface) continue;
    if (!surface->maps.empty())
      throw InvalidInput("material \"" + materials[i].name +
                         "\": maps are for method \"layered_bsdf\"");
    auto& transport = transports.of_material[i];
    switch (scene.scene->render.method) {
      case Method::profile:
        transport =
            std::make_unique<ProfileTransport<N>>(scene, conversion, i, make_profile, is_printed);
        break;
      case Method::hierarchy: {
        auto hierarchy =
            std::make_unique<HierarchyTransport<N>>(scene, conversion, i, make_profile, is_printed);
        transports.hierarchies.push_back(hierarchy.get());
        transport = std::move(hierarchy);
        break;
      }
      case Method::random_walk:
        transport = std::make_unique<RandomWalk<N>>(scene, conversion, i);
        break;
      default:
        throw InvalidInput(
            "render: method must be \"profile\", \"layered_bsdf\", \"hierarchy\" or "
            "\"random_walk\", the others do "
            "not "
            "exist in this version");
    }
    using SingleScattering = RenderSettings::SingleScattering;
    const auto single = scene.scene->render.single_scattering;
    if (single != SingleScattering::none && scene.scene->render.method != Method::random_walk)
      transport = std::make_unique<lamina::SingleScattering<N>>(
          scene, conversion, i, single == SingleScattering::refracted, std::move(transport));
  }
  return transports;
}

template <int N>
LayeredMaterials<N> make_layered_materials(const RenderScene& scene,
                                           const BandConversion<N>& conversion) {
  const auto& materials = scene.scene->materials;
  LayeredMaterials<N> layered(materials.size());
  if (scene.scene->render.method != RenderSettings::Method::layered_bsdf) return layered;
  for (std::size_t i = 0; i < materials.size(); ++i)
    if (std::holds_alternative<SubsurfaceSurface>(materials[i].surface))
      layered[i] =
          std::make_unique<LayeredMaterial<N>>(scene, conversion, static_cast<std::uint32_t>(i));
  return layered;
}

/// @return whether it was completed
template <int N>
bool trace_passes(const RenderScene& scene, const BandSet& bands, const RenderOptions& options,
                  const Progress& progress, FilmAccumulator& film) {
  const RenderSettings& settings = scene.scene->render;
  const int width = scene.scene->film.width, height = scene.scene->film.height;
  const BandConversion<N> conversion = make_band_conversion<N>(bands);
  const Transports<N> transports = make_transports<N>(scene, conversion, options);
  const LayeredMaterials<N> layered = make_layered_materials<N>(scene, conversion);
  const ThinSheets<N> sheets = make_thin_sheets<N>(*scene.scene);
  const PathTracer<N> tracer({scene,
                              conversion,
                              transports.of_material,
                              layered,
                              sheets,
                              {.max_bounces = settings.max_bounces,
                               .direct_light = static_cast<DirectLight>(options.direct_light)}});
  const CameraRays camera(scene.scene->camera, width, height);
  if (!prepare_hierarchies(transports.hierarchies, scene, camera, tracer, options.cache, progress))
    return false;

  const int columns = (width + tile_size - 1) / tile_size;
  const int rows = (height + tile_size - 1) / tile_size;
  const auto tiles = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  const int samples = settings.samples_per_pixel;
  std::atomic<bool> is_stopped = false;
  std::atomic<std::int64_t> finished = 0;  // samples per pixel, over all tiles
  const double all = static_cast<double>(samples) * static_cast<double>(tiles);
  for (int from = 0, to = std::min(1, samples); from < samples && !is_stopped;
       from = to, to = std::min(2 * to, samples)) {
    parallel_for(tiles, [&, from, to](std::size_t tile) {
      if (is_stopped) return;
      const FlushSubnormals flush;
      const int x0 = static_cast<int>(tile % static_cast<std::size_t>(columns)) * tile_size;
      const int y0 = static_cast<int>(tile / static_cast<std::size_t>(columns)) * tile_size;
      for (int y = y0; y < std::min(y0 + tile_size, height); ++y)
        for (int x = x0; x < std::min(x0 + tile_size, width); ++x)
          for (int i = from; i < to; ++i) {
            PixelSamples random(settings.seed, static_cast<std::uint32_t>(y * width + x),
                                static_cast<std::uint32_t>(i));
            const Ray ray = camera.make_ray(x, y, random);
            film.add(x, y, tracer.trace_camera_ray(ray, camera.pixel_angle(), random));
          }
      finished += to - from;
      if (!report(progress, static_cast<double>(finished) / all)) is_stopped = true;
    });
  }
  return !is_stopped;
}

}  // namespace

RenderResult render(const Scene& scene, const RenderOptions& options, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const double cpu_before = cpu_seconds();
  const auto require = [](bool holds, const std::string& rule, double given) {
    if (!holds) throw InvalidInput(rule + ", but is " + std::to_string(given));
  };
  require(scene.film.width >= 1 && scene.film.width <= 65536, "film: width must lie in [1, 65536]",
          scene.film.width);
  require(scene.film.height >= 1 && scene.film.height <= 65536,
          "film: height must lie in [1, 65536]", scene.film.height);
  require(scene.render.samples_per_pixel >= 1 && scene.render.samples_per_pixel <= (1 << 24),
          "render: samples_per_pixel must lie in [1, 16777216]", scene.render.samples_per_pixel);
  require(scene.render.max_bounces >= 0, "render: max_bounces must be >= 0",
          scene.render.max_bounces);
  const BandSet bands = common_bands(scene);
  const RenderScene prepared(scene);
  FilmAccumulator film(scene.film.width, scene.film.height);
  RenderResult result;
  auto& statistics = result.statistics;
  statistics.is_complete =
      bands.size() <= 4   ? trace_passes<4>(prepared, bands, options, progress, film)
      : bands.size() <= 8 ? trace_passes<8>(prepared, bands, options, progress, film)
                          : trace_passes<16>(prepared, bands, options, progress, film);
  result.image = film.image();
  statistics.samples_per_pixel = film.mean_samples();
  statistics.relative_noise = relative_noise(result.image, film.subsurface_pixels());
  statistics.cpu_seconds = cpu_seconds() - cpu_before;
  statistics.peak_memory_mib = peak_memory_mib();
  statistics.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace lamina
