// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/hierarchy/hierarchy_transport.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/float_pi.h"
#include "lamina/base/core/parallel_chunks.h"
#include "lamina/render/subsurface/leaving_fraction.h"
#include "lamina/render/subsurface/surface_cells.h"

namespace lamina {
namespace {

using ColorUse = SubsurfaceSurface::ColorUse;

/// Samples to the radius that holds half of the light of the narrowest band.
constexpr float samples_per_half_radius = 3.0f;

/// Standard deviation of the Gaussian that stands for one sample, over the spacing of samples.
/// Wider, it blurs; narrower, samples show.
constexpr float blur_of_spacing = 0.6f;

/// Distance up to which samples are fitted for what lies between them, over their spacing.
constexpr float radius_of_fit = 1.9f;

/// The width of a profile's middle over its smallest half-light radius.
constexpr float middle_of_profile = 0.6f;

/// Areas that make the sum of samples, each convolved with a Gaussian, 1 at each of them: points
/// are not spaced as evenly as a lattice, and a narrow profile would show by how much. Where the
/// surface ends or turns the sum is smaller in truth, and left so, as it is beside samples further
/// apart.
///
/// @param wide  those of the samples that are further apart
std::vector<float> balanced_areas(std::span<const CloudPoint> points, const PointGrid& grid,
                                  const PointGrid& wide, float blur) {
  std::vector<float> areas, sums(points.size()), wanted(points.size(), 1.0f);
  for (const CloudPoint& point : points) areas.push_back(point.area);
  constexpr int rounds = 4;
  constexpr std::size_t chunk = 1024;
  for (int round = 0; round < rounds; ++round) {
    parallel_chunks(points.size(), chunk, [&](std::size_t i) {
      const PointGrid::Near near = grid.near(points[i].position, points[i].normal);
      float sum = 0.0f;
      for (std::size_t k = 0; k < near.count; ++k)
        sum += areas[near.point[k]] *
               std::exp(-0.5f * dot(near.offset[k], near.offset[k]) / (blur * blur));
      sums[i] = sum / (2.0f * float_pi * blur * blur);
      if (round > 0) return;
      if (wide.near(points[i].position, points[i].normal).count > 0) {
        wanted[i] = 0.0f;  // stays as it is
        return;
      }
      const float inside = std::clamp((sums[i] - 0.6f) / 0.2f, 0.0f, 1.0f);
      wanted[i] = sums[i] + inside * (1.0f - sums[i]);
    });
    for (std::size_t i = 0; i < points.size(); ++i)
      if (wanted[i] > 0.0f) areas[i] *= wanted[i] / sums[i];
  }
  double before = 0.0, after = 0.0;
  for (const CloudPoint& point : points) before += static_cast<double>(point.area);
  for (const float area : areas) after += static_cast<double>(area);
  if (after > 0.0)
    for (float& area : areas) area *= static_cast<float>(before / after);
  return areas;
}

}  // namespace

template <int N>
HierarchyTransport<N>::HierarchyTransport(const RenderScene& scene,
                                          const BandConversion<N>& conversion,
                                          std::uint32_t material, const ProfileMaker& make_profile,
                                          bool is_printed_exit)
    : scene_(scene),
      conversion_(conversion),
      surface_(std::get<SubsurfaceSurface>(scene.scene->materials[material].surface)),
      material_(material),
      is_printed_exit_(is_printed_exit),
      profiles_(scene, conversion, material, make_profile) {}

template <int N>
float HierarchyTransport<N>::spacing_for(float pixel_size) const {
  const HierarchySettings& settings = scene_.settings.hierarchy;
  const float of_profile = smallest_half_radius(profiles_.of_material()) / samples_per_half_radius;
  return settings.spacing > 0.0f ? settings.spacing : std::max(of_profile, 0.7f * pixel_size);
}

template <int N>
float HierarchyTransport<N>::closest_spacing() const {
  const double area = surface_area(scene_.scene->meshes, material_);
  return static_cast<float>(std::sqrt(area / scene_.settings.hierarchy.max_points));
}

template <int N>
std::optional<IrradianceCloud> HierarchyTransport<N>::sample_light(const LightGatherer<N>& light,
                                                                   const SpacingField& field,
                                                                   int estimates,
                                                                   std::uint64_t seed,
                                                                   const Progress& progress) const {
  const auto levels = make_surface_cells(scene_.scene->meshes, material_, field, seed);
  struct Patch {
    const SurfaceCell* cell;
    std::size_t level;
  };
  std::vector<Patch> patches;
  for (std::size_t level = 0; level < levels.size(); ++level)
    for (const SurfaceCell& cell : levels[level].cells) patches.push_back({&cell, level});
  IrradianceCloud cloud{.material = material_,
                        .bands = surface_.material.bands.size(),
                        .spacing = field.spacing(0),
                        .points = std::vector<CloudPoint>(patches.size()),
                        .wide_from = levels.front().cells.size(),
                        .irradiance = {}};
  cloud.irradiance.resize(cloud.points.size() * cloud.bands);
  const SurfaceMaterial& material = scene_.scene->materials[material_];
  const auto point_on = [&](const SurfaceElement& e, float spacing) {
    SurfacePoint point = make_surface_point(
        scene_.scene->meshes,
        {.distance = 0.0f, .u = e.u, .v = e.v, .mesh = e.mesh, .triangle = e.triangle}, spacing);
    if (material.bump || material.normal_map)
      point.normal = bent_normal(scene_.textures, material, point);
    return point;
  };
  constexpr std::size_t chunk = 64;
  const auto sample = [&](std::size_t i) {
    const SurfaceCell& cell = *patches[i].cell;
    const float spacing = field.spacing(static_cast<int>(patches[i].level));
    const auto elements = levels[patches[i].level].elements_of(cell);
    Bands irradiance;
    std::size_t at = 0;
    float before = 0.0f;  // area of the elements before `at`
    for (int s = 0; s < estimates; ++s) {
      // Points spread over the patch by area.
      const float target =
          cell.area * (static_cast<float>(s) + 0.5f) / static_cast<float>(estimates);
      while (at + 1 < elements.size() && before + elements[at].area < target)
        before += elements[at++].area;
      PixelSamples samples(seed + 0x9d2c5680u, static_cast<std::uint32_t>(i),
                           static_cast<std::uint32_t>(s));
      irradiance += light.entering_irradiance(point_on(elements[at], spacing), samples);
    }
    for (std::size_t b = 0; b < cloud.bands; ++b)
      cloud.irradiance[i * cloud.bands + b] =
          irradiance[static_cast<int>(b)] / static_cast<float>(estimates);
    const SurfacePoint middle = point_on(elements[elements.size() / 2], spacing);
    cloud.points[i] = {.position = cell.position,
                       .normal = cell.normal,
                       .uv = middle.uv,
                       .area = cell.area,
                       .albedo = profiles_.color_at(middle),
                       .thickness = profiles_.thickness_at(middle)};
  };
  if (!parallel_chunks(patches.size(), chunk, sample, progress)) return std::nullopt;
  return cloud;
}

template <int N>
void HierarchyTransport<N>::use(const IrradianceCloud& cloud) {
  const float blur = blur_of_spacing * cloud.spacing;
  gather_profiles_ = GatherProfiles<N>(profiles_, blur);
  support_radius_ = profiles_.of_material().support_radius() + 4.0f * blur;
  width_ = std::max(middle_of_profile * smallest_half_radius(profiles_.of_material()), 2.0f * blur);
  std::vector<IrradianceSample<N>> samples(cloud.points.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const CloudPoint& point = cloud.points[i];
    IrradianceSample<N>& sample = samples[i];
    sample = {.position = point.position,
              .normal = point.normal,
              .area = point.area,
              .irradiance = {},
              .albedo_index = {}};
    for (std::size_t b = 0; b < cloud.bands; ++b)
      sample.irradiance[static_cast<int>(b)] = cloud.irradiance[i * cloud.bands + b];
    if (surface_.color_use == ColorUse::scale)
      sample.irradiance *= profiles_.entering_color(point.thickness, point.albedo);
    if (surface_.color_use == ColorUse::invert)
      sample.albedo_index = profiles_.albedo_index(point.albedo);
  }
  points_ = cloud.points;
  points_.resize(std::min(points_.size(), cloud.wide_from));
  const auto grid_of = [](std::span<const CloudPoint> points, float radius) {
    std::vector<PointGrid::Place> places;
    for (const CloudPoint& point : points) places.push_back({point.position, point.normal});
    return PointGrid(places, radius);
  };
  grid_ = grid_of(points_, radius_of_fit * cloud.spacing);
  const PointGrid wide = grid_of(std::span(cloud.points).subspan(points_.size()),
                                 1.5f * radius_of_fit * cloud.spacing);
  const std::vector<float> areas = balanced_areas(points_, grid_, wide, blur);
  for (std::size_t i = 0; i < areas.size(); ++i) samples[i].area = areas[i];
  tree_ = IrradianceTree<N>(samples);
  const auto medium = make_diffusion_medium<N>(surface_.material);
  const auto [inner, outer] = blocker_patches(cloud.spacing, largest(medium.mfp));
  blockers_ = InnerBlockers<N>(inner, outer, medium, tree_, scene_.settings.hierarchy.error);
  exitance_ = LazyValues<BandValues<N>>(points_.size());
}

template <int N>
BandValues<N> HierarchyTransport<N>::effect_of_color(const Vec3f& color) const {
  // The profile between two points is about the geometric mean of those of both colors.
  return surface_.color_use == ColorUse::invert
             ? sqrt(max(conversion_.from_rgb(color), Bands::filled(1e-3f)))
             : Bands::filled(1.0f);
}

template <int N>
BandValues<N> HierarchyTransport<N>::exitance_without_color(const CloudPoint& point) const {
  const Bands exitance = summed_exitance(point.position, point.normal,
                                         profiles_.profiles_for(point.thickness, point.albedo));
  return surface_.color_use == ColorUse::invert ? exitance / effect_of_color(point.albedo)
                                                : exitance;
}

template <int N>
BandValues<N> HierarchyTransport<N>::exitance(const SurfacePoint& point) const {
  const PointGrid::Weights near = grid_.weights_at(point.position, point.smooth_normal);
  if (near.count == 0)
    return summed_exitance(point.position, point.smooth_normal, profiles_.profiles_at(point));
  Bands total;
  for (std::size_t i = 0; i < near.count; ++i)
    total += near.weight[i] * exitance_.at(near.point[i], [this](std::size_t k) {
      return exitance_without_color(points_[k]);
    });
  total = max(total, Bands{});  // where a line overshoots
  return surface_.color_use == ColorUse::invert ? total * effect_of_color(profiles_.color_at(point))
                                                : total;
}

template <int N>
BandValues<N> HierarchyTransport<N>::summed_exitance(const Vec3f& position, const Vec3f& n,
                                                     const Local& local) const {
  const auto exit = gather_profiles_.exit_at(n, local, profiles_);
  Bands total;
  tree_.gather(position, support_radius_, scene_.settings.hierarchy.error, width_,
               [&](const auto& node, const Bands& albedo_index, const Vec3f& offset, float d2) {
                 // Second order: a profile that falls as r^-3 gains 9/4 of the mean square over d²
                 // from the width of a node, as if it were nearer; one that is flat in its middle
                 // gains nothing.
                 const float width2 = width_ * width_;
                 const float bent = 1.5f * node.mean_square * d2 / (d2 + width2);
                 const float near2 = std::max(d2 - bent, 0.5f * d2);
                 total +=
                     gather_profiles_.evaluate(exit, offset, near2, node.normal, albedo_index) *
                     node.power;
               });
  if (blockers_.may_reach(position, support_radius_))
    total *= blockers_.unblocked_fraction(position, n, tree_);
  return total * local.scale;
}

template <int N>
BandValues<N> HierarchyTransport<N>::leaving_radiance(const ExitPoint& exit,
                                                      const LightGatherer<N>& /*light*/,
                                                      PixelSamples& /*samples*/) const {
  return leaving_fraction(exit, is_printed_exit_) * exitance(exit.point);
}

template class HierarchyTransport<4>;
template class HierarchyTransport<8>;
template class HierarchyTransport<16>;

}  // namespace lamina
