// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "lamina/render/render.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// A square in the plane z = 0, facing +z.
inline Mesh make_square(float size, std::uint32_t material = 0) {
  const float h = 0.5f * size;
  return {.name = "square",
          .positions = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}},
          .normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
          .uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
          .triangles = {{0, 1, 2}, {0, 2, 3}},
          .material = {material, material}};
}

/// A closed box under the square in the plane z = 0, without its sides: they are too far to be
/// seen.
inline Mesh make_plate(float width, float thickness) {
  Mesh plate = make_square(width);
  for (std::size_t i = 0; i < 4; ++i) {
    plate.positions.push_back(plate.positions[i] - Vec3f{0, 0, thickness});
    plate.normals.push_back({0, 0, -1});
    plate.uvs.push_back(plate.uvs[i]);
  }
  plate.triangles.push_back({4, 6, 5});
  plate.triangles.push_back({4, 7, 6});
  plate.material.assign(4, 0);
  plate.is_closed = true;
  return plate;
}

/// A closed cube around the origin, with sharp edges.
inline Mesh make_cube(float side) {
  Mesh cube{.name = "cube"};
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {-1.0f, 1.0f}) {
      Vec3f n, u, v;
      n[axis] = sign;
      u[(axis + 1) % 3] = sign;
      v[(axis + 2) % 3] = 1.0f;
      const auto first = static_cast<std::uint32_t>(cube.positions.size());
      for (const auto& [a, b] :
           {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}}) {
        cube.positions.push_back(0.5f * side * (n + a * u + b * v));
        cube.normals.push_back(n);
        cube.uvs.push_back({0.5f + 0.5f * a, 0.5f + 0.5f * b});
      }
      cube.triangles.push_back({first, first + 1, first + 2});
      cube.triangles.push_back({first, first + 2, first + 3});
    }
  cube.material.assign(12, 0);
  cube.is_closed = true;
  return cube;
}

/// A sphere around the origin.
inline Mesh make_sphere(float radius, int rings = 48, std::uint32_t material = 0) {
  Mesh mesh{.name = "sphere"};
  const int sectors = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j <= sectors; ++j) {
      const float theta =
          std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(rings);
      const float phi =
          2.0f * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(sectors);
      const Vec3f n{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                    std::cos(theta)};
      mesh.positions.push_back(radius * n);
      mesh.normals.push_back(n);
      mesh.uvs.push_back({static_cast<float>(j) / static_cast<float>(sectors),
                          1.0f - static_cast<float>(i) / static_cast<float>(rings)});
    }
  const auto index = [&](int i, int j) {
    return static_cast<std::uint32_t>(i * (sectors + 1) + j);
  };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      if (i > 0) mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i, j + 1)});
      if (i + 1 < rings)
        mesh.triangles.push_back({index(i, j + 1), index(i + 1, j), index(i + 1, j + 1)});
    }
  mesh.material.assign(mesh.triangles.size(), material);
  return mesh;
}

/// A camera far away that sees a square of `size` mm around the origin from above, +y up.
inline Camera camera_above(double size) {
  const double distance = 100.0 * size;
  return {.position = {0, 0, distance},
          .look_at = {0, 0, 0},
          .up = {0, 1, 0},
          .horizontal_fov = 2.0 * std::atan(0.5 * size / distance)};
}

inline SurfaceMaterial diffuse_material(float reflectance) {
  return {.name = "diffuse",
          .surface = DiffuseSurface{.color = {.value = {reflectance, reflectance, reflectance}}}};
}

/// Mean of a channel over all pixels.
inline double mean_of(const Image& image, std::size_t channel) {
  double total = 0.0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) total += static_cast<double>(image.at(x, y)[channel]);
  return total / (image.width * image.height);
}

inline constexpr double infinite = std::numeric_limits<double>::infinity();

/// By RGB [1/mm, mm].
inline MaterialLayer layer_of(std::vector<double> sigma_a, std::vector<double> sigma_s, double g,
                              double thickness, double ior = 1.4) {
  return {.name = "layer",
          .sigma_a = std::move(sigma_a),
          .sigma_s = std::move(sigma_s),
          .g = {g, g, g},
          .ior = {ior, ior, ior},
          .thickness = thickness};
}

/// In air, over the medium of its last layer.
inline Material material_of(std::vector<MaterialLayer> layers) {
  Material material{.name = "test", .ior_above = {1, 1, 1}, .ior_below = layers.back().ior};
  material.layers = std::move(layers);
  return material;
}

/// One layer, isotropic and infinitely thick, by RGB [1/mm].
inline Material half_space(std::vector<double> sigma_a, double sigma_s, double ior) {
  return material_of(
      {layer_of(std::move(sigma_a), {sigma_s, sigma_s, sigma_s}, 0.0, infinite, ior)});
}

/// By diffusion, at once, for methods that take a profile; others refuse one.
inline std::optional<RenderSettings::Profile> quick_profile(RenderSettings::Method method) {
  if (method.is_open() || !method->uses_profile) return std::nullopt;
  return RenderSettings::Profile::diffusion;
}

/// A mesh of the material, seen from above as a square of half a millimetre; no light between
/// surfaces.
inline Scene translucent_scene(RenderSettings::Method method, Mesh mesh, Material material,
                               Light light) {
  Scene scene;
  scene.camera = camera_above(0.5);
  scene.film = {.width = 4, .height = 4};
  scene.render = {.method = method, .profile = quick_profile(method), .samples_per_pixel = 4};
  scene.render.max_bounces = 0;
  scene.materials = {
      {.name = "translucent",
       .surface = SubsurfaceSurface{.material = std::move(material), .thickness = {.value = 0}}}};
  scene.meshes = {std::move(mesh)};
  scene.lights = {std::move(light)};
  return scene;
}

}  // namespace lamina
