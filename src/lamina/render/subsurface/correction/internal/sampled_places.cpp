// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/internal/sampled_places.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "lamina/base/core/parallel_chunks.h"
#include "lamina/base/io/cpu_time.h"
#include "lamina/render/geometry/hemisphere.h"
#include "lamina/render/subsurface/correction/internal/zones_by_creases.h"
#include "lamina/scene/surface/point_grid.h"

namespace lamina {
namespace {

/// Samples of a place over their mean.
constexpr double least_share = 1.0 / 3.0, most_share = 8.0 / 3.0;
/// Footprint of a sample, by which maps are filtered, below the spacing.
constexpr float samples_of_footprint = 16.0f;
/// Spacings from a place that is seen to what is seen there, and from a place that is of use: where
/// pixels see the surface at a slant they are far apart on it.
constexpr float reach_of_sight = 1.5f, reach_of_use = 4.0f;
/// Steps of the graph around a place by which a fit is chosen there.
constexpr int steps_of_choice = 8;
constexpr std::size_t places_at_once = 16;

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
SampledPlaces<N>::SampledPlaces(const RenderScene& scene, std::uint32_t material, float spacing,
                                const Methods& methods, const Preparation<N>& with,
                                std::vector<Vec3f> eyes)
    : scene_(scene), methods_(methods), with_(with), eyes_(std::move(eyes)) {
  const auto& seen = with.seen.points[material];
  const bool is_all_seen = eyes_.empty() || seen.empty();
  std::vector<Vec3f> positions;
  std::vector<PointGrid::Place> places;
  for (const SurfacePoint& point : seen) {
    positions.push_back(point.position);
    places.push_back({point.position, point.smooth_normal});
  }
  const auto& meshes = scene.scene->meshes;
  const std::uint64_t seed = scene.settings.seed;
  surface_ = is_all_seen ? make_surface_cells(meshes, material, spacing, seed)
                         : make_surface_cells_of_first_level(
                               meshes, material, SpacingField(positions, spacing, 0.0f), seed);
  const ZonesByCreases zones(meshes, material, spacing);
  const PointGrid in_sight(places, reach_of_sight * spacing),
      of_use(places, reach_of_use * spacing);
  for (const SurfaceCell& cell : surface_.cells) {
    const auto is_near = [&](const PointGrid& grid) {
      return is_all_seen || grid.near(cell.position, cell.normal).count > 0;
    };
    if (!is_near(of_use)) continue;
    cells_.push_back(&cell);
    keys_.push_back(static_cast<std::uint32_t>(element_key(surface_.elements_of(cell).front())));
    places_.push_back({{cell.position, cell.normal}, spacing, zones.at(cell.position)});
    areas_.push_back(is_near(in_sight) ? cell.area : 0.0f);
  }
  samples_.resize(places_.size());
  exitances_.resize(places_.size());
}

template <int N>
float SampledPlaces<N>::planar_light(std::size_t place) const {
  const SurfaceCell& cell = *cells_[place];
  PixelSamples random(scene_.settings.seed, keys_[place], 0);
  const SurfacePoint point = point_on(scene_.scene->meshes, surface_.elements_of(cell), cell.area,
                                      0.5f, std::sqrt(cell.area));
  const BandValues<N> radiance = methods_.planar.leaving_radiance(
      {point, boundary_at(scene_, point), 1.0f, point.smooth_normal}, with_.light, random);
  float light = 0.0f;
  for (int b = 0; b < methods_.bands; ++b) light += radiance[b];
  return light;
}

template <int N>
Vec3f SampledPlaces<N>::direction_of_sample(const SurfacePoint& point, std::size_t number,
                                            PixelSamples& random) const {
  if (eyes_.empty())
    return make_frame(point.smooth_normal).to_world(sample_cosine_hemisphere(random.next_2d()));
  // Pairs of samples, one of each half, take turns with the eyes that see the point.
  const auto sees = [&](const Vec3f& eye) {
    return dot(eye - point.position, point.smooth_normal) > 0.0f;
  };
  const auto count = static_cast<std::size_t>(std::ranges::count_if(eyes_, sees));
  std::size_t left = count > 0 ? number / 2 % count : 0;
  const auto eye =
      std::ranges::find_if(eyes_, [&](const Vec3f& e) { return sees(e) && left-- == 0; });
  return normalize((eye != eyes_.end() ? *eye : eyes_.front()) - point.position);
}

template <int N>
void SampledPlaces<N>::add_sample(std::size_t place) {
  const std::size_t s = samples_[place].size();
  const Scene& scene = *scene_.scene;
  const SurfaceCell& cell = *cells_[place];
  PixelSamples random(scene_.settings.seed + 0x2c1b3c6du, keys_[place],
                      static_cast<std::uint32_t>(s));
  const SurfacePoint point =
      point_on(scene.meshes, surface_.elements_of(cell), cell.area, random.next_1d(),
               std::sqrt(cell.area) / samples_of_footprint);
  const Vec3f direction = direction_of_sample(point, s, random);
  const float cosine = dot(direction, point.smooth_normal);
  WalkedSample<N> sample{.terms = direction_terms_of(direction, point.smooth_normal, methods_.ior)};
  float exitance = 0.0f;
  if (!eyes_.empty()) sample.weight = std::max(cosine, 0.0f);  // the picture's mean
  if (cosine > 0.0f && dot(direction, point.geometric_normal) > 0.0f) {
    const SurfaceBoundary boundary = boundary_at(scene_, point);
    const ExitPoint exit{point, boundary, cosine, direction};
    exitance = cell.area * exit_distribution(boundary, cosine);
    sample.planar = cell.area * methods_.planar.leaving_radiance(exit, with_.light, random);
    // What comes straight through is no light that changes slowly with the direction.
    sample.walked = cell.area * methods_.walk_scale *
                    (eyes_.empty() ? methods_.walk.scattered_radiance(exit, with_.light, random)
                                   : methods_.walk.leaving_radiance(exit, with_.light, random));
  }
  samples_[place].push_back(sample);
  exitances_[place].push_back(exitance);
}

template <int N>
bool SampledPlaces<N>::find_shares() {
  shares_.resize(places_.size());
  const auto see = [&](std::size_t i) {
    if (areas_[i] > 0.0f)
      shares_[i] = std::sqrt(std::max(static_cast<double>(planar_light(i)), 0.0));
  };
  if (!parallel_chunks(places_.size(), places_at_once, see, with_.progress)) return false;
  double sum = 0.0;
  for (const double root : shares_) sum += root;
  const auto seen =
      static_cast<double>(std::ranges::count_if(areas_, [](float a) { return a > 0.0f; }));
  for (double& share : shares_)
    share = std::clamp(sum > 0.0 ? share * seen / sum : 1.0, least_share, most_share);
  return true;
}

template <int N>
bool SampledPlaces<N>::sample(double mean, const Progress& progress) {
  if (shares_.empty() && !find_shares()) return false;
  std::atomic<std::size_t> finished = 0;
  const auto sample_place = [&](std::size_t i) {
    const double start = thread_cpu_seconds();
    const auto count = 2 * std::max(std::lround(mean / 2.0 * shares_[i]), 1L);  // of two halves
    while (std::ssize(samples_[i]) < count) add_sample(i);
    seconds_ += thread_cpu_seconds() - start;
    ++finished;
  };
  const Progress of_places = [&](double) {
    return report_progress(progress,
                           static_cast<double>(finished) / static_cast<double>(places_.size()));
  };
  return parallel_chunks(places_.size(), places_at_once, sample_place, of_places);
}

template <int N>
double SampledPlaces<N>::samples_of_mean() const {
  double share = 0.0;
  for (const double of_place : shares_) share += of_place;
  return share > 0.0 ? static_cast<double>(sample_count()) / share : 0.0;
}

template <int N>
double SampledPlaces<N>::noise() const {
  double sum = 0.0;
  for (int b = 0; b < methods_.bands; ++b) {
    // Sums over area of radiance by walks w and by the planar method p, and of w², w p and p².
    double area = 0.0, walked = 0.0, planar = 0.0, walked2 = 0.0, product = 0.0, planar2 = 0.0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      if (!(areas_[i] > 0.0f)) continue;
      const auto area_there = static_cast<double>(areas_[i]);
      const double share = 1.0 / static_cast<double>(samples_[i].size());
      area += area_there;
      for (const WalkedSample<N>& sample : samples_[i]) {
        const auto w = static_cast<double>(sample.walked[b]);
        const auto p = static_cast<double>(sample.planar[b]);
        walked += share * w;
        planar += share * p;
        walked2 += share / area_there * w * w;
        product += share / area_there * w * p;
        planar2 += share / area_there * p * p;
      }
    }
    if (!(walked > 0.0 && planar > 0.0)) continue;
    const double ratio = walked / planar;
    const double left = walked2 - 2.0 * ratio * product + ratio * ratio * planar2;
    sum += std::max(left, 0.0) * area / (walked * walked);
  }
  return std::sqrt(sum / methods_.bands);
}

template <int N>
float SampledPlaces<N>::exitance_of_mean(float fraction) const {
  double planar = 0.0, exitance = 0.0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const double share = 1.0 / static_cast<double>(samples_[i].size());
    for (const WalkedSample<N>& sample : samples_[i])
      for (int b = 0; b < methods_.bands; ++b)
        planar += share * static_cast<double>(sample.planar[b]);
    for (const float e : exitances_[i]) exitance += share * methods_.bands * static_cast<double>(e);
  }
  return planar > 0.0 ? fraction * static_cast<float>(planar / exitance) : 0.0f;
}

template <int N>
std::size_t SampledPlaces<N>::sample_count() const {
  std::size_t count = 0;
  for (const auto& of_place : samples_) count += of_place.size();
  return count;
}

template <int N>
std::vector<std::vector<WalkedSample<N>>> SampledPlaces<N>::samples(float exitance) const {
  auto result = samples_;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const float share = 1.0f / static_cast<float>(result[i].size());
    for (std::size_t s = 0; s < result[i].size(); ++s) {
      WalkedSample<N>& sample = result[i][s];
      sample.walked *= share;
      sample.planar = share * (sample.planar + BandValues<N>::filled(exitance * exitances_[i][s]));
    }
  }
  return result;
}

template <int N>
auto SampledPlaces<N>::assess(const CorrectionFit<N>& fit, float exitance) const -> Assessment {
  // Sums of radiance and of its square over area.
  double area = 0.0, changed = 0.0;
  BandValues<N> light;
  std::vector<BandValues<N>> left(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    if (!(areas_[i] > 0.0f)) continue;
    const float share = 1.0f / static_cast<float>(samples_[i].size());
    BandValues<N> change_there, left_there;
    for (std::size_t s = 0; s < samples_[i].size(); ++s) {
      const auto& [terms, walked, planar, weight] = samples_[i][s];
      const BandValues<N> shaped = evaluate(fit.shape, terms) *
                                   (planar + BandValues<N>::filled(exitance * exitances_[i][s]));
      const BandValues<N> predicted = shaped * evaluate(fit.of_halves[1 - s % 2][i], terms);
      change_there += share * (shaped * evaluate(fit.ratios[i], terms) - planar);
      left_there += share * (predicted * (predicted - 2.0f * walked));
      light += share * walked;
    }
    left[i] = (1.0f / areas_[i]) * left_there;
    for (int b = 0; b < methods_.bands; ++b)
      changed += std::pow(static_cast<double>(change_there[b]), 2) / static_cast<double>(areas_[i]);
    area += static_cast<double>(areas_[i]);
  }
  Assessment found{.left_at = std::vector<double>(samples_.size())};
  double all_light = 0.0;
  for (int b = 0; b < methods_.bands; ++b) {
    const auto of_band = static_cast<double>(light[b]);
    all_light += of_band;
    if (!(of_band > 0.0)) continue;
    const double scale = area / (of_band * of_band * methods_.bands);
    for (std::size_t i = 0; i < left.size(); ++i)
      found.left_at[i] += scale * static_cast<double>(left[i][b]);
  }
  for (const double at_place : found.left_at) found.left += at_place;
  if (all_light > 0.0) found.change = std::sqrt(changed * area * methods_.bands) / all_light;
  return found;
}

template <int N>
std::vector<bool> SampledPlaces<N>::Assessment::is_better_than(const Assessment& other,
                                                               const PlaceGraph& graph) const {
  std::vector<float> less(left_at.size()), squares(left_at.size());
  for (std::size_t i = 0; i < less.size(); ++i) {
    less[i] = static_cast<float>(other.left_at[i] - left_at[i]);
    squares[i] = less[i] * less[i];
  }
  for (int step = 0; step < steps_of_choice; ++step) {
    less = graph.spread(less);
    squares = graph.spread(squares);
  }
  const auto places = static_cast<float>(PlaceGraph::places_reached(steps_of_choice));
  std::vector<bool> result(less.size());
  for (std::size_t i = 0; i < less.size(); ++i)
    result[i] = less[i] > std::sqrt(squares[i] / places);
  return result;
}

template class SampledPlaces<4>;
template class SampledPlaces<8>;
template class SampledPlaces<16>;

}  // namespace lamina
