// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/render/geometry/nearest_pixel.h"
#include "lamina/render/subsurface/hierarchy/hierarchy_transport.h"
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

// Measured on one core of a Zen 4 [CPU s], for what cannot be timed before it is prepared.
constexpr double seconds_per_cell = 8e-6;  // cut out of a surface, its elements included
constexpr double seconds_per_kept_cell = 1e-6;
constexpr double seconds_per_sum = 40e-6;   // the light that leaves at a sample
constexpr double seconds_per_fit = 1.5e-6;  // between them

double sum(const std::vector<double>& counts) {
  return std::accumulate(counts.begin(), counts.end(), 0.0);
}

}  // namespace

template <int N>
std::vector<BandValues<N>> HierarchyTransport<N>::exitance_at(
    const std::vector<SurfacePoint>& points) const {
  std::vector<Bands> values(points.size());
  parallel_for(points.size(), [&](std::size_t i) { values[i] = exitance(points[i]); });
  return values;
}

template <int N>
std::optional<IrradianceCloud> HierarchyTransport<N>::sample_and_use(const Preparation<N>& with,
                                                                     const LightSampling& sampling,
                                                                     LightSamples& done) {
  const Scene& scene = *scene_.scene;
  const double refine = static_cast<double>(scene_.settings.hierarchy.refine);
  const float closest = closest_spacing(), spacing = sampling.field.spacing(0);
  std::vector<SurfacePoint> probes;
  if (refine > 0.0) probes = make_probes(scene, material_);
  std::vector<Bands> before;
  for (float at = refine > 0.0 ? first_spacing * spacing : spacing;;
       at = std::max(0.5f * at, closest)) {
    auto cloud = sample_light(with.light, refine > 0.0 ? SpacingField(at) : sampling.field,
                              sampling.estimates, scene_.settings.seed, with.progress);
    if (!cloud) return std::nullopt;
    use(*cloud);
    done.spacing = static_cast<double>(at);
    done.count = cloud->points.size();
    if (!(refine > 0.0)) return cloud;
    auto exitance = exitance_at(probes);
    if (!before.empty()) done.change = change_between(before, exitance);
    if ((done.change && *done.change <= refine) || at <= closest) return cloud;
    before = std::move(exitance);
  }
}

template <int N>
LightSampling HierarchyTransport<N>::plan_sampling(const CameraRays& camera,
                                                   const SeenSurface& seen, bool is_kept) const {
  const auto& meshes = scene_.scene->meshes;
  const RenderSettings& render = scene_.settings;
  const HierarchySettings& settings = render.hierarchy;
  constexpr int most_estimates = 32, least_estimates = 4;
  constexpr double cells_of_unseen = 2000.0;  // that no ray of the camera meets
  const float nearest = nearest_pixel(*scene_.scene, camera, material_);
  LightSampling sampling{.field = SpacingField(1.0f), .estimates = most_estimates};
  std::vector<double> counts;
  if (is_kept || settings.spacing > 0.0f || settings.refine > 0.0f) {
    // What is kept serves cameras that come closer, too.
    sampling.field =
        SpacingField(std::max(spacing_for((is_kept ? 0.5f : 1.0f) * nearest), closest_spacing()));
    counts = expected_cells(meshes, material_, sampling.field);
  } else {
    std::vector<Vec3f> places;
    for (const SurfacePoint& point : seen.points[material_]) places.push_back(point.position);
    const float pixel = places.empty() ? nearest : seen.pixel_size(material_);
    float spacing = spacing_for(pixel);
    if (places.empty())
      spacing = std::max(spacing, static_cast<float>(std::sqrt(surface_area(meshes, material_) /
                                                               cells_of_unseen)));
    do {
      sampling.field = SpacingField(places, spacing, 2.0f * seen.pixels_between * pixel);
      counts = expected_cells(meshes, material_, sampling.field);
      spacing *= 1.2f;
    } while (sum(counts) > settings.max_points);
    // Twice as many paths to a pixel as it has samples, as far as that many are of use.
    const float wide = sampling.field.spacing(0) / pixel;
    const float wanted = 2.0f * static_cast<float>(render.samples_per_pixel) * wide * wide;
    if (!(render.noise > 0.0f))
      sampling.estimates =
          static_cast<int>(std::clamp(wanted, float{least_estimates}, float{most_estimates}));
  }
  if (settings.irradiance_samples > 0) sampling.estimates = settings.irradiance_samples;
  sampling.cells = sum(counts);
  sampling.close_cells = counts.front();
  return sampling;
}

template <int N>
bool HierarchyTransport<N>::prepare(const Preparation<N>& with) {
  const auto misfit = [&](const IrradianceCloud& cloud) -> CloudMisfit {
    if (cloud.bands != surface_.material.bands.size() || cloud.irradiance.empty())
      return {.lacks = "lacks a material of the scene", .too_coarse = {}};
    const float nearest = nearest_pixel(*scene_.scene, with.camera, material_);
    const float wanted = std::max(spacing_for(nearest), closest_spacing());
    if (!(scene_.settings.hierarchy.refine > 0.0f) && cloud.spacing > 1.001f * wanted)
      return {.lacks = {},
              .too_coarse = "its samples are " + number_text(cloud.spacing) +
                            " mm apart, but this camera sees light as fine as " +
                            number_text(wanted) + " mm"};
    return {};
  };
  LightSamples done{.material = material_};
  const auto is_completed = [&] {
    if (const IrradianceCloud* kept = with.cache.find(material_, misfit)) {
      use(*kept);
      done.spacing = static_cast<double>(kept->spacing);
      done.count = kept->points.size();
      return true;
    }
    const LightSampling sampling = plan_sampling(with.camera, with.seen, with.cache.is_wanted());
    done.estimates = sampling.estimates;
    if (KeptParts* kept = scene_.kept; kept && !with.cache.is_wanted()) {
      bool is_made = false;
      const auto light = kept->get<IrradianceCloud>(
          KeptPart::entering_light, material_, 0,
          [&] {
            auto cloud = sample_and_use(with, sampling, done);
            if (!cloud) throw Interrupted();
            is_made = true;
            return std::make_shared<const IrradianceCloud>(*std::move(cloud));
          },
          [](const IrradianceCloud&) { return true; });
      if (is_made) return true;
      use(*light.part);
      done.spacing = static_cast<double>(light.part->spacing);
      done.count = light.part->points.size();
      return true;
    }
    auto cloud = sample_and_use(with, sampling, done);
    if (!cloud) return false;
    with.cache.add(*std::move(cloud));
    return true;
  }();
  with.report.light_samples.push_back(done);
  return is_completed;
}

template <int N>
SubsurfaceCost HierarchyTransport<N>::expected_cost(const Preparation<N>& with) const {
  const LightSampling sampling = plan_sampling(with.camera, with.seen, with.cache.is_wanted());
  const auto spacing = static_cast<double>(sampling.field.spacing(0));
  const double summed =
      std::min(sampling.close_cells, 1.3 * with.seen.area(material_) / (spacing * spacing));
  const double per_cell =
      with.cache.is_there()
          ? seconds_per_kept_cell
          : seconds_per_cell + sampling.estimates * with.seen.seconds_per_estimate;
  return {.preparation = sampling.cells * per_cell + summed * seconds_per_sum,
          .lookup = seconds_per_fit};
}

#define LAMINA_INSTANTIATE(N)                                                                  \
  template std::vector<BandValues<N>> HierarchyTransport<N>::exitance_at(                      \
      const std::vector<SurfacePoint>&) const;                                                 \
  template std::optional<IrradianceCloud> HierarchyTransport<N>::sample_and_use(               \
      const Preparation<N>&, const LightSampling&, LightSamples&);                             \
  template LightSampling HierarchyTransport<N>::plan_sampling(const CameraRays&,               \
                                                              const SeenSurface&, bool) const; \
  template bool HierarchyTransport<N>::prepare(const Preparation<N>&);                         \
  template SubsurfaceCost HierarchyTransport<N>::expected_cost(const Preparation<N>&) const
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
