// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/geometry/nearest_pixel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lamina/base/core/vec.h"

namespace lamina {

float nearest_pixel(const Scene& scene, const CameraRays& camera, std::uint32_t material) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.material[t] != material) continue;
      for (const std::uint32_t corner : mesh.triangles[t]) {
        const Vec3 offset = to_double(mesh.positions[corner]) - scene.camera.position;
        nearest = std::min(nearest, dot(offset, offset));
      }
    }
  return nearest < std::numeric_limits<double>::infinity()
             ? camera.pixel_angle() * static_cast<float>(std::sqrt(nearest))
             : 0.0f;
}

}  // namespace lamina
