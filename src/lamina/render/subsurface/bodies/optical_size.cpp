// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/bodies/optical_size.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"

namespace lamina {
namespace {

struct VolumeAndArea {
  double volume = 0.0, area = 0.0;  ///< [mm³, mm²]
};

/// What the closed surfaces of a mesh enclose, by the divergence theorem.
VolumeAndArea measure(const Mesh& mesh) {
  VolumeAndArea sum;
  std::vector<signed char> known;  // [material] whether it is closed, once asked for
  const Vec3f middle = mesh.positions[mesh.triangles[0][0]];  // against cancellation
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t m = mesh.material[t];
    if (m >= known.size()) known.resize(m + 1, -1);
    if (known[m] < 0) known[m] = is_closed(mesh, m) ? 1 : 0;
    if (known[m] == 0) continue;
    const auto& [i, j, k] = mesh.triangles[t];
    const Vec3f a = mesh.positions[i] - middle, b = mesh.positions[j] - middle,
                c = mesh.positions[k] - middle;
    sum.volume += static_cast<double>(dot(a, cross(b, c))) / 6.0;
    sum.area += 0.5 * static_cast<double>(length(cross(b - a, c - a)));
  }
  return sum;
}

/// Reduced optical thickness of a chord that enters and leaves by the layers.
double reduced_thickness(const LayerStack& stack, double chord) {
  double thickness = 0.0, left = 0.5 * chord;
  for (const Layer& layer : stack.layers()) {
    const double length = std::min(layer.thickness, left);
    thickness += 2.0 * length * sigma_t_prime(layer.medium);
    left -= length;
  }
  return thickness;
}

}  // namespace

std::optional<OpticalSize> optical_size(const Scene& scene, std::uint32_t material) {
  const auto& layers = std::get<SubsurfaceSurface>(scene.materials[material].surface).material;
  if (std::isfinite(layers.layers.back().thickness)) return std::nullopt;
  VolumeAndArea all;
  for (const Mesh& mesh : scene.meshes) {
    if (std::ranges::find(mesh.material, material) == mesh.material.end()) continue;
    if (!is_closed(mesh, material)) return std::nullopt;
    const VolumeAndArea body = measure(mesh);
    all.volume += std::abs(body.volume);
    all.area += body.area;
  }
  if (!(all.volume > 0.0)) return std::nullopt;
  OpticalSize found{.size = 4.0 * all.volume / all.area};
  double least = std::numeric_limits<double>::infinity();
  for (const LayerStack& stack : layer_stacks(layers))
    least = std::min(least, reduced_thickness(stack, found.size));
  found.mean_free_path = found.size / least;
  return found;
}

}  // namespace lamina
