// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/walk_refusal.h"

#include <algorithm>
#include <variant>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/render/subsurface/bodies/closed_bodies.h"

namespace lamina {
namespace {

const SubsurfaceSurface& surface_of(const Scene& scene, std::uint32_t material) {
  return std::get<SubsurfaceSurface>(scene.materials[material].surface);
}

bool is_on(const Mesh& mesh, std::uint32_t material) {
  return std::ranges::find(mesh.material, material) != mesh.material.end();
}

bool holds_medium(const SurfaceMaterial& material) {
  return std::holds_alternative<SubsurfaceSurface>(material.surface) ||
         std::holds_alternative<DielectricSurface>(material.surface);
}

bool has_one_ior(const Material& material) {
  return std::ranges::all_of(material.layers, [&](const MaterialLayer& layer) {
    return layer.ior == material.layers.front().ior;
  });
}

}  // namespace

std::optional<std::string> walk_refusal(const Scene& scene, std::uint32_t material) {
  if (auto open = openness(scene, material)) return open;
  const SubsurfaceSurface& surface = surface_of(scene, material);
  if (surface.material_maps.empty()) return std::nullopt;
  if (surface.color_use == SubsurfaceSurface::ColorUse::invert)
    return "material \"" + scene.materials[material].name +
           "\": random_walk takes maps of what it is made of, or a color that says what it "
           "absorbs, "
           "but not both";
  for (const Mesh& mesh : scene.meshes)
    if (mesh.uvs.empty() && is_on(mesh, material))
      return "mesh \"" + mesh.name + "\": the maps of material \"" +
             scene.materials[material].name + "\" need texture coordinates, but it has none";
  return std::nullopt;
}

bool has_lights_without_area(const Scene& scene) {
  return std::ranges::any_of(scene.lights, [](const Light& light) {
    return std::holds_alternative<PointLight>(light) || std::holds_alternative<SpotLight>(light) ||
           std::holds_alternative<DirectionalLight>(light);
  });
}

bool takes_walks(const Scene& scene, std::uint32_t material) {
  if (walk_refusal(scene, material)) return false;
  const Material& layers = surface_of(scene, material).material;
  const bool is_rough = layers.layers.front().top.roughness > 0.0;
  if (!is_rough && !has_one_ior(layers) && has_lights_without_area(scene)) return false;
  return std::ranges::none_of(scene.meshes, [&](const Mesh& mesh) {
    return is_on(mesh, material) && std::ranges::any_of(mesh.material, [&](std::uint32_t other) {
             return other != material && holds_medium(scene.materials[other]);
           });
  });
}

}  // namespace lamina
