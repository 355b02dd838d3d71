// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/bodies/closed_bodies.h"

#include <algorithm>
#include <limits>
#include <sstream>
#include <string>

namespace lamina {

Box box_of_material(const Scene& scene, std::uint32_t material) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.material[t] == material)
        for (const std::uint32_t vertex : mesh.triangles[t])
          for (int axis = 0; axis < 3; ++axis) {
            box.low[axis] = std::min(box.low[axis], mesh.positions[vertex][axis]);
            box.high[axis] = std::max(box.high[axis], mesh.positions[vertex][axis]);
          }
  return box.low.x <= box.high.x ? box : Box{};
}

Box box_around(std::span<const SurfacePoint> points, float margin) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const SurfacePoint& point : points)
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], point.position[axis] - margin);
      box.high[axis] = std::max(box.high[axis], point.position[axis] + margin);
    }
  return box;
}

namespace {

/// `part "scalp, hair" is open: 12 edges do not join two faces, the first at (1, 2, 3) mm`.
std::string what_is_open(const Mesh& mesh, std::uint32_t material) {
  std::size_t others = 0;
  const OpenPart* first = nullptr;
  for (const OpenPart& part : mesh.open_parts) {
    if (std::ranges::find(part.materials, material) == part.materials.end()) continue;
    if (first) ++others;
    if (!first) first = &part;
  }
  if (!first) return "this one is open";
  std::ostringstream text;
  text << (first->name.empty() ? "this one" : "part \"" + first->name + "\"")
       << " is open: " << first->edges << (first->edges == 1 ? " edge does" : " edges do")
       << " not join two faces, the first at (" << first->place.x << ", " << first->place.y << ", "
       << first->place.z << ") mm";
  if (others > 0) text << ", and so " << (others == 1 ? "is " : "are ") << others << " more";
  return text.str();
}

}  // namespace

std::optional<std::string> openness(const Scene& scene, std::uint32_t material) {
  for (const Mesh& mesh : scene.meshes)
    if (std::ranges::find(mesh.material, material) != mesh.material.end() &&
        !is_closed(mesh, material))
      return "mesh \"" + mesh.name +
             "\": random_walk needs a closed surface, with an inside that light can walk in, but " +
             what_is_open(mesh, material) +
             "; close it, give it another material or use another method";
  return std::nullopt;
}

}  // namespace lamina
