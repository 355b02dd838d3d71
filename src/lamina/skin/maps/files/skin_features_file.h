// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/io/json_file.h"
#include "lamina/skin/maps/skin_features.h"

namespace lamina {

class JsonInput;
class JsonObject;

/// Decodes a feature of a kind, as a recipe names it: "freckles", "moles", "veins", "blotches",
/// "tattoo", "pressed", "unevenness", "synthesis". @throws InvalidInput
[[nodiscard]] SkinFeature decode_skin_feature(std::string_view kind, const JsonInput& value);

// Decoders of features that are alike on a patch and on a mesh, without their places.
[[nodiscard]] Tattoo decode_ink(const JsonObject& object);
/// @throws InvalidInput if the skin has no such ink.
void require_ink(const Tattoo& tattoo, SkinParameters skin, const JsonInput& feature);
[[nodiscard]] PressedDisc decode_disc(const JsonObject& object);
[[nodiscard]] Veins decode_vein_look(const JsonObject& object);

/// Reads a recipe, changed by settings as parse_json takes them; docs/heterogeneous_skin.md has the
/// format. @throws FileError, InvalidInput
[[nodiscard]] SkinMapRecipe load_skin_map_recipe(const JsonFile& file, MemoryBudget memory = {},
                                                 std::span<const std::string> settings = {});

}  // namespace lamina
