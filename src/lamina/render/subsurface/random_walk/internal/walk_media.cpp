// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/walk_media.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lamina/optics/rough/rough_interface.h"
#include "lamina/optics/same_ior.h"

namespace lamina {
namespace {

constexpr int most_bodies = 1000;  // on one way

template <int N>
float ior(const MediaPlace<N>& place) {
  return place.medium->layers.own_ior(place.depth.layer);
}

}  // namespace

template <int N>
BodyMedium<N>::BodyMedium(const RenderScene& scene, const BandConversion<N>& conversion,
                          const WalkBodies& bodies, std::uint32_t material)
    : layers(scene, conversion, material),
      space(scene, conversion, material, layers.ior(), layers.bands(), layers.shortest_free_path()),
      // Nothing is asked of what lamps send beforehand: a lattice as coarse as can be.
      lamps(space, layers.medium(0).sigma_t, layers.medium(0).sigma_t, 1e6f),
      is_rough(!is_specular(make_rough_interface<double>(layers.boundary(0),
                                                         static_cast<double>(layers.ior()), 1.0))),
      has_neighbors(bodies.is_near_others(material)) {}

template <int N>
WalkMedia<N>::WalkMedia(const RenderScene& scene, const BandConversion<N>& conversion)
    : scene_(scene),
      conversion_(conversion),
      bodies_(scene),
      of_material_(scene.scene->materials.size()) {
  for (std::uint32_t m = 0; m < scene.scene->meshes.size(); ++m) {
    const std::uint32_t material = bodies_.material_of(m);
    if (material == WalkBodies::none || of_material_[material]) continue;
    of_material_[material] = std::make_unique<BodyMedium<N>>(scene, conversion, bodies_, material);
  }
}

template <int N>
const BodyMedium<N>* WalkMedia<N>::filling(const WalkHolders& holders) const {
  const std::uint32_t mesh = bodies_.filling(holders);
  return mesh == WalkBodies::none ? nullptr : of_material_[bodies_.material_of(mesh)].get();
}

template <int N>
MediaPlace<N> WalkMedia<N>::place(const WalkHolders& holders, const Vec3f& position) const {
  MediaPlace<N> place{.holders = holders, .medium = filling(holders)};
  if (place.medium) place.depth = place.medium->layers.by_depth().at(position);
  return place;
}

template <int N>
typename WalkMedia<N>::Surface WalkMedia<N>::next_surface(const Ray& way,
                                                          const MediaPlace<N>& start, float t_near,
                                                          float t_far) const {
  Surface surface;
  surface.hit = scene_.geometry.first_hit(way, t_near, t_far);
  if (!surface.hit.is_hit()) return surface;
  surface.point = make_bare_surface_point(scene_.scene->meshes, surface.hit);
  surface.crossing = bodies_.cross(start.holders, surface.point, way.direction);
  if (surface.crossing.is_blocked) return surface;
  surface.beyond = place(surface.crossing.beyond, surface.point.position);
  surface.passes = surface.beyond.medium && is_same_ior(ior(surface.beyond), ior(start));
  return surface;
}

template <int N>
BandValues<N> WalkMedia<N>::optical_thickness(const Ray& way, const MediaPlace<N>& start,
                                              float length) const {
  if (!start.medium->has_neighbors)
    return start.medium->layers.optical_thickness(way, start.depth, length);
  MediaPlace<N> here = start;
  Bands sum;
  float begin = 0.0f, t_near = 0.0f;
  for (int i = 0; i < most_bodies; ++i) {
    const Surface surface = next_surface(way, here, t_near, length);
    const Vec3f from = way.origin + begin * way.direction;
    sum += here.medium->layers.optical_thickness({from, way.direction}, here.depth,
                                                 std::min(surface.hit.distance, length) - begin);
    if (!surface.passes) break;
    begin = surface.hit.distance;
    t_near = distance_behind(surface.hit, surface.point);
    here = surface.beyond;
  }
  return sum;
}

template <int N>
std::optional<BoundaryHit> WalkMedia<N>::find_boundary(const Ray& way,
                                                       const MediaPlace<N>& start) const {
  MediaPlace<N> here = start;
  float t_near = 0.0f;
  for (int i = 0; i < most_bodies; ++i) {
    const Surface surface = next_surface(way, here, t_near, std::numeric_limits<float>::infinity());
    if (!surface.hit.is_hit() || surface.crossing.is_blocked) return std::nullopt;
    if (!surface.beyond.medium) {
      if (here.medium->is_rough || !(dot(surface.point.geometric_normal, way.direction) > 0.0f))
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
const Interface& WalkMedia<N>::facets(const MediaPlace<N>& here, const Surface& surface) const {
  WalkHolders both = here.holders;
  for (int i = 0; i < surface.crossing.beyond.count; ++i)
    both.add(surface.crossing.beyond.each[static_cast<std::size_t>(i)].mesh, 1);
  return filling(both)->layers.boundary(0);
}

template struct BodyMedium<4>;
template struct BodyMedium<8>;
template struct BodyMedium<16>;
template class WalkMedia<4>;
template class WalkMedia<8>;
template class WalkMedia<16>;

}  // namespace lamina
