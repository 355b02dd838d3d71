// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/method_settings.h"

#include <algorithm>
#include <array>
#include <span>
#include <variant>

#include "lamina/base/core/error.h"
#include "lamina/scene/description/materials_in_use.h"
#include "lamina/scene/description/subsurface_methods.h"

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

std::string refusal_of(const Scene& scene, const AskedSetting& asked, SceneMethod method) {
  return place(scene, asked.path) + ": method \"" + std::string(method.name()) +
         "\" does not honour it, " + std::string(asked.reason) + ": leave it out, or take " +
         listed(asked.key);
}

/// Whether a key of `render` is there, if only with its default.
bool is_asked(const Scene& scene, const RenderSetting& setting, const std::string& path) {
  return setting.is_asked(scene.render) || scene.places.contains(path);
}

std::string path_of(const RenderSetting& setting) { return "render." + std::string(setting.key); }

/// Names a key that no method honours beside another one.
std::optional<std::string> conflict(const Scene& scene, const std::vector<AskedSetting>& all) {
  const std::vector<SceneMethod> methods = subsurface_methods();
  const auto is_honoured = [&](std::span<const AskedSetting> asked) {
    return std::ranges::any_of(methods, [&](SceneMethod method) {
      return std::ranges::all_of(
          asked, [&](const AskedSetting& one) { return method->honours_key(one.key); });
    });
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (is_honoured({all.data(), i + 1})) continue;
    // One of those before that alone is enough, else the last.
    const std::size_t other = [&] {
      for (std::size_t k = 0; k < i; ++k)
        if (!is_honoured(std::array{all[k], all[i]})) return k;
      return i - 1;
    }();
    return place(scene, all[i].path) + ": no method honours it beside " + all[other].path +
           ": leave one out; it is for " + listed(all[i].key) + ", the other for " +
           listed(all[other].key);
  }
  return std::nullopt;
}

}  // namespace

std::vector<AskedSetting> asked_settings(const Scene& scene) {
  std::vector<AskedSetting> all;
  for (const RenderSetting& setting : render_settings)
    if (const std::string path = path_of(setting); is_asked(scene, setting, path))
      all.push_back({path, setting.key, setting.reason});
  for (const std::uint32_t m : translucent_materials_in_use(scene))
    for (const MaterialSetting& setting : material_settings)
      if (setting.is_asked(std::get<SubsurfaceSurface>(scene.materials[m].surface)))
        all.push_back({"materials." + scene.materials[m].name + "." + std::string(setting.key),
                       setting.key, setting.reason});
  return all;
}

std::optional<std::string> refusal(const Scene& scene, SceneMethod method) {
  for (const std::uint32_t m : translucent_materials_in_use(scene)) {
    const SurfaceMaterial& material = scene.materials[m];
    if (std::get<SubsurfaceSurface>(material.surface).over.empty()) continue;
    const auto refuse = [&](std::string_view key) {
      return place(scene, "materials." + material.name + ".over") + ": must not stand beside \"" +
             std::string(key) + "\" of \"render\", which takes the surface as bare";
    };
    if (scene.render.is_corrected) return refuse("correct");
    if (scene.render.single_scattering != RenderSettings().single_scattering)
      return refuse("single_scattering");
  }
  const std::vector<AskedSetting> all = asked_settings(scene);
  if (method.is_open()) return conflict(scene, all);
  for (const AskedSetting& asked : all)
    if (!method->honours_key(asked.key)) return refusal_of(scene, asked, method);
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
