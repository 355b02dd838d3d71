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

#include "lamina/scene/description/scene.h"

// What of a scene some methods of subsurface light honour and others cannot. The rule of scenes:
// what the method does not honour is refused, never dropped. A key that is in neither list is
// honoured by all methods; an object named after a method, as "hierarchy", speaks to that method
// alone. What each method honours, its row of the table says (subsurface_methods.h).

namespace lamina {

/// A key of a translucent material.
struct MaterialSetting {
  std::string_view key;     ///< as in a scene file, below the material
  std::string_view reason;  ///< why methods that do not honour it cannot
  bool (*is_asked)(const SubsurfaceSurface&);
};

/// A key of "render".
struct RenderSetting {
  std::string_view key;
  std::string_view reason;
  bool (*is_asked)(const RenderSettings&);
  void (*leave_out)(RenderSettings&);
};

inline constexpr auto material_settings = [] {
  using Surface = SubsurfaceSurface;
  return std::to_array<MaterialSetting>(
      {{"color", "maps of the parameters of skin are its colors",
        [](const Surface& s) { return s.color_use != Surface::ColorUse::none; }},
       {"color_use",  // "invert"; "scale" is what "color" does anyway
        "it cannot find the absorption that a color takes, \"scale\" does without",
        [](const Surface& s) { return s.color_use == Surface::ColorUse::invert; }},
       {"thickness", "it takes thin parts from the mesh, or lets no light through",
        [](const Surface& s) { return s.thickness.value > 0.0f; }},
       {"single_scattering_weight", "its light holds what is scattered once",
        [](const Surface& s) {
          return s.single_scattering_weight.value != 1.0f || s.single_scattering_weight.map;
        }},
       {"single_scattering_blur", "its light holds what is scattered once",
        [](const Surface& s) { return s.single_scattering_blur.value > 0.0f; }},
       {"maps", "its layers are the same all over",
        [](const Surface& s) { return !s.maps.empty(); }},
       {"subsurface.maps",  // numbers of the material
        "maps of what a material is made of are not for it",
        [](const Surface& s) { return !s.material_maps.empty(); }},
       {"over", "its light does not pass what lies over a surface",
        [](const Surface& s) { return !s.over.empty(); }},
       {"subsurface.skin.dermis_thickness", "it takes the thickness of a fold from the mesh",
        [](const Surface& s) {
          return s.material.skin && std::isfinite(s.material.skin->skin.dermis_thickness);
        }},
       {"subsurface.ground", "the layers fill the mesh, so that there is nothing below them",
        [](const Surface& s) { return s.material.ground.reflectance > 0.0; }},
       {"subsurface.layers",  // of which the last is finite
        "its last layer fills the mesh and must have the thickness \"infinite\"",
        [](const Surface& s) { return std::isfinite(s.material.layers.back().thickness); }}});
}();

inline constexpr auto render_settings = [] {
  using Settings = RenderSettings;
  return std::to_array<RenderSetting>(
      {{"profile", "its light comes from no profile",
        [](const Settings& s) { return s.profile != RenderSettings().profile; },
        [](Settings& s) { s.profile = RenderSettings().profile; }},
       {"single_scattering", "its light holds what is scattered once",
        [](const Settings& s) { return s.single_scattering != RenderSettings().single_scattering; },
        [](Settings& s) { s.single_scattering = RenderSettings().single_scattering; }},
       {"exit_angle", "the directions of its light follow from the layers",
        [](const Settings& s) { return s.exit_angle != RenderSettings().exit_angle; },
        [](Settings& s) { s.exit_angle = RenderSettings().exit_angle; }},
       {"correct", "its light is not planar, or has noise",
        [](const Settings& s) { return s.is_corrected; },
        [](Settings& s) { s.is_corrected = false; }},
       {"orders", "it has all orders of scattering",
        [](const Settings& s) { return s.orders != RenderSettings().orders; },
        [](Settings& s) { s.orders = RenderSettings().orders; }},
       {"factors", "its light has no such factors",
        [](const Settings& s) { return s.factors.any(); }, [](Settings& s) { s.factors = {}; }}});
}();

/// A key that a scene asks for and that not all methods honour.
struct AskedSetting {
  std::string path;              ///< "render.correct", "materials.wax.maps"
  std::string_view key, reason;  ///< as of the setting
};

/// All such keys: those of `render`, then those of translucent materials in use.
[[nodiscard]] std::vector<AskedSetting> asked_settings(const Scene& scene);

/// Names the first key by which the scene asks for what a method does not honour, the method and
/// what to do; absent if it honours all. Of a method that is yet to be chosen: two keys that no
/// method honours together.
[[nodiscard]] std::optional<std::string> refusal(const Scene& scene, RenderSettings::Method method);

/// @throws InvalidInput if the scene asks for what its method does not honour, or if it leaves that
///         open no method.
void require_honoured(const Scene& scene);

/// Leaves out what of the scene's `render` its method does not honour, as when another method than
/// that of the file is tried. Returns a line for each.
[[nodiscard]] std::vector<std::string> leave_out_unhonoured(Scene& scene);

}  // namespace lamina
