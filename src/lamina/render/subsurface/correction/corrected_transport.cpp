// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/corrected_transport.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "lamina/base/core/vec.h"
#include "lamina/render/subsurface/mean_ior.h"
#include "lamina/render/subsurface/media/quiet_layers.h"
#include "lamina/render/subsurface/random_walk/random_walk.h"
#include "lamina/render/subsurface/surface_cells.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

/// Estimates of the light that leaves at a place, in the mean: of a first look at their noise, then
/// where that is as usual or less, and by that much more where it is more, but up to so many times.
constexpr double first_samples = 4.0, samples_of_place = 20.0, most_effort = 4.0;
/// In layers and maps walks take ten times as long, so that more noise is left.
constexpr double usual_noise = 0.5, usual_noise_in_layers = 1.0;
constexpr int walks_of_sample = 4;
/// Of places where the surface is seen; and all over it, for all cameras.
constexpr double most_places = 6000.0, least_places = 2000.0, places_for_all = 12000.0;
/// Estimates to a pixel are of use.
constexpr double samples_of_pixel = 10.0;
constexpr float least_cosine_of_pixel = 0.1f;  // at which its area on the surface counts
/// Of the mean light of the planar method, as much more as its light may count.
constexpr std::array<float, 3> more_of_mean = {0.01f, 1.0f, 10.0f};
// Measured on one core of a Zen 4 [CPU s].
constexpr double seconds_per_walk = 9e-6, seconds_per_walk_in_layers = 1.2e-4;
constexpr double seconds_of_fit = 3e-4;  // at a place

/// What flat layers reflect of diffuse light that has entered.
double reflectance_of_entered(const LayerStack& layers) {
  constexpr double accuracy = 1e-4;  // what rough boundaries are good to
  const SlabTotals totals =
      adding_doubling(layers, {.is_diffuse = true}, {.accuracy = accuracy}).totals;
  return totals.diffuse_reflectance / (1.0 - totals.specular_reflectance);
}

/// That over what it is of quiet layers.
template <int N>
BandValues<N> flat_over_quiet(const Material& material) {
  auto ratio = BandValues<N>::filled(1.0f);
  const Material quiet = quiet_layers(material);
  if (quiet.layers == material.layers) return ratio;
  for (std::size_t b = 0; b < material.bands.size(); ++b)
    ratio[static_cast<int>(b)] =
        static_cast<float>(reflectance_of_entered(layer_stack(material, b)) /
                           reflectance_of_entered(layer_stack(quiet, b)));
  return ratio;
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
  has_layers_ = surface.material.layers.size() > 1 || !surface.material_maps.empty();
  flat_over_quiet_ =
      is_better_quiet(surface) ? flat_over_quiet<N>(surface.material) : Bands::filled(1.0f);
}

template <int N>
void CorrectedTransport<N>::prepare_reflectance(const Preparation<N>& with) {
  planar_->prepare_reflectance(with);
  walk_->prepare_reflectance(with);
}

template <int N>
double CorrectedTransport<N>::places_wanted(const Preparation<N>& with) const {
  if (with.cache.is_wanted()) return places_for_all;
  const double between = static_cast<double>(with.seen.pixels_between);
  const double pixels = between * between * static_cast<double>(with.seen.points[material_].size());
  return std::clamp(pixels * samples_of_pixel / samples_of_place, least_places, most_places);
}

template <int N>
double CorrectedTransport<N>::seconds_of_refinement(const Preparation<N>& with) const {
  const double per_walk = has_layers_ ? seconds_per_walk_in_layers : seconds_per_walk;
  return places_wanted(with) * (samples_of_place * walks_of_sample * per_walk + seconds_of_fit);
}

template <int N>
float CorrectedTransport<N>::spacing_of_places(const Preparation<N>& with) const {
  double area = 0.0;  // that pixels see, at a slant most of it
  for (const SurfacePoint& point : with.seen.points[material_]) {
    if (eyes_.empty()) break;
    const float pixel = point.footprint * with.seen.pixels_between;
    const Vec3f to_eye = direction_to_eye(point.position, point.geometric_normal);
    const float cosine = std::max(dot(point.geometric_normal, to_eye), least_cosine_of_pixel);
    area += static_cast<double>(pixel * pixel / cosine);
  }
  const double all = surface_area(scene_.scene->meshes, material_);
  area = area > 0.0 ? std::clamp(area, 1e-8 * all, all) : all;
  // In steps of a factor of 2, so that cameras that see about as much share their places.
  const double places_of_all = places_wanted(with) * all / area;
  return static_cast<float>(std::sqrt(all / std::exp2(std::round(std::log2(places_of_all)))));
}

template <int N>
Vec3f CorrectedTransport<N>::direction_to_eye(const Vec3f& position,
                                              const Vec3f& direction) const {
  Vec3f nearest = direction;
  float most = -2.0f;
  for (const Vec3f& eye : eyes_) {
    const Vec3f to_eye = normalize(eye - position);
    const float cosine = dot(to_eye, direction);
    if (!(cosine > most)) continue;
    most = cosine;
    nearest = to_eye;
  }
  return nearest;
}

template <int N>
SubsurfaceCost CorrectedTransport<N>::expected_cost(const Preparation<N>& with) const {
  SubsurfaceCost cost = planar_->expected_cost(with);
  cost.preparation += walk_->expected_cost(with).preparation;
  cost.refinement = seconds_of_refinement(with);
  return cost;
}

template <int N>
bool CorrectedTransport<N>::prepare(const Preparation<N>& with) {
  if (!planar_->prepare(with)) return false;
  if (!with.cache.is_wanted()) eyes_ = {to_float(scene_.scene->camera.position)};
  if (const LightRatioCloud* kept = with.cache.find_ratios(material_)) {
    use(*kept, 1.0, with.report);
    walk_.reset();
    if (with.on_more_work) with.on_more_work(-seconds_of_refinement(with));
    return true;
  }
  return walk_->prepare(with);
}

template <int N>
void CorrectedTransport<N>::refine(const Preparation<N>& with) {
  if (!walk_) return;
  const typename SampledPlaces<N>::Methods methods{*planar_, *walk_, flat_over_quiet_, ior_,
                                                   bands_};
  const float spacing = spacing_of_places(with);
  SampledPlaces<N> places(scene_, material_, spacing, methods, with, eyes_);
  const double share = walk(places, with);
  LightRatioCloud found;
  if (share > 0.0) found = fit_ratios(places, spacing);
  walk_.reset();  // memory: nobody walks any more
  if (share > 0.0 && found.places.empty()) return;  // no light
  found.material = material_;
  use(found, share, with.report);
  if (share == 1.0) with.cache.add(std::move(found));
}

template <int N>
double CorrectedTransport<N>::walk(SampledPlaces<N>& places, const Preparation<N>& with) const {
  // Nobody knows yet how many there will be, few or four times as many:
  // test CorrectedTransport.MakesAPictureOfTheWalksSoFar.
  constexpr double progress_of_look = 0.1;
  if (!places.sample(first_samples, part_of(with.progress, 0.0, progress_of_look))) return 0.0;
  const double usual = has_layers_ ? usual_noise_in_layers : usual_noise;
  const double effort = std::clamp(places.noise() / usual, 1.0, most_effort);
  const double mean = samples_of_place * effort;
  const double seconds = places.seconds() * mean / first_samples +
                         seconds_of_fit * static_cast<double>(places.places().size());
  if (with.on_more_work) with.on_more_work(seconds - seconds_of_refinement(with));
  return places.sample(mean, part_of(with.progress, progress_of_look, 1.0)) ? 1.0
         : places.sample_count() > 0 ? std::min(places.samples_of_mean() / mean, 0.999)
                                     : 0.0;
}

template <int N>
LightRatioCloud CorrectedTransport<N>::fit_ratios(const SampledPlaces<N>& places,
                                                  float spacing) const {
  LightRatioCloud found{.material = material_,
                        .bands = static_cast<std::size_t>(bands_),
                        .walks = walks_of_sample * places.sample_count(),
                        .spacing = spacing};
  const PlaceGraph graph(places.places());
  std::optional<CorrectionFit<N>> fit;
  typename SampledPlaces<N>::Assessment best;
  for (const float fraction : more_of_mean) {
    const float exitance = places.exitance_of_mean(fraction);
    if (!(exitance > 0.0f)) return found;  // no light, and nothing to correct
    const auto shape = fit ? std::optional(fit->shape) : std::nullopt;
    CorrectionFit<N> tried =
        fit_correction<N>(graph, places.areas(), places.samples(exitance), bands_, shape);
    const auto assessed = places.assess(tried, exitance);
    if (!fit) {
      for (const PlaceGraph::Place& place : places.places())
        found.places.push_back({place.at.position, place.at.normal, exitance});
      found.change = assessed.change;
      found.error_left = tried.error_left;
      best = assessed;
      fit = std::move(tried);
      continue;
    }
    const std::vector<bool> is_better = assessed.is_better_than(best, graph);
    for (std::size_t i = 0; i < is_better.size(); ++i) {
      if (!is_better[i]) continue;
      found.places[i].added_exitance = exitance;
      best.left_at[i] = assessed.left_at[i];
      fit->ratios[i] = tried.ratios[i];
    }
  }
  const auto add_bands = [&](const auto& terms, std::vector<float>& to) {
    for (const Bands& term : terms) to.insert(to.end(), term.v, term.v + bands_);
  };
  add_bands(fit->shape, found.shape);
  for (const DirectionalRatio<N>& ratio : fit->ratios) add_bands(ratio, found.ratios);
  return found;
}

template <int N>
void CorrectedTransport<N>::use(const LightRatioCloud& cloud, double share,
                                PreparationReport& report) {
  report.corrections.push_back({.material = material_,
                                .walks = cloud.walks,
                                .change = cloud.change,
                                .error_left = cloud.error_left,
                                .share = share});
  if (cloud.places.empty()) return;
  std::vector<PlaceGraph::Place> places;
  for (const auto& [position, normal, added_exitance] : cloud.places) {
    places.push_back({{position, normal}, cloud.spacing});
    added_exitance_.push_back(added_exitance);
  }
  graph_ = PlaceGraph(places);
  auto number = cloud.shape.begin();
  for (Bands& term : shape_)
    for (int b = 0; b < bands_; ++b) term[b] = *number++;
  ratios_.resize(places.size());
  number = cloud.ratios.begin();
  for (DirectionalRatio<N>& ratio : ratios_)
    for (Bands& term : ratio)
      for (int b = 0; b < bands_; ++b) term[b] = *number++;
  // Elsewhere the planar light is all there is: what it counts as more there is next to nothing.
  const float least_added = *std::ranges::min_element(added_exitance_);
  Bands sum;
  float count = 0.0f;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto& [position, normal] = places[i].at;
    const Vec3f to_eye = direction_to_eye(position, normal);
    if (added_exitance_[i] > least_added || !(dot(to_eye, normal) > 0.0f)) continue;
    sum += ratio_at(ratios_[i], direction_terms_of(to_eye, normal, ior_));
    ++count;
  }
  if (count > 0.0f) elsewhere_ = (1.0f / count) * sum;
}

template <int N>
BandValues<N> CorrectedTransport<N>::leaving_radiance(const ExitPoint& exit,
                                                      const LightGatherer<N>& light,
                                                      PixelSamples& samples) const {
  const Bands planar = planar_->leaving_radiance(exit, light, samples);
  const Vec3f& normal = exit.point.smooth_normal;
  const auto near = graph_.weights_at(exit.point.position, normal);
  if (near.count == 0) return elsewhere_ * planar;
  // Mirrors, too, show about what the eye sees that the ratio is for.
  const Vec3f to_eye = direction_to_eye(exit.point.position, exit.to_eye);
  const DirectionTerms terms =
      direction_terms_of(dot(to_eye, normal) > 0.0f ? to_eye : exit.to_eye, normal, ior_);
  DirectionalRatio<N> ratio{}, ratio_of_added{};
  for (std::size_t i = 0; i < near.count; ++i) {
    const std::uint32_t place = near.point[i];
    for (std::size_t k = 0; k < direction_terms; ++k) {
      const Bands term = near.weight[i] * ratios_[place][k];
      ratio[k] += term;
      ratio_of_added[k] += added_exitance_[place] * term;
    }
  }
  return ratio_at(ratio, terms) * planar +
         exit_distribution(exit.boundary, exit.cos_o) * ratio_at(ratio_of_added, terms);
}

template class CorrectedTransport<4>;
template class CorrectedTransport<8>;
template class CorrectedTransport<16>;

}  // namespace lamina
