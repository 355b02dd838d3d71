// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/papers/single_scattering/single_scattering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "lamina/base/core/float_pi.h"
#include "lamina/layers/optics/henyey_greenstein.h"
#include "lamina/render/shading/refracted_entry.h"
#include "lamina/render/subsurface/mean_ior.h"
#include "lamina/render/subsurface/nearby_point.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"

namespace lamina {
namespace {

template <int N>
FirstOrderStack<BandValues<N>> layers_of(const Material& material) {
  std::vector<LayerStack> bands;
  for (std::size_t b = 0; b < material.bands.size(); ++b) bands.push_back(layer_stack(material, b));
  return make_first_order<N>(bands);
}

using ColorUse = SubsurfaceSurface::ColorUse;

/// The layers, [band], of which most light leaves: with an inverted color those that hardly absorb.
std::vector<LayerStack> whitest(const SubsurfaceSurface& surface) {
  std::vector<LayerStack> stacks = layer_stacks(surface.material);
  if (surface.color_use == ColorUse::invert)
    for (LayerStack& stack : stacks) stack = with_absorption(stack, 1e-6);
  return stacks;
}

}  // namespace

template <int N>
SingleScattering<N>::SingleScattering(const RenderScene& scene, const BandConversion<N>& conversion,
                                      std::uint32_t material, bool is_refracted,
                                      const ProfileMaker& make_profile,
                                      std::unique_ptr<SubsurfaceMethod<N>> multiple)
    : scene_(scene),
      conversion_(conversion),
      material_(material),
      is_refracted_(is_refracted),
      surface_(std::get<SubsurfaceSurface>(scene.scene->materials[material].surface)),
      profiles_(scene, conversion, material, make_profile),
      in_even_light_(whitest(surface_)),
      multiple_(std::move(multiple)) {
  const Material& layers = surface_.material;
  bands_ = static_cast<int>(layers.bands.size());
  ior_ = mean_ior(layers);
  layers_ = layers_of<N>(layers);
  const LayerStack middle = layer_stack(layers, layers.bands.size() / 2);
  for (const Layer& layer : middle.layers()) phases_.push_back(phase_function(layer));
  absorption_.resize(layers_.layers.size());
  for (int b = 0; b < bands_; ++b) {
    const LayerStack own = with_absorption(layer_stack(layers, static_cast<std::size_t>(b)), 1.0);
    for (std::size_t i = 0; i < absorption_.size(); ++i)
      absorption_[i][b] = static_cast<float>(own.layers()[i].medium.sigma_a);
  }
}

template <int N>
typename SingleScattering<N>::Extinction SingleScattering<N>::extinction_at(
    const SurfacePoint& point) const {
  Extinction extinction(layers_.layers.size());
  const bool is_inverted = surface_.color_use == ColorUse::invert;
  const Bands factor =
      is_inverted ? profiles_.absorption_factor(profiles_.color_at(point)) : Bands{};
  for (std::size_t i = 0; i < extinction.size(); ++i)
    extinction[i] = is_inverted ? layers_.layers[i].sigma_s + factor * absorption_[i]
                                : layers_.layers[i].sigma_t;
  return extinction;
}

template <int N>
std::size_t SingleScattering<N>::layer_at(float depth) const {
  std::size_t i = 0;
  for (float below = depth; i + 1 < layers_.layers.size(); ++i) {
    below -= layers_.layers[i].thickness[0];
    if (below < 0.0f) break;
  }
  return i;
}

template <int N>
BandValues<N> SingleScattering<N>::optical_depth(const Extinction& extinction, float depth) const {
  Bands total;
  for (std::size_t i = 0; i < layers_.layers.size() && depth > 0.0f; ++i) {
    const bool is_last = i + 1 == layers_.layers.size();
    const float here = is_last ? depth : std::min(depth, layers_.layers[i].thickness[0]);
    total += here * extinction[i];
    depth -= here;
  }
  return total;
}

template <int N>
float SingleScattering<N>::depth_at(const Extinction& extinction, float optical_depth,
                                    int band) const {
  float depth = 0.0f;
  for (std::size_t i = 0;; ++i) {
    const float thickness = layers_.layers[i].thickness[0], sigma_t = extinction[i][band];
    const float here = thickness * sigma_t;
    if (i + 1 == layers_.layers.size() || here > optical_depth)
      return sigma_t > 0.0f ? depth + optical_depth / sigma_t
                            : std::numeric_limits<float>::infinity();
    optical_depth -= here;
    depth += thickness;
  }
}

template <int N>
typename SingleScattering<N>::Event SingleScattering<N>::sample_event(const ExitPoint& exit,
                                                                      Vec2f u) const {
  const SurfacePoint& point = exit.point;
  Event event{.to_exit = refract_inside(exit.to_eye, point.normal, ior_)};
  const float cos_exit = dot(event.to_exit, point.normal);
  const Ray ray{leave_surface(point, -event.to_exit), -event.to_exit};
  if (!(dot(event.to_exit, point.geometric_normal) > 0.0f)) return event;
  const float deepest =
      cos_exit * std::min(scene_.geometry.first_hit(ray, least_distance(scene_)).distance, 1e9f);
  // A depth within the object by one band's extinction; all bands count it by their mean density.
  const Extinction extinction = extinction_at(point);
  const Bands whole = (1.0f / cos_exit) * optical_depth(extinction, deepest);
  const Bands chance = Bands::filled(1.0f) - exp_minus(whole);
  const int band = std::min(static_cast<int>(u.x * static_cast<float>(bands_)), bands_ - 1);
  if (!(chance[band] > 0.0f)) return event;
  const float optical_depth_of_event = -std::log1p(-u.y * chance[band]) * cos_exit;
  const float depth = std::min(depth_at(extinction, optical_depth_of_event, band), deepest);
  event.layer = layer_at(depth);
  event.inside = ray.origin + (depth / cos_exit) * ray.direction;
  const Bands decay = exp_minus((1.0f / cos_exit) * optical_depth(extinction, depth));
  float density = 0.0f;  // per length along the ray
  for (int b = 0; b < bands_; ++b)
    if (chance[b] > 0.0f)
      density += extinction[event.layer][b] * decay[b] / (chance[b] * static_cast<float>(bands_));
  if (!(density > 0.0f)) return event;
  const float leaving = 1.0f - reflectance(exit.boundary, exit.cos_o);
  event.throughput = (leaving / density) * layers_.layers[event.layer].sigma_s * decay;
  return event;
}

template <int N>
BandValues<N> SingleScattering<N>::way_from(const SurfacePoint& entry, float length,
                                            float cos_inside) const {
  const Bands depth = optical_depth(extinction_at(entry), length * cos_inside);
  return profiles_.entering_color(entry) * exp_minus((1.0f / cos_inside) * depth);
}

template <int N>
BandValues<N> SingleScattering<N>::next_event_radiance(const Event& event,
                                                       const LightGatherer<N>& light, float u_light,
                                                       Vec2f u) const {
  const LightSample sample = scene_.lights.sample_light(event.inside, u_light, u);
  if (!(sample.pdf > 0.0f && sample.next_event_share > 0.0f)) return {};
  const auto entry =
      is_refracted_
          ? find_refracted_entry(scene_, event.inside, material_, ior_, sample, sample.direction)
          : find_straight_entry(scene_, event.inside, material_, ior_, sample);
  if (!entry) return {};
  const SurfacePoint point = make_surface_point(scene_.scene->meshes, entry->hit, 0.0f);
  const float entering = 1.0f - reflectance(boundary_at(scene_, point), entry->cos_outside);
  const Bands way_in = way_from(point, entry->length, entry->cos_inside);
  const Bands phase = layer_phase(layers_, layers_.layers[event.layer],
                                  Bands::filled(one_minus_cos(-entry->to_surface, event.to_exit)));
  const Bands clear =
      light.shadow_transmittance({leave_surface(entry->point, entry->to_light), entry->to_light},
                                 0.9999f * entry->light_distance);
  return (sample.next_event_share * entering * entry->geometry_term / (ior_ * ior_ * sample.pdf)) *
         phase * way_in * clear * conversion_.from_rgb(sample.radiance);
}

template <int N>
BandValues<N> SingleScattering<N>::phase_sampled_radiance(const Event& event,
                                                          const LightGatherer<N>& light, Vec2f u,
                                                          PixelSamples& samples) const {
  const double cosine = sample_cos_theta(phases_[event.layer], static_cast<double>(u.x), 0.5);
  const auto cos_turn = static_cast<float>(cosine),
             one_minus_cos = static_cast<float>(1.0 - cosine);
  const float sin_turn = std::sqrt(one_minus_cos * (1.0f + cos_turn));
  const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
  // Against the light, from the event to the surface.
  const Vec3f to_surface =
      make_frame(-event.to_exit)
          .to_world({sin_turn * std::cos(phi), sin_turn * std::sin(phi), cos_turn});
  const Hit hit = scene_.geometry.first_hit({event.inside, to_surface}, 0.0f);
  if (!hit.is_hit()) return {};
  const SurfacePoint surface = make_surface_point(scene_.scene->meshes, hit, 0.0f);
  const float cos_inside = dot(to_surface, surface.smooth_normal);
  const float sin2_outside = ior_ * ior_ * (1.0f - cos_inside * cos_inside);
  if (surface.material != material_ || !(cos_inside > 0.0f) || !(sin2_outside < 1.0f)) return {};
  const float cos_outside = std::sqrt(1.0f - sin2_outside);
  const Vec3f outside =
      normalize(ior_ * to_surface + (cos_outside - ior_ * cos_inside) * surface.smooth_normal);
  if (!(dot(outside, surface.geometric_normal) > 0.0f)) return {};
  const Bands phase =
      layer_phase(layers_, layers_.layers[event.layer], Bands::filled(one_minus_cos));
  const auto density = static_cast<float>(evaluate(phases_[event.layer], cosine));
  const Bands way_in = way_from(surface, hit.distance, cos_inside);
  const float entering = 1.0f - reflectance(boundary_at(scene_, surface), cos_outside);
  return (entering / density) * phase * way_in *
         light.arriving_radiance({leave_surface(surface, outside), outside}, samples);
}

template <int N>
BandValues<N> SingleScattering<N>::once(const ExitPoint& exit, const LightGatherer<N>& light,
                                        PixelSamples& samples) const {
  const Event event = sample_event(exit, samples.next_2d());
  const float u_light = samples.next_1d();
  const Vec2f u_sample = samples.next_2d(), u_sky = samples.next_2d();
  if (!(largest(event.throughput) > 0.0f)) return {};
  return event.throughput * (next_event_radiance(event, light, u_light, u_sample) +
                             phase_sampled_radiance(event, light, u_sky, samples));
}

template <int N>
SurfacePoint SingleScattering<N>::blurred(const ExitPoint& exit, PixelSamples& samples) const {
  const ScalarParameter& blur = surface_.single_scattering_blur;
  if (!(blur.value > 0.0f)) return exit.point;
  const Vec2f u = samples.next_2d();
  const float wide = std::max(scene_.textures.scalar(blur, exit.point), 0.0f);
  const float r = wide * std::sqrt(-2.0f * std::log1p(-u.x)), phi = 2.0f * float_pi * u.y;
  const SurfacePoint near = nearby_point(scene_, material_, exit.point,
                                         {r * std::cos(phi), r * std::sin(phi)}, 4.0f * wide);
  // Not where a rim hides it from the eye.
  return dot(near.normal, exit.to_eye) > 0.0f ? near : exit.point;
}

template <int N>
BandValues<N> SingleScattering<N>::blurred_once(const ExitPoint& exit,
                                                const LightGatherer<N>& light,
                                                PixelSamples& samples) const {
  const SurfacePoint point = blurred(exit, samples);
  const float weight =
      std::clamp(scene_.textures.scalar(surface_.single_scattering_weight, exit.point), 0.0f, 1.0f);
  const ExitPoint near{point, exit.boundary, exit.cos_o, exit.to_eye};
  return weight * once(near, light, samples);
}

template <int N>
BandValues<N> SingleScattering<N>::leaving_radiance(const ExitPoint& exit,
                                                    const LightGatherer<N>& light,
                                                    PixelSamples& samples) const {
  const Bands all =
      multiple_->leaving_radiance(exit, light, samples) + blurred_once(exit, light, samples);
  const Bands once = in_even_light_.share(exit.cos_o);
  const Bands often = surface_.color_use == ColorUse::invert
                          ? profiles_.local_reflectance(exit.point)
                          : profiles_.total_leaving(profiles_.thickness_at(exit.point));
  const Bands one = Bands::filled(1.0f);
  return all / max(often + once, one);
}

template class SingleScattering<4>;
template class SingleScattering<8>;
template class SingleScattering<16>;

}  // namespace lamina
