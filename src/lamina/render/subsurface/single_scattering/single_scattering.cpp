// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/single_scattering/single_scattering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "lamina/optics/henyey_greenstein.h"
#include "lamina/render/shading/refracted_entry.h"
#include "lamina/scattering/layered_bsdf/first_order.h"

namespace lamina {
namespace {

template <int N>
FirstOrderStack<BandValues<N>> layers_of(const Material& material) {
  std::vector<LayerStack> bands;
  for (std::size_t b = 0; b < material.bands.size(); ++b) bands.push_back(layer_stack(material, b));
  return make_first_order<N>(bands);
}

float mean_ior(const Material& material) {
  double sum = 0.0;
  for (std::size_t b = 0; b < material.bands.size(); ++b)
    sum += material.layers.front().ior[b] / material.ior_above[b];
  return static_cast<float>(sum / static_cast<double>(material.bands.size()));
}

}  // namespace

template <int N>
SingleScattering<N>::SingleScattering(const RenderScene& scene, const BandConversion<N>& conversion,
                                      std::uint32_t material, bool is_refracted,
                                      std::unique_ptr<SubsurfaceMethod<N>> multiple)
    : scene_(scene),
      conversion_(conversion),
      material_(material),
      is_refracted_(is_refracted),
      multiple_(std::move(multiple)) {
  const Material& layers =
      std::get<SubsurfaceSurface>(scene.scene->materials[material].surface).material;
  bands_ = static_cast<int>(layers.bands.size());
  ior_ = mean_ior(layers);
  layers_ = layers_of<N>(layers);
  const LayerStack middle = layer_stack(layers, layers.bands.size() / 2);
  for (const Layer& layer : middle.layers()) phases_.push_back(phase_function(layer));
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
BandValues<N> SingleScattering<N>::optical_depth(float depth) const {
  Bands total;
  for (std::size_t i = 0; i < layers_.layers.size() && depth > 0.0f; ++i) {
    const bool is_last = i + 1 == layers_.layers.size();
    const float here = is_last ? depth : std::min(depth, layers_.layers[i].thickness[0]);
    total += here * layers_.layers[i].sigma_t;
    depth -= here;
  }
  return total;
}

template <int N>
float SingleScattering<N>::depth_at(float optical_depth, int band) const {
  float depth = 0.0f;
  for (std::size_t i = 0;; ++i) {
    const auto& layer = layers_.layers[i];
    const float here = layer.thickness[0] * layer.sigma_t[band];
    if (i + 1 == layers_.layers.size() || here > optical_depth)
      return layer.sigma_t[band] > 0.0f ? depth + optical_depth / layer.sigma_t[band]
                                        : std::numeric_limits<float>::infinity();
    optical_depth -= here;
    depth += layer.thickness[0];
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
  const Bands whole = (1.0f / cos_exit) * optical_depth(deepest);
  const Bands chance = Bands::filled(1.0f) - exp_minus(whole);
  const int band = std::min(static_cast<int>(u.x * static_cast<float>(bands_)), bands_ - 1);
  if (!(chance[band] > 0.0f)) return event;
  const float optical_depth_of_event = -std::log1p(-u.y * chance[band]) * cos_exit;
  const float depth = std::min(depth_at(optical_depth_of_event, band), deepest);
  event.layer = layer_at(depth);
  event.inside = ray.origin + (depth / cos_exit) * ray.direction;
  const auto& layer = layers_.layers[event.layer];
  const Bands decay = exp_minus((1.0f / cos_exit) * optical_depth(depth));
  float density = 0.0f;  // per length along the ray
  for (int b = 0; b < bands_; ++b)
    if (chance[b] > 0.0f)
      density += layer.sigma_t[b] * decay[b] / (chance[b] * static_cast<float>(bands_));
  if (!(density > 0.0f)) return event;
  const float leaving = 1.0f - reflectance(exit.boundary, exit.cos_o);
  event.throughput = (leaving / density) * layer.sigma_s * decay;
  return event;
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
  const float entering = 1.0f - reflectance(boundary_at(scene_, entry->point), entry->cos_outside);
  const Bands way_in =
      exp_minus((1.0f / entry->cos_inside) * optical_depth(entry->length * entry->cos_inside));
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
  const Bands way_in = exp_minus((1.0f / cos_inside) * optical_depth(hit.distance * cos_inside));
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

template class SingleScattering<4>;
template class SingleScattering<8>;
template class SingleScattering<16>;

}  // namespace lamina
