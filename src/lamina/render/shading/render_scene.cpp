// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/shading/render_scene.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/scene/description/material_layer_maps.h"
#include "lamina/scene/description/materials_in_use.h"

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

using BoundaryTable = std::shared_ptr<const BoundaryReflectance>;

BoundaryTable make_table(KeptParts* kept, float ior, MicrofacetDistribution distribution,
                         float roughness, bool is_mapped) {
  Hash hash;
  hash.add(ior);
  hash.add(distribution);
  hash.add(roughness);
  hash.add(is_mapped);
  return kept_or_made<BoundaryReflectance>(
             kept, KeptPart::boundary, hash.value() >> 8, hash.value(),
             [&] {
               return std::make_shared<const BoundaryReflectance>(ior, distribution, roughness,
                                                                  is_mapped);
             })
      .part;
}

/// The triangles ready for rays, and the meshes that they are of.
struct GeometryOfMeshes {
  std::vector<Mesh> meshes;
  RayGeometry geometry{meshes};
};

/// @param meshes  set to what the geometry needs beside the scene
RayGeometry make_geometry(const Scene& scene, KeptParts* kept,
                          std::shared_ptr<const void>& meshes) {
  if (!kept) return RayGeometry(scene.meshes);
  const auto found = kept->get<GeometryOfMeshes>(KeptPart::geometry, 0, 0, [&] {
    return std::shared_ptr<const GeometryOfMeshes>(new GeometryOfMeshes{scene.meshes});
  });
  meshes = found.part;
  return found.part->geometry;
}

Lights make_lights(const Scene& scene, const RayGeometry& geometry, KeptParts* kept) {
  const auto make = [&] { return Lights(scene, geometry.box_low(), geometry.box_high()); };
  if (!kept) return make();
  return *kept
              ->get<Lights>(KeptPart::lights, 0, 0,
                            [&] { return std::make_shared<const Lights>(make()); })
              .part;
}

/// The boundary of a layer towards the outside; none if the indices are equal.
BoundaryTable make_boundary(const MaterialLayer& layer, const std::vector<double>& ior_outside,
                            const Interface& interface, KeptParts* kept) {
  // One index for all bands: over the visible it varies by a percent, reflectance by a few.
  double ratio = 0.0;
  for (std::size_t b = 0; b < layer.ior.size(); ++b)
    ratio += layer.ior[b] / ior_outside[b] / static_cast<double>(layer.ior.size());
  if (std::abs(ratio - 1.0) <= 1e-4) return nullptr;
  return make_table(kept, static_cast<float>(ratio), interface.distribution,
                    static_cast<float>(interface.roughness), false);
}

RenderScene::Boundaries make_boundaries(const SurfaceMaterial& material, KeptParts* kept) {
  RenderScene::Boundaries boundaries;
  if (const auto& coat = material.coat)
    boundaries.coat = make_table(kept, coat->ior, coat->distribution, coat->roughness.value,
                                 coat->roughness.map.has_value() || coat->second.has_value());
  for (const Covering& covering : coverings_of(material)) {
    if (covering.material.layers.empty())
      throw InvalidInput("material \"" + material.name + "\": over \"" + covering.name +
                         "\": at least one layer is required");
    const MaterialLayer& layer = covering.material.layers.front();
    const Interface top = specular_top(covering.material);
    boundaries.over.push_back({make_boundary(layer, covering.material.ior_above, top, kept),
                               static_cast<float>(top.roughness)});
  }
  const auto* subsurface = std::get_if<SubsurfaceSurface>(&material.surface);
  const auto* thin = std::get_if<ThinSurface>(&material.surface);
  if (!subsurface && !thin) return boundaries;
  const Material& layers = subsurface ? subsurface->material : thin->material;
  if (layers.layers.empty())
    throw InvalidInput("material \"" + material.name + "\": at least one layer is required");
  const Interface top = specular_top(layers);
  boundaries.own = make_boundary(layers.layers.front(), layers.ior_above, top, kept);
  boundaries.own_roughness = static_cast<float>(top.roughness);
  if (std::isfinite(layers.layers.back().thickness)) {
    const Interface& bottom = layers.ground.top;
    boundaries.own_below = make_boundary(layers.layers.back(), layers.ior_below, bottom, kept);
    boundaries.own_roughness_below = static_cast<float>(bottom.roughness);
  }
  return boundaries;
}

}  // namespace

RenderScene::RenderScene(const Scene& from, const RenderSettings& how, KeptParts* parts)
    : scene((check(from), &from)),
      settings(how),
      kept(parts),
      geometry(make_geometry(from, kept, meshes_of_geometry)),
      textures(from.images),
      lights(make_lights(from, geometry, kept)),
      boundaries(from.materials.size()),
      layer_maps(from.materials.size()) {
  const std::vector<bool> is_used = materials_in_use(from);
  for (std::size_t m = 0; m < boundaries.size(); ++m) {
    if (!is_used[m]) continue;
    const SurfaceMaterial& material = from.materials[m];
    boundaries[m] = make_boundaries(material, kept);
    has_clear_surfaces |= std::holds_alternative<DielectricSurface>(material.surface) ||
                          std::holds_alternative<ThinSurface>(material.surface) ||
                          material.opacity.has_value();
    if (const auto* surface = std::get_if<SubsurfaceSurface>(&material.surface);
        surface && settings.method == RenderSettings::Method::layered_bsdf) {
      layer_maps[m] = surface->maps;
      for (const MaterialMap& map : surface->material_maps)
        layer_maps[m].push_back(layer_map(map, material.name, textures.add(map.values)));
    }
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
    float second = 0.0f;
    if (const auto& lobe = material.coat->second) {
      second = share * std::clamp(scene.textures.scalar(lobe->share, point), 0.0f, 1.0f);
      boundary.add({tables.coat.get(),
                    std::clamp(scene.textures.scalar(lobe->roughness, point), 0.0f, 1.0f), second});
    }
    boundary.add({tables.coat.get(), roughness, share - second});
    uncovered -= share;
  }
  if (!tables.over.empty() && !point.is_below) {
    const std::span<const Covering> over = coverings_of(material);
    for (std::size_t i = over.size(); i-- > 0;) {  // the last one is on top
      const float covered =
          uncovered * std::clamp(scene.textures.scalar(over[i].coverage, point), 0.0f, 1.0f);
      if (const auto& top = tables.over[i]; top.table)
        boundary.add({top.table.get(), top.roughness, covered});
      uncovered -= covered;
    }
  }
  if (const auto& own = point.is_below ? tables.own_below : tables.own)
    boundary.add(
        {own.get(), point.is_below ? tables.own_roughness_below : tables.own_roughness, uncovered});
  return boundary;
}

SurfacePoint surface_at(const RenderScene& scene, const Hit& hit, float footprint) {
  SurfacePoint point = make_surface_point(scene.scene->meshes, hit, footprint);
  const SurfaceMaterial& material = scene.scene->materials[point.material];
  if (material.bump || material.normal_map)
    point.normal = bent_normal(scene.textures, material, point);
  return point;
}

}  // namespace lamina
