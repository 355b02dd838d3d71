// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/corrected_transport.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include "lamina/core/parallel_chunks.h"
#include "lamina/core/vec_precision.h"
#include "lamina/render/geometry/hemisphere.h"
#include "lamina/render/subsurface/correction/internal/zones_by_creases.h"
#include "lamina/render/subsurface/mean_ior.h"
#include "lamina/render/subsurface/random_walk/random_walk.h"
#include "lamina/render/subsurface/surface_cells.h"
#include "lamina/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

/// Estimates of the light that leaves at a place, each at a point of its own; walks of an estimate.
constexpr int samples_of_place = 16, walks_of_sample = 4;
/// Of places where the surface is seen.
constexpr double most_places = 12000.0, least_places = 1000.0;
/// Estimates to a pixel are of use.
constexpr double samples_of_pixel = 4.0;
/// Of the mean light of the planar method, at least as much as its light counts.
constexpr float least_of_mean = 0.01f;
// Measured on one core of a Zen 4 [CPU s].
constexpr double seconds_per_walk = 9e-6;

/// What flat layers reflect of diffuse light that has entered.
double reflectance_of_entered(const LayerStack& layers) {
  constexpr double accuracy = 1e-4;  // what rough boundaries are good to
  const SlabTotals totals =
      adding_doubling(layers, {.is_diffuse = true}, {.accuracy = accuracy}).totals;
  return totals.diffuse_reflectance / (1.0 - totals.specular_reflectance);
}

/// That over what it is under smooth boundaries.
template <int N>
BandValues<N> effect_of_roughness(const Material& material) {
  auto effect = BandValues<N>::filled(1.0f);
  Material smooth = material;
  for (MaterialLayer& layer : smooth.layers) layer.top = {};
  const auto is_rough = [](const MaterialLayer& layer) { return layer.top.roughness > 0.0; };
  if (std::ranges::none_of(material.layers, is_rough)) return effect;
  for (std::size_t b = 0; b < material.bands.size(); ++b)
    effect[static_cast<int>(b)] =
        static_cast<float>(reflectance_of_entered(layer_stack(material, b)) /
                           reflectance_of_entered(layer_stack(smooth, b)));
  return effect;
}

/// The point that a number in [0, 1) stands for, by area.
SurfacePoint point_on(const std::vector<Mesh>& meshes, std::span<const SurfaceElement> elements,
                      float area, float u, float footprint) {
  std::size_t at = 0;
  for (float left = u * area; at + 1 < elements.size() && !(left < elements[at].area); ++at)
    left -= elements[at].area;
  const SurfaceElement& e = elements[at];
  return make_surface_point(
      meshes, {.distance = 0.0f, .u = e.u, .v = e.v, .mesh = e.mesh, .triangle = e.triangle},
      footprint);
}

}  // namespace

template <int N>
CorrectedTransport<N>::CorrectedTransport(const RenderScene& scene, std::uint32_t material,
                                          std::unique_ptr<SubsurfaceMethod<N>> planar,
                                          std::unique_ptr<SubsurfaceMethod<N>> walk)
    : scene_(scene), material_(material), planar_(std::move(planar)), walk_(std::move(walk)) {
  const auto& surface = std::get<SubsurfaceSurface>(scene.scene->materials[material].surface);
  bands_ = static_cast<int>(surface.material.bands.size());
  ior_ = mean_ior(surface.material);
  of_roughness_ =
      is_quieter_smooth(surface) ? effect_of_roughness<N>(surface.material) : Bands::filled(1.0f);
}

template <int N>
void CorrectedTransport<N>::prepare_reflectance(const Preparation<N>& with) {
  planar_->prepare_reflectance(with);
  walk_->prepare_reflectance(with);
}

template <int N>
double CorrectedTransport<N>::places_wanted(const Preparation<N>& with) const {
  if (with.cache.is_wanted()) return most_places;
  const double between = static_cast<double>(with.seen.pixels_between);
  const double pixels = between * between * static_cast<double>(with.seen.points[material_].size());
  return std::clamp(pixels * samples_of_pixel / samples_of_place, least_places, most_places);
}

template <int N>
SpacingField CorrectedTransport<N>::field_of_places(const Preparation<N>& with) const {
  const auto& meshes = scene_.scene->meshes;
  const double wanted = places_wanted(with);
  std::vector<Vec3f> seen;
  for (const SurfacePoint& point : with.seen.points[material_]) seen.push_back(point.position);
  const double area = surface_area(meshes, material_);
  if (seen.empty() || with.cache.is_wanted())
    return SpacingField(static_cast<float>(std::sqrt(area / wanted)));
  const float margin = 2.0f * with.seen.pixels_between * with.seen.pixel_size(material_);
  const double least_area = 1e-8 * area;
  auto spacing =
      static_cast<float>(std::sqrt(std::max(with.seen.area(material_), least_area) / wanted));
  for (;; spacing *= 1.1f) {
    SpacingField field(seen, spacing, margin);
    const auto counts = expected_cells(meshes, material_, field);
    if (std::accumulate(counts.begin(), counts.end(), 0.0) <= 1.05 * wanted) return field;
  }
}

template <int N>
SubsurfaceCost CorrectedTransport<N>::expected_cost(const Preparation<N>& with) const {
  SubsurfaceCost cost = planar_->expected_cost(with);
  cost.preparation += walk_->expected_cost(with).preparation +
                      places_wanted(with) * samples_of_place * walks_of_sample * seconds_per_walk;
  return cost;
}

template <int N>
bool CorrectedTransport<N>::prepare(const Preparation<N>& with) {
  if (!planar_->prepare(with)) return false;
  if (const LightRatioCloud* kept = with.cache.find_ratios(material_)) {
    use(*kept, with.report);
    return true;
  }
  if (!walk_->prepare(with)) return false;
  std::optional<LightRatioCloud> found = find_ratios(with);
  if (!found) return false;
  use(*found, with.report);
  if (!found->places.empty()) with.cache.add(*std::move(found));
  return true;
}

template <int N>
void CorrectedTransport<N>::use(const LightRatioCloud& cloud, PreparationReport& report) {
  if (cloud.places.empty()) return;
  std::vector<PlaceGraph::Place> places;
  for (const auto& [position, normal, spacing] : cloud.places)
    places.push_back({{position, normal}, spacing});
  graph_ = PlaceGraph(places);
  least_exitance_ = cloud.least_exitance;
  auto number = cloud.shape.begin();
  for (Bands& term : shape_)
    for (int b = 0; b < bands_; ++b) term[b] = *number++;
  ratios_.resize(places.size());
  number = cloud.ratios.begin();
  for (DirectionalRatio<N>& ratio : ratios_)
    for (Bands& term : ratio)
      for (int b = 0; b < bands_; ++b) term[b] = *number++;
  report.corrections.push_back({.material = material_,
                                .walks = cloud.walks,
                                .change = cloud.change,
                                .error_left = cloud.error_left});
}

template <int N>
std::optional<LightRatioCloud> CorrectedTransport<N>::find_ratios(const Preparation<N>& with) {
  const Scene& scene = *scene_.scene;
  const SpacingField field = field_of_places(with);
  const auto levels = make_surface_cells(scene.meshes, material_, field, scene.render.seed);
  struct Cell {
    const SurfaceCells* surface;
    const SurfaceCell* cell;
    float spacing;
  };
  std::vector<Cell> cells;
  std::vector<PlaceGraph::Place> places;
  std::vector<float> areas;
  const ZonesByCreases zones(scene.meshes, material_, field.spacing(0));
  for (std::size_t level = 0; level < levels.size(); ++level)
    for (const SurfaceCell& cell : levels[level].cells) {
      const float spacing_there = field.spacing(static_cast<int>(level));
      cells.push_back({&levels[level], &cell, spacing_there});
      places.push_back({{cell.position, cell.normal}, spacing_there, zones.at(cell.position)});
      areas.push_back(level == 0 ? cell.area : 0.0f);
    }

  std::vector<std::vector<WalkedSample<N>>> samples(cells.size());
  std::vector<std::vector<float>> leaving(cells.size());
  const Vec3f eye = to_float(scene.camera.position);
  const bool has_eye = !with.cache.is_wanted();
  constexpr std::size_t chunk = 16;
  const auto walk_at = [&](std::size_t i) {
    const auto& [surface, cell, spacing_there] = cells[i];
    const float share = cell->area / static_cast<float>(samples_of_place);
    for (int s = 0; s < samples_of_place; ++s) {
      PixelSamples random(scene.render.seed + 0x2c1b3c6du, static_cast<std::uint32_t>(i),
                          static_cast<std::uint32_t>(s));
      const SurfacePoint point =
          point_on(scene.meshes, surface->elements_of(*cell), cell->area, random.next_1d(),
                   spacing_there / static_cast<float>(samples_of_place));
      Vec3f direction =
          make_frame(point.smooth_normal).to_world(sample_cosine_hemisphere(random.next_2d()));
      // Halves of the samples, by turns, are fitted to each other: both must look the same way.
      const Vec3f to_eye = normalize(eye - point.position);
      const bool is_to_eye = has_eye && s % 4 < 2 && dot(to_eye, point.smooth_normal) > 0.0f;
      if (is_to_eye) direction = to_eye;
      const float cosine = dot(direction, point.smooth_normal);
      WalkedSample<N> sample{.terms = direction_terms_of(direction, point.smooth_normal, ior_)};
      if (has_eye) sample.weight = is_to_eye ? cosine : 0.0f;  // the picture's mean
      float of_exitance = 0.0f;
      if (cosine > 0.0f && dot(direction, point.geometric_normal) > 0.0f) {
        const SurfaceBoundary boundary = boundary_at(scene_, point);
        const ExitPoint exit{point, boundary, cosine, direction};
        of_exitance = share * exit_distribution(boundary, cosine);
        sample.planar = share * planar_->leaving_radiance(exit, with.light, random);
        sample.walked = share * (of_roughness_ * walk_->leaving_radiance(exit, with.light, random));
      }
      samples[i].push_back(sample);
      leaving[i].push_back(of_exitance);
    }
  };
  if (!parallel_chunks(cells.size(), chunk, walk_at, with.progress)) return std::nullopt;
  walk_.reset();  // memory: nobody walks any more

  double planar = 0.0, exitance = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t s = 0; s < samples[i].size(); ++s) {
      for (int b = 0; b < bands_; ++b) planar += static_cast<double>(samples[i][s].planar[b]);
      exitance += static_cast<double>(leaving[i][s]) * bands_;
    }
  LightRatioCloud found{.material = material_,
                        .bands = static_cast<std::size_t>(bands_),
                        .walks = cells.size() * samples_of_place * walks_of_sample};
  if (!(planar > 0.0)) return found;  // no light, and nothing to correct
  found.least_exitance = least_of_mean * static_cast<float>(planar / exitance);
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t s = 0; s < samples[i].size(); ++s)
      samples[i][s].planar += Bands::filled(found.least_exitance * leaving[i][s]);
  const CorrectionFit<N> fit = fit_correction<N>(PlaceGraph(places), areas, samples, bands_);
  found.change = fit.change;
  found.error_left = fit.error_left;
  const auto add_bands = [&](const auto& terms, std::vector<float>& to) {
    for (const Bands& term : terms) to.insert(to.end(), term.v, term.v + bands_);
  };
  add_bands(fit.shape, found.shape);
  for (std::size_t i = 0; i < places.size(); ++i) {
    found.places.push_back({places[i].at.position, places[i].at.normal, places[i].spacing});
    add_bands(fit.ratios[i], found.ratios);
  }
  return found;
}

template <int N>
BandValues<N> CorrectedTransport<N>::leaving_radiance(const ExitPoint& exit,
                                                      const LightGatherer<N>& light,
                                                      PixelSamples& samples) const {
  const Bands planar = planar_->leaving_radiance(exit, light, samples);
  const Vec3f& normal = exit.point.smooth_normal;
  const auto near = graph_.weights_at(exit.point.position, normal);
  if (near.count == 0) return planar;
  const DirectionTerms terms = direction_terms_of(exit.to_eye, normal, ior_);
  DirectionalRatio<N> ratio{};
  for (std::size_t i = 0; i < near.count; ++i)
    for (std::size_t k = 0; k < direction_terms; ++k)
      ratio[k] += near.weight[i] * ratios_[near.point[i]][k];
  return evaluate(shape_, terms) * evaluate(ratio, terms) *
         (planar + Bands::filled(least_exitance_ * exit_distribution(exit.boundary, exit.cos_o)));
}

template class CorrectedTransport<4>;
template class CorrectedTransport<8>;
template class CorrectedTransport<16>;

}  // namespace lamina
