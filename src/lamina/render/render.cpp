// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/render.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/image/compare.h"
#include "lamina/render/film/film_accumulator.h"
#include "lamina/render/film/scene_fingerprint.h"
#include "lamina/render/film/tile_passes.h"
#include "lamina/render/geometry/camera_rays.h"
#include "lamina/render/paths/path_tracer.h"
#include "lamina/render/planning/find_seen_surface.h"
#include "lamina/render/planning/method_choice.h"
#include "lamina/render/planning/render_cost.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/colored_transport.h"
#include "lamina/render/subsurface/hierarchy/hierarchy_transport.h"
#include "lamina/render/subsurface/layered_bsdf/layered_material.h"
#include "lamina/render/subsurface/preparation.h"
#include "lamina/render/subsurface/profiles/material_profiles.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/render/subsurface/random_walk/random_walk.h"
#include "lamina/render/subsurface/seen_surface.h"
#include "lamina/render/subsurface/shadow_map/shadow_map_transport.h"
#include "lamina/render/subsurface/single_scattering/single_scattering.h"
#include "lamina/render/subsurface/texture_space/texture_space_transport.h"
#include "lamina/scene/common_bands.h"
#include "lamina/scene/method_settings.h"
#include "lamina/scene/skin_layer_maps.h"

namespace lamina {
namespace {

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
                         "\": all translucent materials of a scene must have the same bands; "
                         "make_bands_common() sees to it");
    }
  }
  if (bands.size() > 16)
    throw InvalidInput("material \"" + first->name +
                       "\": at most 16 bands can be rendered, but it has " +
                       std::to_string(bands.size()));
  return bands;
}

/// @throws InvalidInput if light scattered once would count twice.
void require_light_once(const RenderSettings& settings) {
  using Method = RenderSettings::Method;
  const bool uses_profile = settings.method == Method::profile ||
                            settings.method == Method::hierarchy ||
                            settings.method == Method::shadow_map;
  if (uses_profile && settings.profile == RenderSettings::Profile::exact &&
      settings.single_scattering != RenderSettings::SingleScattering::none)
    throw InvalidInput(
        "render: profile \"exact\" holds the light scattered once, so single_scattering must be "
        "\"none\", but is \"" +
        std::string(settings.single_scattering == RenderSettings::SingleScattering::straight
                        ? "straight"
                        : "refracted") +
        "\"");
}

/// The one place where a method of subsurface transport is chosen.
template <int N>
SubsurfaceMethods<N> make_subsurface_methods(const RenderScene& scene,
                                             const BandConversion<N>& conversion,
                                             const RenderOptions& options,
                                             const Progress& progress) {
  using Method = RenderSettings::Method;
  require_light_once(scene.scene->render);
  const auto& materials = scene.scene->materials;
  SubsurfaceMethods<N> methods(materials.size());
  const ProfileMaker make_profile = profile_maker(scene.scene->render, of_unknown_length(progress));
  const bool is_printed = options.exit_angle == RenderOptions::ExitAngle::printed;
  if (scene.scene->render.method == Method::layered_bsdf) return methods;
  std::shared_ptr<WalkMedia<N>> media;  // of all random walks
  for (std::uint32_t i = 0; i < materials.size(); ++i) {
    const auto* surface = std::get_if<SubsurfaceSurface>(&materials[i].surface);
    if (!surface) continue;
    auto& method = methods[i];
    switch (scene.scene->render.method) {
      case Method::profile:
        method =
            std::make_unique<ProfileTransport<N>>(scene, conversion, i, make_profile, is_printed);
        break;
      case Method::hierarchy:
        method =
            std::make_unique<HierarchyTransport<N>>(scene, conversion, i, make_profile, is_printed);
        break;
      case Method::shadow_map:
        method =
            std::make_unique<ShadowMapTransport<N>>(scene, conversion, i, make_profile, is_printed);
        break;
      case Method::texture_space:
        method = std::make_unique<TextureSpaceTransport<N>>(scene, i, is_printed);
        break;
      case Method::random_walk:
        if (!media) media = make_walk_media<N>(scene, conversion);
        method = std::make_unique<RandomWalk<N>>(media, i);
        break;
      case Method::layered_bsdf:
      case Method::automatic:
        break;  // has no transport between points; is one of the others by now
    }
    if (scene.scene->render.method == Method::random_walk &&
        surface->color_use != SubsurfaceSurface::ColorUse::none)
      method = std::make_unique<ColoredTransport<N>>(scene, conversion, i, std::move(method));
    using SingleScattering = RenderSettings::SingleScattering;
    const auto single = scene.scene->render.single_scattering;
    if (single != SingleScattering::none)
      method = std::make_unique<lamina::SingleScattering<N>>(
          scene, conversion, i, single == SingleScattering::refracted, std::move(method));
  }
  return methods;
}

/// Makes all methods ready. @return  false if progress asked to stop
template <int N>
bool prepare(const SubsurfaceMethods<N>& methods, const Preparation<N>& with) {
  for (const auto& method : methods)
    if (method) method->prepare_reflectance(with);
  for (const auto& method : methods)
    if (method && !method->prepare(with)) return false;
  with.cache.save();
  return true;
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

/// The method, in place of one that the scene leaves open.
template <int N>
void choose(RenderScene& scene, const BandConversion<N>& conversion, const CameraRays& camera,
            const SeenSurface& seen, const RenderOptions& options, const Progress& progress,
            Scene& chosen, RenderStatistics& statistics) {
  if (scene.scene->render.method == RenderSettings::Method::automatic) {
    const MethodChoice choice =
        choose_method<N>(scene, conversion, camera, seen, options, of_unknown_length(progress));
    chosen = *scene.scene;
    chosen.render.method = choice.method;
    require_honoured(chosen);
    scene.scene = &chosen;
    statistics.why_method = choice.why;
  }
  statistics.method = scene.scene->render.method;
}

/// "method profile, as hierarchy would take 5 times its work: about 12 CPU-s".
std::string describe(const RenderStatistics& statistics, bool may_end_early) {
  const double expected = statistics.expected_cpu_seconds;
  const std::string seconds = printf_text("%.*f",
                                          expected < 0.95  ? 2
                                          : expected < 9.5 ? 1
                                                           : 0,
                                          expected);
  return "method " + name_of(statistics.method) +
         (statistics.why_method.empty() ? "" : " (" + statistics.why_method + ")") +
         (may_end_early ? ": at most about " : ": about ") + seconds + " CPU-s";
}

/// @param cpu_before  time before all that was done for the picture [CPU s]
/// @return            whether it was completed
template <int N>
bool trace_passes(RenderScene& scene, const BandSet& bands, const RenderOptions& options,
                  const Progress& progress, double cpu_before, FilmAccumulator& film,
                  RenderStatistics& statistics) {
  const int width = scene.scene->film.width, height = scene.scene->film.height;
  const BandConversion<N> conversion =
      make_band_conversion<N>(bands, weights_of_bands(*scene.scene, bands));
  const ThinSheets<N> sheets = make_thin_sheets<N>(*scene.scene);
  const CameraRays camera(scene.scene->camera, width, height);
  const SeenSurface seen = find_seen_surface<N>(scene, conversion, sheets, camera);
  Scene chosen;
  choose<N>(scene, conversion, camera, seen, options, progress, chosen, statistics);
  const RenderSettings& settings = scene.scene->render;
  const SubsurfaceMethods<N> methods =
      make_subsurface_methods<N>(scene, conversion, options, progress);
  const LayeredMaterials<N> layered = make_layered_materials<N>(scene, conversion);
  const PathTracer<N> tracer({scene,
                              conversion,
                              methods,
                              layered,
                              sheets,
                              {.max_bounces = settings.max_bounces,
                               .direct_light = static_cast<DirectLight>(options.direct_light)}});
  LightCache cache(*scene.scene, options);
  PreparationReport report;
  const Preparation<N> preparation{scene, tracer, camera, seen, cache, progress, report};
  statistics.expected_cpu_seconds =
      cpu_seconds() - cpu_before + expected_cpu_seconds<N>(methods, preparation, tracer);
  if (options.on_notice) options.on_notice(describe(statistics, settings.noise > 0.0f));
  const bool is_prepared = prepare(methods, preparation);
  statistics.light_samples = report.light_samples;
  statistics.warnings = report.warnings;
  if (!is_prepared) return false;

  const auto sample = [&](int x, int y, int i) {
    PixelSamples random(settings.seed, static_cast<std::uint32_t>(y * width + x),
                        static_cast<std::uint32_t>(i));
    const Ray ray = camera.make_ray(x, y, random);
    return tracer.trace_camera_ray(ray, camera.pixel_angle(), random);
  };
  return add_tile_passes(sample,
                         {.samples = settings.samples_per_pixel,
                          .noise = settings.noise,
                          .checkpoint = options.checkpoint,
                          .key = picture_key(*scene.scene, options),
                          .resumes = options.resumes},
                         progress, film);
}

}  // namespace

RenderResult render(const Scene& scene, const RenderOptions& options, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const double cpu_before = cpu_seconds();
  const auto require = [](bool holds, const std::string& rule, double given) {
    if (!holds) throw InvalidInput(rule + ", but is " + number_text(given));
  };
  require(scene.film.width >= 1 && scene.film.width <= 65536, "film: width must lie in [1, 65536]",
          scene.film.width);
  require(scene.film.height >= 1 && scene.film.height <= 65536,
          "film: height must lie in [1, 65536]", scene.film.height);
  require(scene.render.samples_per_pixel >= 1 && scene.render.samples_per_pixel <= (1 << 24),
          "render: samples_per_pixel must lie in [1, 16777216]", scene.render.samples_per_pixel);
  require(scene.render.max_bounces >= 0, "render: max_bounces must be >= 0",
          scene.render.max_bounces);
  require(scene.render.noise >= 0.0f && scene.render.noise <= 1.0f,
          "render: noise must lie in [0, 1]", static_cast<double>(scene.render.noise));
  require_honoured(scene);
  const BandSet bands = common_bands(scene);
  const std::optional<Scene> with_layer_maps = with_skin_maps_as_layer_maps(scene);
  RenderScene prepared(with_layer_maps ? *with_layer_maps : scene);
  FilmAccumulator film(scene.film.width, scene.film.height);
  RenderResult result;
  auto& statistics = result.statistics;
  statistics.is_complete =
      (bands.size() <= 4 ? trace_passes<4>
       : bands.size() <= 8
           ? trace_passes<8>
           : trace_passes<16>)(prepared, bands, options, progress, cpu_before, film, statistics);
  if (film.least_samples() == 0) throw Interrupted();  // no picture yet
  result.image = film.image();
  statistics.samples_per_pixel = film.mean_samples();
  statistics.relative_noise = relative_noise(result.image, film.measured_pixels());
  statistics.cpu_seconds = cpu_seconds() - cpu_before;
  statistics.peak_memory_mib = peak_memory_mib();
  statistics.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace lamina
