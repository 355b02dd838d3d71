// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/planning/method_choice.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/render/subsurface/bodies/optical_size.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/render/subsurface/random_walk/walk_refusal.h"
#include "lamina/scene/description/materials_in_use.h"
#include "lamina/scene/description/method_settings.h"
#include "lamina/scene/description/subsurface_methods.h"

namespace lamina {
namespace {

using Method = SceneMethod;

/// Mean chords of a body in transport mean free paths below which flat profiles do not fit it:
/// below the first they are a quarter off and more, and walks take less time; below the second a
/// tenth, which is said: test MethodChoice.FollowsLightInsideSmallBodies.
constexpr double least_flat_size = 10.0, least_right_size = 30.0;

using Quality = RenderSettings::Quality;

/// The best first, as far as they honour what is asked for.
std::array<Method, 6> preferred_methods(const RenderSettings& settings) {
  if (settings.quality == Quality::preview)
    return {Method::probe,        Method::hierarchy,   Method::texture_space,
            Method::layered_bsdf, Method::random_walk, Method::shadow_map};
  return {Method::hierarchy,   Method::texture_space, Method::layered_bsdf,
          Method::random_walk, Method::probe,         Method::shadow_map};
}

const Material& material_of(const Scene& scene, std::uint32_t material) {
  return std::get<SubsurfaceSurface>(scene.materials[material].surface).material;
}

std::string quoted_name(const Scene& scene, std::uint32_t material) {
  return '"' + scene.materials[material].name + '"';
}

bool has_diffusion_profile(const Material& material, const RenderSettings& settings) {
  try {
    (void)ProfileMaker(settings)(material, layer_stacks(material));
  } catch (const InvalidInput&) {
    return false;
  }
  return true;
}

bool has_profile(const Material& material, const RenderSettings& settings) {
  const RenderSettings::Profile source = ProfileMaker(settings).source(material);
  return source == RenderSettings::Profile::radiative_transfer
             ? !transfer_refusal(material)
             : has_diffusion_profile(material, settings);
}

/// The size of the bodies of a material if it is below that [transport mean free paths].
std::optional<OpticalSize> small_bodies(const Scene& scene, std::uint32_t material, double below) {
  const auto size = optical_size(scene, material);
  return size && size->in_mean_free_paths() < below ? size : std::nullopt;
}

std::string describe(const OpticalSize& size) {
  return printf_text("%.3g mm, %.2g transport mean free paths", size.size,
                     size.in_mean_free_paths());
}

/// Whether a method's light can be corrected in a scene that says nothing of it.
bool can_be_corrected(const Scene& scene, SceneMethod method) {
  const std::vector<std::uint32_t> translucent = translucent_materials_in_use(scene);
  return method->honours_key("correct") && !translucent.empty() &&
         scene.render.single_scattering == RenderSettings().single_scattering &&
         std::ranges::all_of(translucent, [&](std::uint32_t m) {
           return takes_walks(scene, m) && coverings_of(scene.materials[m]).empty();
         });
}

}  // namespace

ChosenSettings choose_settings(const Scene& scene, const RenderOptions& options) {
  ChosenSettings chosen{.settings = scene.render, .why_method = {}};
  RenderSettings& settings = chosen.settings;
  if (settings.method.is_open()) {
    auto [method, why] = choose_method(scene, options);
    settings.method = method;
    chosen.why_method = std::move(why);
  } else if (settings.quality == Quality::reference && settings.method == Method::random_walk) {
    chosen.why_method = "quality reference";
  }
  if (settings.quality == Quality::final && !scene.places.contains("render.correct"))
    settings.is_corrected = settings.is_corrected || can_be_corrected(scene, settings.method);
  return chosen;
}

MethodChoice choose_method(const Scene& scene, const RenderOptions& options) {
  if (scene.render.quality == Quality::reference) {
    if (const auto why = refusal(scene, Method::random_walk)) throw InvalidInput(*why);
    return {Method::random_walk, "quality reference"};
  }
  const bool is_preview = scene.render.quality == Quality::preview;
  const std::vector<AskedSetting> asked = asked_settings(scene);
  std::vector<Method> able;
  for (const Method method : preferred_methods(scene.render))
    if ((options.cache.empty() || method->keeps_light) &&
        std::ranges::all_of(asked,
                            [&](const AskedSetting& one) { return method->honours_key(one.key); }))
      able.push_back(method);
  if (able.empty()) {
    require_honoured(scene);
    throw InvalidInput("--cache: no method that keeps light honours " + asked.front().path);
  }
  const auto is_able = [&](Method method) { return std::ranges::find(able, method) != able.end(); };
  // What the best of all does not honour, if anything, is why it is another.
  const auto choice = [&](Method method, const std::string& otherwise) {
    for (const AskedSetting& one : asked)
      if (!preferred_methods(scene.render).front()->honours_key(one.key))
        return MethodChoice{method, "it honours " + one.path};
    return MethodChoice{method, otherwise};
  };
  for (const Method method : subsurface_methods())
    if (!is_preview && is_able(method) && has_numbers_of(scene.render, method))
      return choice(method, "the scene has settings of it");

  const std::vector<std::uint32_t> translucent = translucent_materials_in_use(scene);
  const bool is_corrected = scene.render.quality == Quality::final &&
                            !scene.places.contains("render.correct") &&
                            can_be_corrected(scene, able.front());
  if (!is_preview && !is_corrected && is_able(Method::random_walk) &&
      std::ranges::all_of(translucent, [&](std::uint32_t m) { return takes_walks(scene, m); }))
    for (const std::uint32_t m : translucent)
      if (const auto size = small_bodies(scene, m, least_flat_size))
        return {Method::random_walk,
                "bodies of " + quoted_name(scene, m) + " are small: " + describe(*size)};
  for (const std::uint32_t m : translucent)
    if (!has_profile(material_of(scene, m), scene.render)) {
      const auto found =
          std::ranges::find_if(able, [](Method method) { return method->solves_transfer; });
      if (found != able.end()) return {*found, quoted_name(scene, m) + " has no profile"};
    }
  const Method best = able.front();
  if (translucent.empty()) return {best, "nothing is translucent"};
  return choice(best, !options.cache.empty() ? "its light can be kept"
                      : is_preview           ? "quality preview"
                                             : "no noise below surfaces");
}

std::vector<std::string> warnings_of_small_bodies(const Scene& scene,
                                                  const RenderSettings& settings) {
  std::vector<std::string> lines;
  const Method method = settings.method;
  if (method == Method::random_walk || method->is_bsdf || settings.is_corrected) return lines;
  for (const std::uint32_t m : translucent_materials_in_use(scene))
    if (const auto size = small_bodies(scene, m, least_right_size))
      lines.push_back(
          "material " + quoted_name(scene, m) + ": its bodies are small, " + describe(*size) +
          ", but method " + std::string(method.name()) +
          " takes surfaces as flat: its light may be a tenth off, or a half in smaller ones; "
          "take quality final, which corrects it, or method random_walk");
  return lines;
}

}  // namespace lamina
