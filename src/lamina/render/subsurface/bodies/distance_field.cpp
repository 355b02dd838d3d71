// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/bodies/distance_field.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "lamina/scene/surface/surface_point.h"

namespace lamina {
namespace {

constexpr float reach_in_spacings = 5.0f;
constexpr int most_marches = 250;
constexpr std::array near_in_spacings = {2.0f, 4.0f, 7.0f};  // what is near: at such offsets

}  // namespace

DistanceField::DistanceField(const RayGeometry& geometry, const std::vector<Mesh>& meshes,
                             const NodeLattice& lattice, const NodeLattice& wide_lattice)
    : geometry_(geometry),
      meshes_(meshes),
      lattice_(lattice),
      step_(reach_in_spacings * lattice.spacing() / most_marches),
      steps_(lattice.count()),
      normals_(lattice.count()),
      wide_lattice_(wide_lattice),
      near_(wide_lattice.count()) {}

int DistanceField::measure(std::size_t node) const {
  // Far inside, where all of the surface is as near, a query is slow and not needed.
  const float reach = reach_in_spacings * lattice_.spacing();
  const Hit hit = geometry_.closest_point(lattice_.position(node), reach);
  int steps = most_marches;
  if (hit.is_hit()) {
    const Vec3f n = make_bare_surface_point(meshes_, hit).smooth_normal;
    std::uint32_t packed = 0;
    for (int axis = 0; axis < 3; ++axis)
      packed |= static_cast<std::uint32_t>(std::lround(512.0f + 500.0f * n[axis])) << 10 * axis;
    normals_[node].store(packed, std::memory_order_relaxed);
    steps = std::min(steps, static_cast<int>(0.9f * hit.distance / step_));
  }
  steps_[node].store(static_cast<std::uint8_t>(steps + 1), std::memory_order_release);
  return steps + 1;
}

Vec3f DistanceField::normal_of_node(std::size_t node) const {
  (void)steps_at(node);
  const std::uint32_t packed = normals_[node].load(std::memory_order_relaxed);
  if (packed == 0) return {};
  const auto coordinate = [&](int axis) {
    return (static_cast<float>(packed >> 10 * axis & 1023u) - 512.0f) / 500.0f;
  };
  return normalize(Vec3f{coordinate(0), coordinate(1), coordinate(2)});
}

Vec3f DistanceField::nearest_normal(const Vec3f& p) const {
  return normal_of_node(lattice_.nearest(p).node);
}

FewNormals DistanceField::normals_near(const Vec3f& p) const {
  return near_.at(wide_lattice_.nearest(p).node, [&](std::size_t node) {
    FewNormals found;
    const Vec3f middle = wide_lattice_.position(node);
    const auto add = [&](const Vec3f& offset) {
      const Vec3f n = nearest_normal(middle + lattice_.spacing() * offset);
      const auto known = std::span(found.at).first(found.count);
      if (found.count < FewNormals::most && dot(n, n) > 0.0f &&
          std::ranges::all_of(known, [&](const Vec3f& k) { return differ(k, n); }))
        found.at[found.count++] = n;
    };
    add({});
    for (const float reach : near_in_spacings)
      for (int i = 0; i < 27; ++i)
        add(reach * Vec3f{static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 % 3 - 1),
                          static_cast<float>(i / 9 - 1)});
    return found;
  });
}

}  // namespace lamina
