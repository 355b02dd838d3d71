// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/scene_fingerprint.h"

#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

// Structures are taken apart by structured bindings: a new member does not compile until it is
// hashed here, too.
namespace lamina {
namespace {

/// Fowler, Noll and Vo's hash FNV-1a, by words.
class Hash {
 public:
  template <class T>
  void add(const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
      const T positive = value == T{0} ? T{0} : value;  // -0 is 0
      add_bytes(&positive, sizeof positive);
    } else {
      static_assert(std::is_integral_v<T> || std::is_enum_v<T>);
      add_bytes(&value, sizeof value);
    }
  }
  void add(const Vec2f& v) { add(v.x), add(v.y); }
  void add(const Vec3f& v) { add(v.x), add(v.y), add(v.z); }
  void add(const Vec3& v) { add(v.x), add(v.y), add(v.z); }
  void add_text(std::string_view text) {
    add(text.size());
    for (const char c : text) add(c);
  }
  template <class T>
  void add_all(const std::vector<T>& values) {
    add(values.size());
    for (const T& value : values) add(value);
  }
  template <class T, class Add>
  void add_optional(const std::optional<T>& value, const Add& add_value) {
    add(value.has_value());
    if (value) add_value(*value);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  void add_bytes(const void* data, std::size_t size) {
    std::uint64_t word = 0;
    std::memcpy(&word, data, size);
    value_ = (value_ ^ word) * 0x100000001b3u;
    value_ ^= value_ >> 29;
  }
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

void add(Hash& hash, const Mesh& mesh) {
  const auto& [name, positions, normals, uvs, triangles, material, is_closed] = mesh;
  hash.add_all(positions);
  hash.add_all(normals);
  hash.add_all(uvs);
  hash.add(triangles.size());
  for (const auto& triangle : triangles)
    for (const std::uint32_t corner : triangle) hash.add(corner);
  hash.add_all(material);
  hash.add(is_closed);
}

void add(Hash& hash, const ImageMap& map) {
  const auto& [image, repeat] = map;
  hash.add(image);
  hash.add(repeat);
}

void add(Hash& hash, const NoiseMap& map) {
  const auto& [kind, size, octaves, seed] = map;
  hash.add(kind);
  hash.add(size);
  hash.add(octaves);
  hash.add(seed);
}

void add(Hash& hash, const TextureMap& map) {
  const auto& [source, scale, offset, low, high] = map;
  hash.add(source.index());
  std::visit([&](const auto& kind) { add(hash, kind); }, source);
  hash.add(scale);
  hash.add(offset);
  hash.add(low);
  hash.add(high);
}

void add(Hash& hash, const std::optional<TextureMap>& map) {
  hash.add_optional(map, [&](const TextureMap& value) { add(hash, value); });
}

template <class Parameter>
void add_parameter(Hash& hash, const Parameter& parameter) {
  const auto& [value, map] = parameter;
  hash.add(value);
  add(hash, map);
}

void add(Hash& hash, const LayerMap& map) {
  const auto& [layer, quantity, part, terms] = map;
  hash.add(layer);
  hash.add(quantity);
  hash.add(part);
  hash.add(terms.size());
  for (const ScalarParameter& term : terms) add_parameter(hash, term);
}

void add(Hash& hash, const DiffuseSurface& surface) {
  const auto& [color] = surface;
  add_parameter(hash, color);
}

void add(Hash& hash, const SubsurfaceSurface& surface) {
  const auto& [material, color, color_use, thickness, maps] = surface;
  hash.add_text(format_material(material));
  if (material.skin)
    for (const SkinMap& map : material.skin->maps) {
      hash.add_text(map.name);
      hash.add(map.values.width);
      hash.add_all(map.values.pixels);
    }
  add_parameter(hash, color);
  hash.add(color_use);
  add_parameter(hash, thickness);
  hash.add(maps.size());
  for (const LayerMap& map : maps) add(hash, map);
}

void add(Hash& hash, const DielectricSurface& surface) {
  const auto& [ior, roughness, smoothness, distribution, scattering] = surface;
  hash.add(ior);
  add_parameter(hash, roughness);
  hash.add_optional(smoothness, [&](const ScalarParameter& value) { add_parameter(hash, value); });
  hash.add(distribution);
  hash.add(scattering);
}

void add(Hash& hash, const ThinSurface& surface) {
  const auto& [material, color, thickness] = surface;
  hash.add_text(format_material(material));
  add_parameter(hash, color);
  hash.add_optional(thickness, [&](const ScalarParameter& value) { add_parameter(hash, value); });
}

void add(Hash& hash, const Coat& coat) {
  const auto& [ior, roughness, weight, distribution] = coat;
  hash.add(ior);
  add_parameter(hash, roughness);
  add_parameter(hash, weight);
  hash.add(distribution);
}

void add(Hash& hash, const SurfaceMaterial& material) {
  const auto& [name, surface, opacity, coat, bump, normal_map] = material;
  hash.add_text(name);
  hash.add(surface.index());
  std::visit([&](const auto& kind) { add(hash, kind); }, surface);
  hash.add_optional(opacity, [&](const ScalarParameter& value) { add_parameter(hash, value); });
  hash.add_optional(coat, [&](const Coat& value) { add(hash, value); });
  add(hash, bump);
  hash.add_optional(normal_map, [&](const ImageMap& value) { add(hash, value); });
}

void add(Hash& hash, const PointLight& light) {
  const auto& [position, intensity] = light;
  hash.add(position);
  hash.add(intensity);
}

void add(Hash& hash, const DirectionalLight& light) {
  const auto& [direction, irradiance] = light;
  hash.add(direction);
  hash.add(irradiance);
}

void add(Hash& hash, const RectangleLight& light) {
  const auto& [center, edge_u, edge_v, radiance] = light;
  hash.add(center);
  hash.add(edge_u);
  hash.add(edge_v);
  hash.add(radiance);
}

void add(Hash& hash, const EnvironmentLight& light) {
  const auto& [image, scale, rotation, is_visible] = light;
  hash.add_optional(image, [&](std::size_t value) { hash.add(value); });
  hash.add(scale);
  hash.add(rotation);
  (void)is_visible;  // to the camera only
}

template <class T>
std::uint64_t hash_of(const std::vector<T>& parts) {
  Hash hash;
  hash.add(parts.size());
  for (const T& part : parts) add(hash, part);
  return hash.value();
}

void add(Hash& hash, const Light& light) {
  hash.add(light.index());
  std::visit([&](const auto& kind) { add(hash, kind); }, light);
}

void add(Hash& hash, const Image& image) {
  hash.add(image.width);
  hash.add(image.height);
  hash.add(image.channels.size());
  hash.add_all(image.pixels);
}

}  // namespace

SceneFingerprint fingerprint(const Scene& scene) {
  Hash settings;
  const auto& [spacing, max_points, irradiance_samples, error, refine] = scene.render.hierarchy;
  settings.add(spacing);
  settings.add(max_points);
  settings.add(irradiance_samples);
  settings.add(refine);
  (void)error;  // of the sum, not of the samples
  const auto& [texel, max_texels, samples_of_texel, terms] = scene.render.texture_space;
  settings.add(scene.render.method);
  settings.add(texel);
  settings.add(max_texels);
  settings.add(samples_of_texel);
  settings.add(terms);
  settings.add(scene.render.max_bounces);
  settings.add(scene.render.seed);
  return {.meshes = hash_of(scene.meshes),
          .materials = hash_of(scene.materials),
          .maps = hash_of(scene.images),
          .lights = hash_of(scene.lights),
          .settings = settings.value()};
}

std::uint64_t picture_key(const Scene& scene, const RenderOptions& options) {
  Hash hash;
  const SceneFingerprint parts = fingerprint(scene);
  for (const std::uint64_t part :
       {parts.meshes, parts.materials, parts.maps, parts.lights, parts.settings})
    hash.add(part);
  for (const Light& light : scene.lights)
    if (const auto* sky = std::get_if<EnvironmentLight>(&light)) hash.add(sky->is_visible);
  const auto& [position, look_at, up, horizontal_fov, aperture_diameter, focus_distance] =
      scene.camera;
  for (const Vec3& vector : {position, look_at, up}) hash.add(vector);
  for (const double number : {horizontal_fov, aperture_diameter, focus_distance}) hash.add(number);
  hash.add(scene.film.width);
  hash.add(scene.film.height);
  const auto& [method, orders, factors, single_scattering, profile, samples_per_pixel, noise,
               max_bounces, seed, hierarchy, texture_space, shadow_map] = scene.render;
  hash.add(method);
  hash.add(orders);
  for (const bool factor : {factors.fresnel, factors.seeliger, factors.depth, factors.phase})
    hash.add(factor);
  hash.add(single_scattering);
  hash.add(profile);
  hash.add(samples_per_pixel);
  hash.add(noise);
  hash.add(hierarchy.error);
  const auto& [resolution, lamp_views, dome_views, lookups] = shadow_map;
  for (const int number : {resolution, lamp_views, dome_views, lookups}) hash.add(number);
  (void)max_bounces, (void)seed;  // a part of parts.settings
  const auto& [exit_angle, direct_light, cache, checkpoint, resumes] = options;
  hash.add(exit_angle);
  hash.add(direct_light);
  (void)cache, (void)checkpoint, (void)resumes;  // change nothing in the picture
  return hash.value();
}

}  // namespace lamina
