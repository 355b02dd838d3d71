// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/subsurface_methods.h"

#include <cstddef>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/nearest_name.h"

namespace lamina {
namespace {

/// A member of the settings of a method, as MethodNumber has it.
template <auto settings, auto member>
constexpr MethodNumber number_of(std::string_view key, double low, double high,
                                 std::string_view unit = {}) {
  using Number = std::remove_cvref_t<decltype(std::declval<RenderSettings>().*settings.*member)>;
  return {.key = key,
          .low = low,
          .high = high,
          .is_whole = std::is_integral_v<Number>,
          .get = [](const RenderSettings& s) { return static_cast<double>(s.*settings.*member); },
          .set = [](RenderSettings& s,
                    double value) { s.*settings.*member = static_cast<Number>(value); },
          .unit = unit};
}

constexpr auto hierarchy_numbers = [] {
  constexpr auto own = &RenderSettings::hierarchy;
  using S = HierarchySettings;
  auto numbers = std::to_array<MethodNumber>(
      {number_of<own, &S::spacing>("spacing_mm", 0, 1e6, "mm"),
       number_of<own, &S::max_points>("max_points", 1000, 20'000'000),
       number_of<own, &S::irradiance_samples>("irradiance_samples", 0, 1 << 20),
       number_of<own, &S::error>("error", 1e-4, 1, "sr"),
       number_of<own, &S::refine>("refine", 0, 1)});
  // Of the sum of samples; their number follows from it where they are refined.
  numbers[3].shapes_kept_light = [](const RenderSettings& s) { return s.hierarchy.refine > 0.0f; };
  return numbers;
}();

constexpr auto texture_space_numbers = [] {
  constexpr auto own = &RenderSettings::texture_space;
  using S = TextureSpaceSettings;
  return std::to_array<MethodNumber>(
      {number_of<own, &S::texel>("texel_mm", 0, 1e6, "mm"),
       number_of<own, &S::max_texels>("max_texels", 1000, 20'000'000),
       number_of<own, &S::irradiance_samples>("irradiance_samples", 1, 1 << 20),
       number_of<own, &S::interlayer_bounces>("interlayer_bounces", 1, 100)});
}();

constexpr auto shadow_map_numbers = [] {
  constexpr auto own = &RenderSettings::shadow_map;
  using S = ShadowMapSettings;
  return std::to_array<MethodNumber>({number_of<own, &S::resolution>("resolution", 16, 8192),
                                      number_of<own, &S::lamp_views>("lamp_views", 1, 4096),
                                      number_of<own, &S::dome_views>("dome_views", 1, 4096),
                                      number_of<own, &S::lookups>("lookups", 1, 4096)});
}();

constexpr auto built_in_methods = std::to_array<SubsurfaceMethodInfo>(
    {{.name = "probe",
      .how = "draws the point of entry at random, by probe rays",
      .noise = "falls with samples",
      .error = "the flat profile",
      .needs = "a profile",
      .page = "subsurface_probe.md",
      .uses_profile = true,
      .honours = {"color", "color_use", "thickness", "subsurface.skin.dermis_thickness",
                  "subsurface.ground", "subsurface.layers", "profile", "exit_angle",
                  "single_scattering", "single_scattering_weight", "single_scattering_blur",
                  "over"}},
     {.name = "layered_bsdf",
      .how = "lets light leave where it entered, by a BSDF of the layers",
      .noise = "falls with samples",
      .error = "no light between points",
      .needs = "at most 4 quantities that are maps",
      .page = "layered_bsdf.md",
      .solves_transfer = true,
      .is_bsdf = true,
      .honours = {"color", "maps", "subsurface.maps", "subsurface.skin.dermis_thickness",
                  "subsurface.ground", "subsurface.layers", "orders", "factors"}},
     {.name = "hierarchy",
      .how = "sums the profile over samples of the light on the surface",
      .noise = "none",
      .error = "the flat profile; light finer than the samples is blurred",
      .needs = "a profile",
      .page = "subsurface_hierarchy.md",
      .uses_profile = true,
      .keeps_light = true,
      .honours = {"color", "color_use", "thickness", "subsurface.skin.dermis_thickness",
                  "subsurface.ground", "subsurface.layers", "profile", "exit_angle",
                  "single_scattering", "single_scattering_weight", "single_scattering_blur",
                  "correct", "over"},
      .numbers = hierarchy_numbers},
     {.name = "shadow_map",
      .how = "draws the point of entry in what lights see of the surface, as [Hery2003] does",
      .noise = "falls with samples",
      .error = "the flat profile; no light from other surfaces; soft lights and skies in steps",
      .needs = "a profile",
      .page = "subsurface_shadow_map.md",
      .uses_profile = true,
      .is_of_papers = true,
      .honours = {"color", "color_use", "thickness", "subsurface.skin.dermis_thickness",
                  "subsurface.ground", "subsurface.layers", "profile", "exit_angle",
                  "single_scattering", "single_scattering_weight", "single_scattering_blur"},
      .numbers = shadow_map_numbers},
     {.name = "texture_space",
      .how = "convolves light over the surface through maps of the layers",
      .noise = "none below the surface",
      .error = "flat layers around each texel",
      .needs = "texture coordinates",
      .page = "subsurface_texture_space.md",
      .keeps_light = true,
      .honours = {"subsurface.maps", "subsurface.layers", "exit_angle", "correct", "over"},
      .numbers = texture_space_numbers},
     {.name = "random_walk",
      .how = "follows light inside closed meshes, homogeneous or in layers by depth, which may be "
             "maps, under smooth or rough boundaries, from body to body",
      .noise = "falls with samples",
      .error = "nothing but noise, within its model",
      .needs = "closed meshes",
      .page = "subsurface_random_walk.md",
      .solves_transfer = true,
      .honours = {"color", "color_use", "subsurface.maps"}}});

consteval SceneMethod built_in(std::string_view name) {
  return SceneMethod(*std::ranges::find(built_in_methods, name, &SubsurfaceMethodInfo::name));
}

std::string quoted(std::string_view text) { return '"' + std::string(text) + '"'; }

}  // namespace

constinit const SceneMethod SceneMethod::automatic;
constinit const SceneMethod SceneMethod::probe = built_in("probe");
constinit const SceneMethod SceneMethod::layered_bsdf = built_in("layered_bsdf");
constinit const SceneMethod SceneMethod::hierarchy = built_in("hierarchy");
constinit const SceneMethod SceneMethod::shadow_map = built_in("shadow_map");
constinit const SceneMethod SceneMethod::texture_space = built_in("texture_space");
constinit const SceneMethod SceneMethod::random_walk = built_in("random_walk");

std::vector<SceneMethod> subsurface_methods() {
  std::vector<SceneMethod> methods;
  for (const SubsurfaceMethodInfo& info : built_in_methods) methods.emplace_back(info);
  return methods;
}

std::vector<std::string_view> method_names() {
  std::vector<std::string_view> names = {SceneMethod().name()};
  for (const SceneMethod method : subsurface_methods()) names.push_back(method.name());
  return names;
}

std::optional<SceneMethod> find_method(std::string_view name) {
  if (name == SceneMethod().name()) return SceneMethod();
  const auto found = std::ranges::find(built_in_methods, name, &SubsurfaceMethodInfo::name);
  return found == built_in_methods.end() ? std::nullopt : std::optional(SceneMethod(*found));
}

SceneMethod method_named(const std::string& place, std::string_view name) {
  if (const auto method = find_method(name)) return *method;
  const std::vector<std::string_view> names = method_names();
  std::string list;
  for (const std::string_view one : names) list += (list.empty() ? "" : ", ") + std::string(one);
  throw InvalidInput(place + ": must be one of " + list + ", but is " + std::string(name) +
                     did_you_mean(name, names));
}

bool has_numbers_of(const RenderSettings& settings, SceneMethod method) {
  const RenderSettings defaults;
  return std::ranges::any_of(method->numbers, [&](const MethodNumber& number) {
    return number.get(settings) != number.get(defaults);
  });
}

std::string describe_methods() {
  std::string text;
  for (const SceneMethod method : subsurface_methods())
    if (!method->is_of_papers)
      text +=
          (text.empty() ? "" : "; ") + std::string(method.name()) + ' ' + std::string(method->how);
  return text;
}

std::string methods_table() {
  std::string text = "| `method` | how | noise | errs by | needs |\n|---|---|---|---|---|\n";
  for (const SceneMethod method : subsurface_methods()) {
    const std::string page(method->page);
    text += "| `" + std::string(method.name()) + "` | " + std::string(method->how) +
            (page.empty() ? "" : " ([" + page + "](" + page + "))");
    for (const std::string_view cell : {method->noise, method->error, method->needs})
      text += " | " + std::string(cell);
    text += " |\n";
  }
  return text;
}

std::string methods_schema() {
  std::string names;
  for (const std::string_view name : method_names())
    names += (names.empty() ? "" : ", ") + quoted(name);
  std::string text = R"({"method": {"enum": [)" + names + R"(], "default": "auto"})";
  for (const SceneMethod method : subsurface_methods()) {
    if (method->numbers.empty()) continue;
    text += ", " + quoted(method.name()) +
            R"(: {"type": "object", "additionalProperties": false, "properties": {)";
    for (const MethodNumber& number : method->numbers) {
      const std::string unit(number.unit);
      text += (&number == &method->numbers.front() ? "" : ", ") + quoted(number.key) +
              R"(: {"type": "number")" + (number.is_whole ? R"(, "multipleOf": 1)" : "") +
              R"(, "minimum": )" + number_text(number.low) + R"(, "maximum": )" +
              number_text(number.high) +
              (unit.empty() ? "" : R"(, "description": "[)" + unit + R"(].")") +
              R"(, "default": )" + number_text(number.get(RenderSettings{})) + "}";
    }
    text += "}}";
  }
  return text + "}";
}

}  // namespace lamina
