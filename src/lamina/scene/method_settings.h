// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lamina/scene/scene.h"

// What of a scene some methods of subsurface light honour and others cannot. The rule of scenes:
// what the method does not honour is refused, never dropped. A key that is in neither table is
// honoured by all methods; an object named after a method, as "hierarchy", speaks to that method
// alone. Who adds a key or a method says here what it honours.

namespace lamina {

/// Some of the methods.
class MethodSet {
 public:
  using Method = RenderSettings::Method;
  constexpr MethodSet(std::initializer_list<Method> methods) {
    for (const Method method : methods) bits_ |= bit(method);
  }
  /// A method that is left open becomes one that honours what is asked.
  [[nodiscard]] constexpr bool has(Method method) const {
    return method == Method::automatic || (bits_ & bit(method)) != 0;
  }

 private:
  static constexpr std::uint32_t bit(Method method) { return 1u << static_cast<unsigned>(method); }
  std::uint32_t bits_ = 0;
};

/// The methods that can be asked for, as files and commands name them.
inline constexpr auto named_methods =
    std::to_array<std::pair<std::string_view, RenderSettings::Method>>(
        {{"profile", RenderSettings::Method::profile},
         {"layered_bsdf", RenderSettings::Method::layered_bsdf},
         {"hierarchy", RenderSettings::Method::hierarchy},
         {"shadow_map", RenderSettings::Method::shadow_map},
         {"texture_space", RenderSettings::Method::texture_space},
         {"random_walk", RenderSettings::Method::random_walk}});
[[nodiscard]] std::string_view method_name(RenderSettings::Method method);

/// A key of a translucent material.
struct MaterialSetting {
  std::string_view key;  ///< as in a scene file, below the material
  MethodSet honoured_by;
  std::string_view reason;  ///< why others cannot
  bool (*is_asked)(const SubsurfaceSurface&);
};

/// A key of "render".
struct RenderSetting {
  std::string_view key;
  MethodSet honoured_by;
  std::string_view reason;
  bool (*is_asked)(const RenderSettings&);
  void (*leave_out)(RenderSettings&);
};

namespace method_settings {
using Method = RenderSettings::Method;
inline constexpr MethodSet with_profile = {Method::profile, Method::hierarchy, Method::shadow_map};
inline constexpr RenderSettings unasked;
}  // namespace method_settings

inline constexpr auto material_settings = [] {
  using enum RenderSettings::Method;
  using Surface = SubsurfaceSurface;
  return std::to_array<MaterialSetting>(
      {{"color",
        {profile, hierarchy, shadow_map, layered_bsdf, random_walk},
        "maps of the parameters of skin are its colors",
        [](const Surface& s) { return s.color_use != Surface::ColorUse::none; }},
       {"color_use",  // "invert"; "scale" is what "color" does anyway
        {profile, hierarchy, shadow_map, random_walk},
        "it cannot find the absorption that a color takes, \"scale\" does without",
        [](const Surface& s) { return s.color_use == Surface::ColorUse::invert; }},
       {"thickness", method_settings::with_profile,
        "it takes thin parts from the mesh, or lets no light through",
        [](const Surface& s) { return s.thickness.value > 0.0f; }},
       {"maps",
        {layered_bsdf},
        "its layers are the same all over",
        [](const Surface& s) { return !s.maps.empty(); }},
       {"subsurface.skin",  // of which a parameter is a map
        {texture_space, layered_bsdf},
        "maps in the recipe of skin are not for it",
        [](const Surface& s) { return !s.skin_maps.empty(); }},
       {"subsurface.skin.dermis_thickness",
        {profile, hierarchy, shadow_map, layered_bsdf},
        "it takes the thickness of a fold from the mesh",
        [](const Surface& s) {
          return s.material.skin && std::isfinite(s.material.skin->skin.dermis_thickness);
        }},
       {"subsurface.ground",
        {profile, hierarchy, shadow_map, layered_bsdf},
        "the layers fill the mesh, so that there is nothing below them",
        [](const Surface& s) { return s.material.ground.reflectance > 0.0; }},
       {"subsurface.layers",  // of which the last is finite
        {profile, hierarchy, shadow_map, texture_space, layered_bsdf},
        "its last layer fills the mesh and must have the thickness \"infinite\"",
        [](const Surface& s) { return std::isfinite(s.material.layers.back().thickness); }}});
}();

inline constexpr auto render_settings = [] {
  using enum RenderSettings::Method;
  using Settings = RenderSettings;
  return std::to_array<RenderSetting>(
      {{"profile", method_settings::with_profile, "it spreads light without a profile",
        [](const Settings& s) { return s.profile != method_settings::unasked.profile; },
        [](Settings& s) { s.profile = method_settings::unasked.profile; }},
       {"single_scattering", method_settings::with_profile,
        "its light holds what is scattered once",
        [](const Settings& s) {
          return s.single_scattering != method_settings::unasked.single_scattering;
        },
        [](Settings& s) { s.single_scattering = method_settings::unasked.single_scattering; }},
       {"orders",
        {layered_bsdf},
        "it has all orders of scattering",
        [](const Settings& s) { return s.orders != method_settings::unasked.orders; },
        [](Settings& s) { s.orders = method_settings::unasked.orders; }},
       {"factors",
        {layered_bsdf},
        "its light has no such factors",
        [](const Settings& s) { return s.factors.any(); },
        [](Settings& s) { s.factors = {}; }}});
}();

/// Names the first key by which the scene asks for what a method does not honour, the method and
/// what to do; absent if it honours all, or is yet to be
/// chosen.
[[nodiscard]] std::optional<std::string> refusal(const Scene& scene, RenderSettings::Method method);

/// @throws InvalidInput if the scene asks for what its method does not honour.
void require_honoured(const Scene& scene);

/// Leaves out what of the scene's `render` its method does not honour, as when another method than
/// that of the file is tried. Returns a line for each.
[[nodiscard]] std::vector<std::string> leave_out_unhonoured(Scene& scene);

}  // namespace lamina
