// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/film/scene_fingerprint.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "lamina/base/core/hash.h"
#include "lamina/base/io/file_bytes.h"
#include "render_fingerprint.h"

// Structures are taken apart by structured bindings: a new member does not compile until it is
// hashed here, too.
namespace lamina {
namespace {

/// Of a part of a scene: of all of it, or of what counts for the light that enters surfaces.
class SceneHash : public Hash {
 public:
  explicit SceneHash(bool light_alone) : is_of_light(light_alone) {}
  const bool is_of_light;

  using Hash::add;
  void add(const Vec2f& v) { add(v.x), add(v.y); }
  void add(const Vec3f& v) { add(v.x), add(v.y), add(v.z); }
  void add(const Vec3& v) { add(v.x), add(v.y), add(v.z); }
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
};

/// A hash of many numbers, in four rows side by side: each step of one waits for the last.
std::uint64_t hash_of_many(std::span<const float> values) {
  std::array<Hash, 4> rows;
  const std::size_t part = (values.size() + 7) / 8 * 2;  // whole words of two numbers
  std::array<std::span<const float>, 4> parts;
  for (std::size_t r = 0; r < 4; ++r) {
    const std::size_t begin = std::min(r * part, values.size());
    parts[r] = values.subspan(begin, std::min(part, values.size() - begin));
  }
  const std::size_t shortest = parts[3].size() / 2;
  for (std::size_t i = 0; i < shortest; ++i)
    for (std::size_t r = 0; r < 4; ++r) {
      std::uint64_t word = 0;
      std::memcpy(&word, parts[r].data() + 2 * i, sizeof word);
      rows[r].add(word);
    }
  Hash all;
  all.add(values.size());
  for (std::size_t r = 0; r < 4; ++r) {
    rows[r].add_bytes(std::as_bytes(parts[r].subspan(2 * shortest)));
    all.add(rows[r].value());
  }
  return all.value();
}

void add(SceneHash& hash, const Mesh& mesh) {
  const auto& [name, positions, normals, uvs, colors, triangles, material, is_closed, open_parts] =
      mesh;
  hash.add_all(positions);
  hash.add_all(normals);
  hash.add_all(uvs);
  hash.add_all(colors);
  hash.add(triangles.size());
  for (const auto& triangle : triangles)
    for (const std::uint32_t corner : triangle) hash.add(corner);
  hash.add_all(material);
  hash.add(is_closed);
  (void)open_parts;  // says no more than the triangles do
}

void add(SceneHash& hash, const ImageMap& map) {
  const auto& [image, placement, tiles] = map;
  hash.add(image);
  hash.add(placement.u_axis);
  hash.add(placement.v_axis);
  hash.add(placement.shift);
  hash.add_all(tiles);
}

void add(SceneHash& hash, const VertexColorMap& map) {
  const auto& [mean, low, high] = map;
  hash.add(mean);
  (void)low, (void)high;  // follow from the meshes
}

void add(SceneHash& hash, const NoiseMap& map) {
  const auto& [kind, size, octaves, seed] = map;
  hash.add(kind);
  hash.add(size);
  hash.add(octaves);
  hash.add(seed);
}

void add(SceneHash& hash, const TextureMap& map) {
  const auto& [source, vertex_colors, scale, offset, low, high] = map;
  hash.add(source.index());
  std::visit([&](const auto& kind) { add(hash, kind); }, source);
  hash.add_optional(vertex_colors, [&](const VertexColorMap& colors) { add(hash, colors); });
  hash.add(scale);
  hash.add(offset);
  hash.add(low);
  hash.add(high);
}

void add(SceneHash& hash, const std::optional<TextureMap>& map) {
  hash.add_optional(map, [&](const TextureMap& value) { add(hash, value); });
}

template <class Parameter>
void add_parameter(SceneHash& hash, const Parameter& parameter) {
  const auto& [value, map] = parameter;
  hash.add(value);
  add(hash, map);
}

void add(SceneHash& hash, const LayerMap& map) {
  const auto& [layer, quantity, part, terms] = map;
  hash.add(layer);
  hash.add(quantity);
  hash.add(part);
  hash.add(terms.size());
  for (const ScalarParameter& term : terms) add_parameter(hash, term);
}

/// Without what only people read.
std::string text_of_layers(Material material) {
  material.name = material.source = {};
  return format_material(material);
}

void add(SceneHash& hash, const Covering& covering) {
  const auto& [name, material, coverage] = covering;
  hash.add_text(text_of_layers(material));
  add_parameter(hash, coverage);
}

void add(SceneHash& hash, const DiffuseSurface& surface) {
  const auto& [color, over] = surface;
  add_parameter(hash, color);
  hash.add(over.size());
  for (const Covering& covering : over) add(hash, covering);
}

void add(SceneHash& hash, const SubsurfaceSurface& surface) {
  const auto& [material, color, color_use, thickness, weight, blur, maps, material_maps, over] =
      surface;
  hash.add(over.size());
  for (const Covering& covering : over) add(hash, covering);
  hash.add_text(text_of_layers(material));
  for (const MaterialMap& map : material_maps) {
    hash.add_text(map.number.name);
    hash.add(map.values.width);
    hash.add(hash_of_many(map.values.pixels));
  }
  add_parameter(hash, color);
  hash.add(color_use);
  add_parameter(hash, thickness);
  if (!hash.is_of_light) {  // it is not kept
    add_parameter(hash, weight);
    add_parameter(hash, blur);
  }
  hash.add(maps.size());
  for (const LayerMap& map : maps) add(hash, map);
}

void add(SceneHash& hash, const DielectricSurface& surface) {
  const auto& [ior, roughness, smoothness, distribution, scattering] = surface;
  hash.add(ior);
  if (hash.is_of_light) return;  // light on other surfaces passes it as if it were smooth
  add_parameter(hash, roughness);
  hash.add_optional(smoothness, [&](const ScalarParameter& value) { add_parameter(hash, value); });
  hash.add(distribution);
  hash.add(scattering);
}

void add(SceneHash& hash, const ThinSurface& surface) {
  const auto& [material, color, thickness] = surface;
  hash.add_text(text_of_layers(material));
  add_parameter(hash, color);
  hash.add_optional(thickness, [&](const ScalarParameter& value) { add_parameter(hash, value); });
}

void add(SceneHash& hash, const Coat& coat) {
  const auto& [ior, roughness, weight, distribution, second] = coat;
  hash.add(ior);
  add_parameter(hash, roughness);
  add_parameter(hash, weight);
  hash.add(distribution);
  hash.add_optional(second, [&](const Coat::SecondLobe& lobe) {
    add_parameter(hash, lobe.roughness);
    add_parameter(hash, lobe.share);
  });
}

void add(SceneHash& hash, const SurfaceMaterial& material) {
  const auto& [name, surface, opacity, coat, bump, normal_map, emission] = material;
  hash.add(emission);
  hash.add(surface.index());
  std::visit([&](const auto& kind) { add(hash, kind); }, surface);
  hash.add_optional(opacity, [&](const ScalarParameter& value) { add_parameter(hash, value); });
  hash.add_optional(coat, [&](const Coat& value) { add(hash, value); });
  add(hash, bump);
  hash.add_optional(normal_map, [&](const ImageMap& value) { add(hash, value); });
}

void add(SceneHash& hash, const PointLight& light) {
  const auto& [position, intensity] = light;
  hash.add(position);
  hash.add(intensity);
}

void add(SceneHash& hash, const DirectionalLight& light) {
  const auto& [direction, irradiance] = light;
  hash.add(direction);
  hash.add(irradiance);
}

void add(SceneHash& hash, const RectangleLight& light) {
  const auto& [center, edge_u, edge_v, radiance] = light;
  hash.add(center);
  hash.add(edge_u);
  hash.add(edge_v);
  hash.add(radiance);
}

void add(SceneHash& hash, const SpotLight& light) {
  const auto& [position, direction, intensity, cos_inner, cos_outer] = light;
  hash.add(position);
  hash.add(direction);
  hash.add(intensity);
  hash.add(cos_inner);
  hash.add(cos_outer);
}

void add(SceneHash& hash, const SphereLight& light) {
  const auto& [center, radius, radiance] = light;
  hash.add(center);
  hash.add(radius);
  hash.add(radiance);
}

void add(SceneHash& hash, const EnvironmentLight& light) {
  const auto& [image, scale, rotation, is_visible] = light;
  hash.add_optional(image, [&](std::size_t value) { hash.add(value); });
  hash.add(scale);
  hash.add(rotation);
  if (!hash.is_of_light) hash.add(is_visible);  // to the camera only
}

void add(SceneHash& hash, const Light& light) {
  hash.add(light.index());
  std::visit([&](const auto& kind) { add(hash, kind); }, light);
}

void add(SceneHash& hash, const Image& image) {
  hash.add(image.width);
  hash.add(image.height);
  hash.add(image.channels.size());
  hash.add(hash_of_many(image.pixels));
}

template <class T>
std::uint64_t hash_of(const std::vector<T>& parts, bool is_of_light) {
  SceneHash hash(is_of_light);
  hash.add(parts.size());
  for (const T& part : parts) add(hash, part);
  return hash.value();
}

/// The numbers of the method.
void add_numbers(SceneHash& hash, const RenderSettings& settings) {
  if (settings.method.is_open()) return;
  for (const MethodNumber& number : settings.method->numbers)
    if (!hash.is_of_light || !number.shapes_kept_light || number.shapes_kept_light(settings))
      hash.add(number.get(settings));
}

/// What light and picture follow from alike.
void add_shared(SceneHash& hash, const RenderSettings& settings, const RenderOptions& options) {
  hash.add_text(LAMINA_RENDER_FINGERPRINT);
  hash.add_text(settings.method.name());
  hash.add(profile_of(settings));  // what surfaces reflect onto others follows from it
  hash.add(settings.max_bounces);
  hash.add(settings.seed);
  hash.add(options.direct_light);
}

}  // namespace

std::uint64_t program_key() {
  Hash hash;
  hash.add_text(LAMINA_RENDER_FINGERPRINT);
  return hash.value();
}

namespace {

/// Adds what light meets at the top of layers.
void add_top(SceneHash& hash, const Material& layers) {
  if (layers.layers.empty()) return;
  for (const auto& [ior, outside, boundary] :
       {std::tuple{&layers.layers.front().ior, &layers.ior_above, specular_top(layers)},
        std::tuple{&layers.layers.back().ior, &layers.ior_below, layers.ground.top}}) {
    hash.add_all(*ior);
    hash.add_all(*outside);
    hash.add(boundary.roughness);
    hash.add(boundary.distribution);
  }
}

/// Adds all of a material but what lies below a translucent surface.
void add_above(SceneHash& hash, SurfaceMaterial material) {
  if (auto* subsurface = std::get_if<SubsurfaceSurface>(&material.surface)) {
    add_top(hash, subsurface->material);
    SubsurfaceSurface above;
    above.over = std::move(subsurface->over);
    material.surface = std::move(above);
  }
  add(hash, material);
}

void add_camera(SceneHash& hash, const Camera& camera) {
  const auto& [position, look_at, up, horizontal_fov, aperture_diameter, focus_distance] = camera;
  for (const Vec3& vector : {position, look_at, up}) hash.add(vector);
  for (const double number : {horizontal_fov, aperture_diameter, focus_distance}) hash.add(number);
}

}  // namespace

AspectHashes aspect_hashes(const Scene& scene, const RenderSettings& settings,
                           const RenderOptions& options) {
  std::array<SceneHash, scene_aspect_count> hashes = {
      SceneHash(false), SceneHash(false), SceneHash(false), SceneHash(false),
      SceneHash(false), SceneHash(false), SceneHash(false), SceneHash(false)};
  const auto of = [&](SceneAspect aspect) -> SceneHash& {
    return hashes[static_cast<std::size_t>(aspect)];
  };
  of(SceneAspect::meshes).add(hash_of(scene.meshes, false));
  for (const Image& image : scene.images) add(of(SceneAspect::images), image);
  for (const Light& light : scene.lights) {
    add(of(SceneAspect::lights), light);
    const auto* sky = std::get_if<EnvironmentLight>(&light);
    if (sky && sky->image) add(of(SceneAspect::lights), scene.images[*sky->image]);
  }
  add_camera(of(SceneAspect::camera), scene.camera);
  of(SceneAspect::film).add(scene.film.width);
  of(SceneAspect::film).add(scene.film.height);
  for (const SurfaceMaterial& material : scene.materials) {
    of(SceneAspect::lights).add(material.emission);
    add_above(of(SceneAspect::surfaces), material);
    const auto* subsurface = std::get_if<SubsurfaceSurface>(&material.surface);
    if (subsurface) add(of(SceneAspect::materials), *subsurface);
  }
  SceneHash& how = of(SceneAspect::settings);
  add_shared(how, settings, options);
  add_numbers(how, settings);
  how.add(settings.single_scattering);
  how.add(settings.exit_angle);
  how.add(settings.is_corrected);
  how.add(settings.orders);
  how.add(settings.samples_per_pixel);  // light is sampled for so many
  how.add(settings.noise);
  AspectHashes values{};
  for (std::size_t i = 0; i < scene_aspect_count; ++i) values[i] = hashes[i].value();
  return values;
}

LightFingerprint light_fingerprint(const Scene& scene, const RenderSettings& settings,
                                   const RenderOptions& options) {
  SceneHash hash(true);
  add_shared(hash, settings, options);
  add_numbers(hash, settings);
  return {.meshes = hash_of(scene.meshes, true),
          .materials = hash_of(scene.materials, true),
          .maps = hash_of(scene.images, true),
          .lights = hash_of(scene.lights, true),
          .settings = hash.value()};
}

std::uint64_t picture_key(const Scene& scene, const RenderSettings& settings,
                          const RenderOptions& options) {
  SceneHash hash(false);
  for (const std::uint64_t part : {hash_of(scene.meshes, false), hash_of(scene.materials, false),
                                   hash_of(scene.images, false), hash_of(scene.lights, false)})
    hash.add(part);
  add_camera(hash, scene.camera);
  hash.add(scene.film.width);
  hash.add(scene.film.height);
  const PixelRectangle area = rendered_area(scene.film);
  for (const int number : {area.x, area.y, area.width, area.height}) hash.add(number);
  add_shared(hash, settings, options);
  const auto& [method, quality, orders, factors, single_scattering, profile, exit_angle,
               is_corrected, samples_per_pixel, noise, clamp, max_bounces, seed, hierarchy,
               texture_space, shadow_map] = settings;
  (void)quality;                                               // chose some of the others
  (void)method, (void)profile, (void)max_bounces, (void)seed;  // shared
  (void)hierarchy, (void)texture_space, (void)shadow_map;      // numbers of methods
  hash.add(orders);
  for (const bool factor : {factors.fresnel, factors.seeliger, factors.depth, factors.phase})
    hash.add(factor);
  hash.add(single_scattering);
  hash.add(exit_angle);
  hash.add(is_corrected);
  hash.add(clamp);
  (void)samples_per_pixel, (void)noise;  // how many samples of it there are
  add_numbers(hash, settings);
  const auto& [direct_light, cache, memory, needs_cache, takes_foreign_light, checkpoint, resumes,
               keeps_samples, part, has_mattes, only_prepares, kept, goes_on_to, on_notice,
               on_image, seconds_between_images] = options;
  (void)direct_light;       // shared
  hash.add(cache.empty());  // light that is kept is sampled for any camera
  if (takes_foreign_light) hash.add_text(read_file_bytes(cache));  // nothing else says what it is
  (void)needs_cache, (void)checkpoint, (void)resumes, (void)on_notice;  // change nothing in it
  (void)part, (void)only_prepares, (void)keeps_samples;
  (void)on_image, (void)seconds_between_images, (void)has_mattes;
  (void)kept, (void)goes_on_to;
  return hash.value();
}

}  // namespace lamina
