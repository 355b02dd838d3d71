// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/method_settings.h"

#include <algorithm>
#include <variant>

#include "lamina/core/error.h"
#include "lamina/scene/subsurface_methods.h"

namespace lamina {
namespace {

/// "probe, hierarchy or shadow_map": the methods that honour a key.
std::string listed(std::string_view key) {
  std::vector<std::string_view> names;
  for (const SceneMethod method : subsurface_methods())
    if (method->honours_key(key)) names.push_back(method.name());
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i)
    list += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + std::string(names[i]);
  return list;
}

/// Where a key stands, as far as it is known.
std::string place(const Scene& scene, const std::string& path) {
  const auto found = scene.places.find(path);
  return found == scene.places.end() ? path : found->second;
}

template <class Setting>
std::string refusal_of(const Scene& scene, const std::string& path, const Setting& setting,
                       SceneMethod method) {
  return place(scene, path) + ": method \"" + std::string(method.name()) +
         "\" does not honour it, " + std::string(setting.reason) + ": leave it out, or take " +
         listed(setting.key);
}

/// Whether a key of `render` is there, if only with its default.
bool is_asked(const Scene& scene, const RenderSetting& setting, const std::string& path) {
  return setting.is_asked(scene.render) || scene.places.contains(path);
}

std::string path_of(const RenderSetting& setting) { return "render." + std::string(setting.key); }

}  // namespace

std::optional<std::string> refusal(const Scene& scene, SceneMethod method) {
  for (const SurfaceMaterial& material : scene.materials) {
    const auto* surface = std::get_if<SubsurfaceSurface>(&material.surface);
    if (!surface || surface->over.empty()) continue;
    const auto refuse = [&](std::string_view key) {
      return place(scene, "materials." + material.name + ".over") + ": must not stand beside \"" +
             std::string(key) + "\" of \"render\", which takes the surface as bare";
    };
    if (scene.render.is_corrected) return refuse("correct");
    if (scene.render.single_scattering != RenderSettings().single_scattering)
      return refuse("single_scattering");
  }
  if (method.is_open()) return std::nullopt;
  for (const RenderSetting& setting : render_settings)
    if (const std::string path = path_of(setting);
        !method->honours_key(setting.key) && is_asked(scene, setting, path))
      return refusal_of(scene, path, setting, method);
  for (const SurfaceMaterial& material : scene.materials)
    if (const auto* surface = std::get_if<SubsurfaceSurface>(&material.surface))
      for (const MaterialSetting& setting : material_settings)
        if (!method->honours_key(setting.key) && setting.is_asked(*surface))
          return refusal_of(scene, "materials." + material.name + "." + std::string(setting.key),
                            setting, method);
  return std::nullopt;
}

void require_honoured(const Scene& scene) {
  if (const auto why = refusal(scene, scene.render.method)) throw InvalidInput(*why);
}

std::vector<std::string> leave_out_unhonoured(Scene& scene) {
  std::vector<std::string> lines;
  if (scene.render.method.is_open()) return lines;
  for (const RenderSetting& setting : render_settings) {
    const std::string path = path_of(setting);
    if (scene.render.method->honours_key(setting.key) || !is_asked(scene, setting, path)) continue;
    lines.push_back(place(scene, path) + ": left out, method \"" +
                    std::string(scene.render.method.name()) + "\" does not honour it, " +
                    std::string(setting.reason));
    setting.leave_out(scene.render);
    scene.places.erase(path);
  }
  return lines;
}

}  // namespace lamina
