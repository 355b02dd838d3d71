// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/render/film/render_options.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// The method for a scene that leaves it open, by its quality and by what it needs: all that the
/// scene asks for, then what its settings are of, then bodies that no flat profile fits, else light
/// without noise; of a preview the method that begins at once, of a reference random walks.
struct MethodChoice {
  SceneMethod method;
  std::string why;  ///< a phrase
};
/// @throws InvalidInput if no method honours all that the scene asks for, or random walks do not
///         that are to be the reference
[[nodiscard]] MethodChoice choose_method(const Scene& scene, const RenderOptions& options);

/// The settings that a picture is rendered with: those of the scene with what it leaves open.
struct ChosenSettings {
  RenderSettings settings;
  std::string why_method;  ///< a phrase, if the scene left it open
};
/// @throws as choose_method
[[nodiscard]] ChosenSettings choose_settings(const Scene& scene, const RenderOptions& options);

/// A line for each material in use whose bodies are too small for the method of the settings, which
/// takes surfaces as flat.
[[nodiscard]] std::vector<std::string> warnings_of_small_bodies(const Scene& scene,
                                                                const RenderSettings& settings);

}  // namespace lamina
