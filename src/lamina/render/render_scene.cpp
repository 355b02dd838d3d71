// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/render_scene.h"

#include <algorithm>
#include <cmath>

#include "lamina/core/error.h"
#include "lamina/optics/fresnel.h"

namespace lamina {
namespace {

void check(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    const auto require = [&](bool holds, const char* rule) {
      if (!holds) throw InvalidInput("mesh \"" + mesh.name + "\": " + rule);
    };
    require(mesh.normals.size() == mesh.positions.size(), "every vertex needs a normal");
    require(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size(),
            "every vertex needs texture coordinates, or none");
    require(mesh.material.size() == mesh.triangles.size(), "every triangle needs a material");
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle)
        require(corner < mesh.positions.size(), "a triangle names a vertex that is not there");
    for (const std::uint32_t material : mesh.material)
      require(material < scene.materials.size(), "a triangle names a material that is not there");
  }
}

RenderScene::Boundaries make_boundaries(const SurfaceMaterial& material) {
  RenderScene::Boundaries boundaries;
  if (const auto& coat = material.coat)
    boundaries.coat = std::make_unique<BoundaryReflectance>(
        coat->ior, coat->distribution, coat->roughness.value, coat->roughness.map.has_value());
  if (const auto* subsurface = std::get_if<SubsurfaceSurface>(&material.surface)) {
    const Material& layers = subsurface->material;
    if (layers.layers.empty())
      throw InvalidInput("material \"" + material.name + "\": at least one layer is required");
    // One index for all bands: over the visible it varies by a percent, reflectance by a few.
    double ratio = 0.0;
    const auto& inside = layers.layers.front().ior;
    for (std::size_t b = 0; b < inside.size(); ++b)
      ratio += inside[b] / layers.ior_above[b] / static_cast<double>(inside.size());
    const Interface& top = layers.layers.front().top;
    boundaries.own_roughness = static_cast<float>(top.roughness);
    if (std::abs(ratio - 1.0) > 1e-4)
      boundaries.own = std::make_unique<BoundaryReflectance>(
          static_cast<float>(ratio), top.distribution, boundaries.own_roughness, false);
  }
  return boundaries;
}

}  // namespace

RenderScene::RenderScene(const Scene& from)
    : scene((check(from), &from)),
      geometry(from.meshes),
      textures(from.images),
      lights(from, geometry.box_low(), geometry.box_high()) {
  for (const SurfaceMaterial& material : from.materials) {
    boundaries.push_back(make_boundaries(material));
    has_dielectrics |= std::holds_alternative<DielectricSurface>(material.surface);
  }
}

SurfaceBoundary boundary_at(const RenderScene& scene, const SurfacePoint& point) {
  const RenderScene::Boundaries& tables = scene.boundaries[point.material];
  const SurfaceMaterial& material = scene.scene->materials[point.material];
  SurfaceBoundary boundary;
  float uncovered = 1.0f;
  if (tables.coat) {
    const float share = std::clamp(scene.textures.scalar(material.coat->weight, point), 0.0f, 1.0f);
    const float roughness =
        std::clamp(scene.textures.scalar(material.coat->roughness, point), 0.0f, 1.0f);
    boundary.add({tables.coat.get(), roughness, share});
    uncovered -= share;
  }
  if (tables.own) boundary.add({tables.own.get(), tables.own_roughness, uncovered});
  return boundary;
}

SurfacePoint surface_at(const RenderScene& scene, const Hit& hit, float footprint) {
  SurfacePoint point = make_surface_point(scene.scene->meshes, hit, footprint);
  const SurfaceMaterial& material = scene.scene->materials[point.material];
  if (material.bump || material.normal_map)
    point.normal = bent_normal(scene.textures, material, point);
  return point;
}

float clear_fraction(const RenderScene& scene, const Ray& ray, float t_far) {
  if (!scene.has_dielectrics) return scene.geometry.is_blocked(ray, 0.0f, t_far) ? 0.0f : 1.0f;
  float fraction = 1.0f, t_near = 0.0f;
  for (int surfaces = 0; surfaces < 16; ++surfaces) {
    const Hit hit = scene.geometry.first_hit(ray, t_near, t_far);
    if (!hit.is_hit()) return fraction;
    const SurfacePoint point = make_surface_point(scene.scene->meshes, hit, 0.0f);
    const auto* glass =
        std::get_if<DielectricSurface>(&scene.scene->materials[point.material].surface);
    if (!glass) return 0.0f;
    // As through a parallel plate: each face by its reflectance from outside, which equals that
    // from inside along the refracted ray.
    const float cos_i = std::min(std::abs(dot(ray.direction, point.smooth_normal)), 1.0f);
    fraction *= 1.0f - fresnel(cos_i, glass->ior);
    t_near = hit.distance + 1e-5f * std::max(hit.distance, length(point.position));
  }
  return 0.0f;
}

}  // namespace lamina
