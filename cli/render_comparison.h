// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "console.h"
#include "lamina/scene/description/scene.h"

namespace lamina::cli {

using NamedMethod = std::pair<std::string, RenderSettings::Method>;

/// Renders a scene by each method. Writes NAME_METHOD.exr and .png for each, and NAME.svg: the
/// pictures side by side over their differences from the slowest; prints a table of time, noise and
/// error against it. A method that refuses the scene is left out, with a warning.
/// After Ctrl-C the methods that were completed are compared.
/// @throws InvalidInput if fewer than two methods take the scene
void run_comparison(Scene scene, const std::vector<NamedMethod>& methods,
                    const std::filesystem::path& name, const CommonOptions& common);

}  // namespace lamina::cli
