// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/walk_media.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "lamina/layers/optics/rough/rough_interface.h"
#include "lamina/layers/optics/same_ior.h"
#include "lamina/render/subsurface/media/quiet_layers.h"
#include "lamina/render/subsurface/random_walk/internal/walk_boundary.h"
#include "lamina/render/subsurface/random_walk/random_walk.h"
#include "lamina/scene/description/materials_in_use.h"

namespace lamina {
namespace {

constexpr int most_bodies = 1000;  // along one ray

bool is_rough_boundary(const Interface& facets, float ior) {
  return !is_specular(make_rough_interface<double>(facets, static_cast<double>(ior), 1.0));
}

template <int N>
float ior(const MediaPlace<N>& place) {
  return place.medium->layers.own_ior(place.depth.layer);
}

}  // namespace

template <int N>
BodyMedium<N>::BodyMedium(const RenderScene& scene, const BandConversion<N>& conversion,
                          const NestedDielectrics& bodies, std::uint32_t material, bool is_quiet)
    : layers(scene, conversion, material, is_quiet),
      interior(scene, conversion, material, layers.ior(), layers.bands(),
               layers.shortest_free_path()),
      glass(std::get_if<DielectricSurface>(&scene.scene->materials[material].surface)),
      is_rough(is_rough_boundary(layers.boundary(0), layers.ior())),
      has_neighbors(bodies.is_near_others(material)),
      is_homogeneous(layers.by_depth().count() == 1 && !layers.has_maps() && !is_rough &&
                     !has_neighbors),
      next_event(interior, is_homogeneous) {
  if (is_homogeneous) make_field();
  if (is_quiet && layers.has_maps()) even_layers = layers.with_even_scattering();
  if (!is_homogeneous && !is_rough && !glass) make_depth_radiance(interior.region());
}

template <int N>
void BodyMedium<N>::make_field() {
  field = std::make_unique<RadianceField<N>>(interior, next_event, layers.medium(0),
                                             layers.mean_cosine(0));
  light_vertices = std::make_unique<LightVertices<N>>(interior, next_event, layers);
}

template <int N>
void BodyMedium<N>::make_depth_radiance(const Box& region) {
  depth_radiance = std::make_unique<DepthRadiance<N>>(interior, next_event, layers, region);
}

template <int N>
void BodyMedium<N>::narrow_to(std::span<const SurfacePoint> seen) {
  constexpr float margin_in_free_paths = 6.0f;  // of the band whose light goes farthest
  if (depth_radiance) {
    constexpr float margin_in_shortest = 20.0f;
    const Box near = box_around(seen, margin_in_shortest * layers.shortest_reduced_free_path());
    Box region = interior.region();
    for (int axis = 0; axis < 3; ++axis) {
      region.low[axis] = std::clamp(near.low[axis], region.low[axis], region.high[axis]);
      region.high[axis] = std::clamp(near.high[axis], region.low[axis], region.high[axis]);
    }
    make_depth_radiance(region);
  }
  if (!is_homogeneous) return;
  const WalkMedium<N>& medium = layers.medium(0);
  const BandValues<N> reduced = medium.sigma_t - layers.mean_cosine(0) * medium.sigma_s;
  const float least = *std::min_element(reduced.v, reduced.v + layers.bands());
  interior.narrow_to(box_around(seen, margin_in_free_paths / std::max(least, 1e-6f)));
  make_field();
}

template <int N>
WalkMedia<N>::WalkMedia(const RenderScene& scene, const BandConversion<N>& conversion,
                        bool are_quiet)
    : scene_(scene),
      conversion_(conversion),
      bodies_(scene),
      of_material_(scene.scene->materials.size()) {
  const std::vector<bool> is_used = materials_in_use(*scene.scene);
  for (std::uint32_t i = 0; i < of_material_.size(); ++i) {
    if (!is_used[i]) continue;
    const auto& surface = scene.scene->materials[i].surface;
    // Paths meet dielectrics within or beside translucent bodies only.
    if (std::holds_alternative<SubsurfaceSurface>(surface) ||
        (std::holds_alternative<DielectricSurface>(surface) && bodies_.is_near_others(i)))
      of_material_[i] = std::make_unique<BodyMedium<N>>(
          scene, conversion, bodies_, i,
          are_quiet && std::holds_alternative<SubsurfaceSurface>(surface) &&
              is_better_quiet(std::get<SubsurfaceSurface>(surface)));
    has_maps_ = has_maps_ || (of_material_[i] && of_material_[i]->layers.has_maps());
  }
}

template <int N>
const BodyMedium<N>* WalkMedia<N>::medium_in(const InteriorList& interior) const {
  const std::uint32_t mesh = bodies_.highest_priority(interior);
  return mesh == NestedDielectrics::none ? nullptr : of_material_[bodies_.material_of(mesh)].get();
}

template <int N>
MediaPlace<N> WalkMedia<N>::place(const InteriorList& interior, const Vec3f& position,
                                  const MediaPlace<N>& near) const {
  MediaPlace<N> place{.interior = interior, .medium = medium_in(interior)};
  if (place.medium)
    place.depth = place.medium->layers.by_depth().at(
        position, near.medium == place.medium ? near.depth : DepthLayers::Place());
  return place;
}

template <int N>
std::optional<typename WalkMedia<N>::Entry> WalkMedia<N>::sample_entry(
    const ExitPoint& exit, std::uint32_t material, PixelSamples& samples) const {
  Entry entry{.place = {.medium = of_material(material)}};
  if (!entry.place.medium->is_homogeneous) {
    const NestedDielectrics::Crossing crossing = bodies_.cross({}, exit.point, -exit.to_eye);
    entry.place = place(crossing.beyond, exit.point.position);
    if (crossing.is_blocked || !entry.place.medium) return std::nullopt;
  }
  const WalkLayers<N>& layers = entry.place.medium->layers;
  entry.inward = lamina::sample_entry(exit.to_eye, exit.point.normal, layers.ior(),
                                      layers.boundary(0), samples);
  if (!(dot(entry.inward, exit.point.geometric_normal) < 0.0f)) return std::nullopt;
  return entry;
}

template <int N>
typename WalkMedia<N>::Surface WalkMedia<N>::next_surface(const Ray& ray,
                                                          const MediaPlace<N>& start, float t_near,
                                                          float t_far) const {
  Surface surface;
  surface.hit = scene_.geometry.first_hit(ray, t_near, t_far);
  if (!surface.hit.is_hit()) return surface;
  surface.point = make_bare_surface_point(scene_.scene->meshes, surface.hit);
  surface.crossing = bodies_.cross(start.interior, surface.point, ray.direction);
  if (surface.crossing.is_blocked) return surface;
  surface.beyond = place(surface.crossing.beyond, surface.point.position);
  surface.passes = surface.beyond.medium && is_same_ior(ior(surface.beyond), ior(start));
  return surface;
}

template <int N>
template <class OnBody>
void WalkMedia<N>::for_bodies(const Ray& ray, const MediaPlace<N>& start, float length, int events,
                              const OnBody& on_body) const {
  const auto add = [&](const MediaPlace<N>& here, float begin, float end) {
    const WalkLayers<N>& layers = here.medium->layers_after(events);
    const Vec3f from = ray.origin + begin * ray.direction, to = ray.origin + end * ray.direction;
    on_body(layers, Ray{from, ray.direction}, here.depth, end - begin,
            layers.by_depth().at(to, here.depth));
  };
  if (!start.medium->has_neighbors) return add(start, 0.0f, length);
  MediaPlace<N> here = start;
  float begin = 0.0f, t_near = 0.0f;
  for (int i = 0; i < most_bodies; ++i) {
    const Surface surface = next_surface(ray, here, t_near, length);
    add(here, begin, std::min(surface.hit.distance, length));
    if (!surface.passes) break;
    begin = surface.hit.distance;
    t_near = distance_behind(surface.hit, surface.point);
    here = surface.beyond;
  }
}

template <int N>
BandValues<N> WalkMedia<N>::optical_thickness(const Ray& ray, const MediaPlace<N>& start,
                                              float length, int events) const {
  Bands sum;
  for_bodies(ray, start, length, events, [&](const WalkLayers<N>& layers, const auto&... segment) {
    sum += layers.optical_thickness(segment...);
  });
  return sum;
}

template <int N>
BandValues<N> WalkMedia<N>::sample_residual(const Ray& ray, const MediaPlace<N>& start,
                                            float length, int events, Random& random) const {
  Bands ratio = Bands::filled(1.0f);
  if (has_maps_)
    for_bodies(ray, start, length, events,
               [&](const WalkLayers<N>& layers, const auto&... segment) {
                 ratio *= layers.sample_residual(segment..., random);
               });
  return ratio;
}

template <int N>
std::optional<BoundaryHit> WalkMedia<N>::find_boundary(const Ray& ray,
                                                       const MediaPlace<N>& start) const {
  MediaPlace<N> here = start;
  float t_near = 0.0f;
  for (int i = 0; i < most_bodies; ++i) {
    const Surface surface = next_surface(ray, here, t_near, std::numeric_limits<float>::infinity());
    if (!surface.hit.is_hit() || surface.crossing.is_blocked) return std::nullopt;
    if (!surface.beyond.medium) {
      if (here.medium->is_rough || !(dot(surface.point.geometric_normal, ray.direction) > 0.0f))
        return std::nullopt;
      return BoundaryHit{surface.point, surface.hit};
    }
    if (!surface.passes) return std::nullopt;
    t_near = distance_behind(surface.hit, surface.point);
    here = surface.beyond;
  }
  return std::nullopt;
}

template <int N>
DielectricScattering WalkMedia<N>::boundary(const MediaPlace<N>& here, const Surface& surface,
                                            const Vec3f& direction) const {
  const MediaPlace<N>& beyond = surface.beyond;
  const float eta = beyond.medium ? ior(beyond) / ior(here) : 1.0f / here.medium->layers.ior();
  InteriorList both = here.interior;
  for (int i = 0; i < surface.crossing.beyond.count; ++i)
    both.add(surface.crossing.beyond.bodies[static_cast<std::size_t>(i)].mesh, 1);
  const BodyMedium<N>& owner = *medium_in(both);
  if (!owner.glass) return facet_scattering(eta, owner.layers.boundary(0));
  // Maps follow the texture coordinates of the owner's mesh.
  const std::uint32_t mesh = bodies_.highest_priority(both);
  Hit hit = surface.hit;
  if (hit.mesh != mesh)
    for (const Hit& other : bodies_.coincident_hits(surface.point, direction).all())
      if (other.mesh == mesh) hit = other;
  DielectricScattering scattering = dielectric_at(
      scene_.textures, *owner.glass, make_surface_point(scene_.scene->meshes, hit, 0.0f), false);
  scattering.interface.eta = static_cast<double>(eta);
  return scattering;
}

template struct BodyMedium<4>;
template struct BodyMedium<8>;
template struct BodyMedium<16>;
template class WalkMedia<4>;
template class WalkMedia<8>;
template class WalkMedia<16>;

}  // namespace lamina
