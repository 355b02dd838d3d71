// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/hierarchy/hierarchy_preparation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lamina/core/number_text.h"
#include "lamina/core/parallel.h"
#include "lamina/render/geometry/nearest_pixel.h"
#include "lamina/render/subsurface/light_cache.h"
#include "lamina/render/subsurface/surface_cells.h"

namespace lamina {
namespace {

/// How many times as far apart as asked for samples are at first where they are refined.
constexpr float first_spacing = 4.0f;

/// Points spread evenly over a material, where samples of different density are compared.
std::vector<SurfacePoint> make_probes(const Scene& scene, std::uint32_t material) {
  constexpr double wanted = 500.0;
  const auto spacing = static_cast<float>(std::sqrt(surface_area(scene.meshes, material) / wanted));
  const SurfaceCells surface =
      make_surface_cells(scene.meshes, material, spacing, scene.render.seed);
  std::vector<SurfacePoint> probes;
  for (const SurfaceCell& cell : surface.cells) {
    const SurfaceElement& e = surface.elements_of(cell).front();
    probes.push_back(make_surface_point(
        scene.meshes,
        {.distance = 0.0f, .u = e.u, .v = e.v, .mesh = e.mesh, .triangle = e.triangle}, 0.0f));
  }
  return probes;
}

template <int N>
std::vector<BandValues<N>> exitance_at(const HierarchyTransport<N>& hierarchy,
                                       const std::vector<SurfacePoint>& probes) {
  std::vector<BandValues<N>> exitance(probes.size());
  parallel_for(probes.size(), [&](std::size_t i) { exitance[i] = hierarchy.exitance(probes[i]); });
  return exitance;
}

/// Root mean square of the difference over that of the light, in the band where it is most.
template <int N>
double change_between(const std::vector<BandValues<N>>& before,
                      const std::vector<BandValues<N>>& after) {
  double most = 0.0;
  for (int b = 0; b < N; ++b) {
    double changed = 0.0, total = 0.0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      const double now = static_cast<double>(after[i][b]);
      const double difference = now - static_cast<double>(before[i][b]);
      changed += difference * difference;
      total += now * now;
    }
    if (total > 0.0) most = std::max(most, std::sqrt(changed / total));
  }
  return most;
}

/// Samples of the light, in use when it returns: nothing if progress asked to stop.
template <int N>
std::optional<IrradianceCloud> sampled_light(HierarchyTransport<N>& hierarchy, const Scene& scene,
                                             const LightGatherer<N>& light,
                                             const LightSampling& sampling,
                                             const Progress& progress, LightSamples& done) {
  const double refine = static_cast<double>(scene.render.hierarchy.refine);
  const float closest = hierarchy.closest_spacing(), spacing = sampling.field.spacing(0);
  std::vector<SurfacePoint> probes;
  if (refine > 0.0) probes = make_probes(scene, hierarchy.material());
  std::vector<BandValues<N>> before;
  for (float at = refine > 0.0 ? first_spacing * spacing : spacing;;
       at = std::max(0.5f * at, closest)) {
    auto cloud = hierarchy.sample_light(light, refine > 0.0 ? SpacingField(at) : sampling.field,
                                        sampling.estimates, scene.render.seed, progress);
    if (!cloud) return std::nullopt;
    hierarchy.use(*cloud);
    done.spacing = static_cast<double>(at);
    done.count = cloud->points.size();
    if (!(refine > 0.0)) return cloud;
    auto exitance = exitance_at(hierarchy, probes);
    if (!before.empty()) done.change = change_between(before, exitance);
    if ((done.change && *done.change <= refine) || at <= closest) return cloud;
    before = std::move(exitance);
  }
}

double sum(const std::vector<double>& counts) {
  return std::accumulate(counts.begin(), counts.end(), 0.0);
}

}  // namespace

template <int N>
LightSampling plan_sampling(const HierarchyTransport<N>& hierarchy, const RenderScene& scene,
                            const CameraRays& camera, const SeenSurface& seen,
                            const RenderOptions& options) {
  const auto& [method, orders, factors, single_scattering, profile, samples_per_pixel, noise,
               max_bounces, seed, settings, texture_space, shadow_map] = scene.scene->render;
  constexpr int most_estimates = 32, least_estimates = 4;
  const std::uint32_t material = hierarchy.material();
  const float nearest = nearest_pixel(*scene.scene, camera, material);
  const bool is_kept = !options.cache.empty();
  LightSampling sampling{.field = SpacingField(1.0f), .estimates = most_estimates};
  std::vector<double> counts;
  if (is_kept || settings.spacing > 0.0f || settings.refine > 0.0f) {
    // What is kept serves cameras that come closer, too.
    sampling.field = SpacingField(std::max(hierarchy.spacing_for((is_kept ? 0.5f : 1.0f) * nearest),
                                           hierarchy.closest_spacing()));
    counts = expected_cells(scene.scene->meshes, material, sampling.field);
  } else {
    std::vector<Vec3f> places;
    for (const SurfacePoint& point : seen.points[material]) places.push_back(point.position);
    const float pixel = places.empty() ? nearest : seen.pixel_size(material);
    float spacing = hierarchy.spacing_for(pixel);
    do {
      sampling.field = SpacingField(places, spacing, 2.0f * seen.pixels_between * pixel);
      counts = expected_cells(scene.scene->meshes, material, sampling.field);
      spacing *= 1.2f;
    } while (sum(counts) > settings.max_points);
    // Twice as many paths to a pixel as it has samples, as far as that many are of use.
    const float wide = sampling.field.spacing(0) / pixel;
    const float wanted = 2.0f * static_cast<float>(samples_per_pixel) * wide * wide;
    if (!(noise > 0.0f))
      sampling.estimates =
          static_cast<int>(std::clamp(wanted, float{least_estimates}, float{most_estimates}));
  }
  if (settings.irradiance_samples > 0) sampling.estimates = settings.irradiance_samples;
  sampling.cells = sum(counts);
  sampling.close_cells = counts.front();
  return sampling;
}

template <int N>
bool prepare_hierarchies(const std::vector<HierarchyTransport<N>*>& hierarchies,
                         const RenderScene& scene, const CameraRays& camera,
                         const SeenSurface& seen, const LightGatherer<N>& light,
                         const RenderOptions& options, const Progress& progress,
                         std::vector<LightSamples>& sampled) {
  if (hierarchies.empty()) return true;
  const auto spacing_of = [&](const HierarchyTransport<N>& hierarchy) {
    return std::max(
        hierarchy.spacing_for(nearest_pixel(*scene.scene, camera, hierarchy.material())),
        hierarchy.closest_spacing());
  };
  const auto misfit = [&](const std::vector<IrradianceCloud>& clouds) -> std::string {
    for (const HierarchyTransport<N>* hierarchy : hierarchies) {
      const IrradianceCloud* cloud = cloud_of(clouds, hierarchy->material());
      if (!cloud || cloud->bands > N || cloud->irradiance.empty())
        return "lacks a material of the scene";
      const float wanted = spacing_of(*hierarchy);
      if (!(scene.scene->render.hierarchy.refine > 0.0f) && cloud->spacing > 1.001f * wanted)
        return "its samples are " + number_text(cloud->spacing) +
               " mm apart, but this camera sees light as fine as " + number_text(wanted) + " mm";
    }
    return {};
  };
  if (const auto kept = find_kept_light(*scene.scene, options, misfit)) {
    for (HierarchyTransport<N>* hierarchy : hierarchies) {
      const IrradianceCloud& found = *cloud_of(*kept, hierarchy->material());
      hierarchy->use(found);
      sampled.push_back({.material = hierarchy->material(),
                         .spacing = static_cast<double>(found.spacing),
                         .count = found.points.size(),
                         .change = {}});
    }
    return true;
  }
  std::vector<IrradianceCloud> clouds;
  for (HierarchyTransport<N>* hierarchy : hierarchies) {
    auto& done = sampled.emplace_back(LightSamples{.material = hierarchy->material()});
    auto cloud =
        sampled_light(*hierarchy, *scene.scene, light,
                      plan_sampling(*hierarchy, scene, camera, seen, options), progress, done);
    if (!cloud) return false;
    clouds.push_back(*std::move(cloud));
  }
  keep_light(*scene.scene, options, clouds);
  return true;
}

#define LAMINA_INSTANTIATE(N)                                                                     \
  template LightSampling plan_sampling<N>(const HierarchyTransport<N>&, const RenderScene&,       \
                                          const CameraRays&, const SeenSurface&,                  \
                                          const RenderOptions&);                                  \
  template bool prepare_hierarchies<N>(const std::vector<HierarchyTransport<N>*>&,                \
                                       const RenderScene&, const CameraRays&, const SeenSurface&, \
                                       const LightGatherer<N>&, const RenderOptions&,             \
                                       const Progress&, std::vector<LightSamples>&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
