// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/scene/description/scene.h"
#include "lamina/scene/description/scene_method.h"

// The methods of subsurface transport as scenes, commands and pages speak of them: one table. Their
// code lies in render/subsurface; render/subsurface/methods says how each is made.

namespace lamina {

/// The methods in the order in which users read of them.
[[nodiscard]] std::vector<SceneMethod> subsurface_methods();

/// The names that files and commands know: "auto", then those of the methods.
[[nodiscard]] std::vector<std::string_view> method_names();

/// The method of a name; absent if there is none.
[[nodiscard]] std::optional<SceneMethod> find_method(std::string_view name);
/// @param place  of the name, for the error
/// @throws InvalidInput if there is none
[[nodiscard]] SceneMethod method_named(const std::string& place, std::string_view name);

/// Whether any of a method's numbers is not the default.
[[nodiscard]] bool has_numbers_of(const RenderSettings& settings, SceneMethod method);

/// Describes the methods but those of papers for the help of a command: "NAME HOW; NAME HOW".
[[nodiscard]] std::string describe_methods();

/// Table of the methods in Markdown, as docs/subsurface.md has it.
[[nodiscard]] std::string methods_table();

/// The keys of "render" that are about methods, as the properties of a JSON schema: "method" and an
/// object for each method that has numbers.
[[nodiscard]] std::string methods_schema();

}  // namespace lamina
