// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/light_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <variant>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

constexpr std::size_t most_groups = 64;

/// Channels of light, which add up.
constexpr std::array<std::string_view, 9> sums = {
    "R",          "G",          "B",         "subsurface.R", "subsurface.G", "subsurface.B",
    "specular.R", "specular.G", "specular.B"};

std::string_view kind_of(const Light& light) {
  // In the order of Light.
  constexpr std::array<std::string_view, 6> kinds = {"point",       "directional", "rectangle",
                                                     "environment", "spot",        "sphere"};
  static_assert(kinds.size() == std::variant_size_v<Light>);
  return kinds[light.index()];
}

std::string name_of_light(const Scene& scene, std::size_t index) {
  if (index < scene.light_names.size() && !scene.light_names[index].empty())
    return scene.light_names[index];
  int number = 0, count = 0;
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    if (scene.lights[i].index() != scene.lights[index].index()) continue;
    ++count;
    if (i <= index) ++number;
  }
  std::string name(kind_of(scene.lights[index]));
  return count > 1 ? name + "_" + std::to_string(number) : name;
}

std::string name_of_material(std::string name) {
  std::ranges::replace_if(
      name,
      [](unsigned char c) {
        return !(('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') ||
                 c == '-');
      },
      '_');
  return name;
}

bool shines(const SurfaceMaterial& material) {
  return material.emission.x > 0.0f || material.emission.y > 0.0f || material.emission.z > 0.0f;
}

void check(const Scene& scene, const RenderOptions& options, std::size_t groups) {
  if (groups == 0) throw InvalidInput("light layers: the scene must have a light, but has none");
  if (groups > most_groups)
    throw InvalidInput("light layers: there can be at most " + std::to_string(most_groups) +
                       ", but the scene has " + std::to_string(groups) +
                       "; lights of the same \"name\" share one");
  for (const auto& [what, is_asked] :
       {std::pair{"a part of the samples", options.part.has_value()},
        std::pair{"going on with a picture", options.resumes || options.keeps_samples},
        std::pair{"a cache of the light", !options.cache.empty() || options.needs_cache},
        std::pair{"pictures as they grow", static_cast<bool>(options.on_image)}})
    if (is_asked) throw InvalidInput(std::string("light layers: do not go with ") + what);
  if (scene.render.noise > 0.0f)
    throw InvalidInput("light layers: noise must be 0, but is " +
                       number_text(static_cast<double>(scene.render.noise)));
}

/// Adds what a group gives to the picture. Channels are found by name in each of the two, which may
/// have others: the picture has the mattes, too.
void add(const Image& group, Image& sum) {
  struct Places {
    std::size_t in_group, in_sum;
  };
  const auto places_of = [&](std::string_view name) {
    return Places{*channel_index(group, name), *channel_index(sum, name)};
  };
  const Places variance = places_of("variance");
  std::vector<Places> colors;
  for (const std::string_view name : sums) colors.push_back(places_of(name));
  for (int y = 0; y < sum.height; ++y)
    for (int x = 0; x < sum.width; ++x) {
      const float* from = group.at(x, y);
      float* to = sum.at(x, y);
      for (const Places& color : colors) to[color.in_sum] += from[color.in_group];
      const float deviation = std::sqrt(to[variance.in_sum]) + std::sqrt(from[variance.in_group]);
      to[variance.in_sum] = deviation * deviation;
    }
}

/// The image with the colors of each group behind its channels.
Image with_layers(const Image& image, const std::vector<LightGroup>& groups,
                  const std::vector<Image>& colors) {
  std::vector<std::string> channels = image.channels;
  for (const LightGroup& group : groups)
    for (const char* color : {"R", "G", "B"})
      channels.push_back("light." + group.name + "." + color);
  Image all = make_image(image.width, image.height, std::move(channels));
  const std::size_t pixels = image.pixels.size() / image.channel_count();
  for (std::size_t i = 0; i < pixels; ++i) {
    float* out = all.pixels.data() + i * all.channel_count();
    out = std::copy_n(image.pixels.data() + i * image.channel_count(), image.channel_count(), out);
    for (const Image& color : colors) out = std::copy_n(color.pixels.data() + 3 * i, 3, out);
  }
  return all;
}

/// The lights of a scene, which has them back at the end.
class ScenesLights {
 public:
  explicit ScenesLights(Scene& scene) : scene_(scene), lights_(scene.lights) {
    for (const SurfaceMaterial& material : scene.materials) emissions_.push_back(material.emission);
  }
  ~ScenesLights() {
    scene_.lights = lights_;
    for (std::size_t m = 0; m < emissions_.size(); ++m)
      scene_.materials[m].emission = emissions_[m];
  }
  ScenesLights(const ScenesLights&) = delete;
  ScenesLights& operator=(const ScenesLights&) = delete;

  /// Leaves those of a group alone in the scene.
  void leave(const LightGroup& group) const {
    scene_.lights.clear();
    for (const std::size_t i : group.lights) scene_.lights.push_back(lights_[i]);
    for (std::uint32_t m = 0; m < emissions_.size(); ++m)
      scene_.materials[m].emission =
          std::ranges::find(group.materials, m) != group.materials.end() ? emissions_[m] : Vec3f{};
  }

 private:
  Scene& scene_;
  std::vector<Light> lights_;
  std::vector<Vec3f> emissions_;
};

}  // namespace

std::vector<LightGroup> light_groups(const Scene& scene) {
  std::vector<LightGroup> groups;
  const auto named = [&](const std::string& name) -> LightGroup& {
    const auto found = std::ranges::find(groups, name, &LightGroup::name);
    return found != groups.end() ? *found : groups.emplace_back(LightGroup{.name = name});
  };
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    named(name_of_light(scene, i)).lights.push_back(i);
  for (std::uint32_t m = 0; m < scene.materials.size(); ++m)
    if (shines(scene.materials[m]))
      named(name_of_material(scene.materials[m].name)).materials.push_back(m);
  return groups;
}

RenderResult render_light_layers(Scene& scene, RenderOptions options, const Progress& progress) {
  const std::vector<LightGroup> groups = light_groups(scene);
  check(scene, options, groups.size());
  options.checkpoint.clear();
  const SceneMethod wanted = scene.render.method;
  const ScenesLights lights(scene);
  const auto on_notice = options.on_notice;

  RenderResult result;
  std::vector<Image> colors;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const LightGroup& group = groups[g];
    lights.leave(group);
    if (on_notice)
      options.on_notice = [&](const std::string& line) {
        on_notice("light " + group.name + ", " + std::to_string(g + 1) + " of " +
                  std::to_string(groups.size()) + ": " + line);
      };
    const auto part = [&](std::size_t i) {
      return static_cast<double>(i) / static_cast<double>(groups.size());
    };
    RenderResult one = render(scene, options, part_of(progress, part(g), part(g + 1)));
    if (!one.statistics.is_complete) throw Interrupted();
    colors.push_back(select_channels(one.image, {"R", "G", "B"}));
    scene.render.method = one.statistics.method;  // for all, where it was left open
    options.has_mattes = false;                   // those of the first are those of all
    if (g == 0) {
      result = std::move(one);
      continue;
    }
    add(one.image, result.image);
    RenderStatistics& all = result.statistics;
    all.expected_cpu_seconds += one.statistics.expected_cpu_seconds;
    all.wall_seconds += one.statistics.wall_seconds;
    all.cpu_seconds += one.statistics.cpu_seconds;
    all.peak_memory_mib = one.statistics.peak_memory_mib;
    for (std::string& warning : one.statistics.warnings)
      if (std::ranges::find(all.warnings, warning) == all.warnings.end())
        all.warnings.push_back(std::move(warning));
  }
  scene.render.method = wanted;
  result.statistics.relative_noise.reset();
  result.statistics.relative_noise_rms.reset();
  result.image = with_layers(result.image, groups, colors);
  return result;
}

}  // namespace lamina
