// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/swatch_scene.h"

#include <string>

#include "lamina/base/io/json_input.h"
#include "lamina/layers/materials/material_file.h"

namespace lamina {

JsonOutput swatch_scene(const Material& material, int side) {
  const std::string text = format_material(material);
  const JsonDocument document = parse_json(text, material.name);
  const LayerStack stack = layer_stack(material, 0);
  const bool is_thin = !is_semi_infinite(stack) && stack.ground().reflectance == 0.0;
  const auto lamp = [](double x, double y, double z, double width, double height,
                       double radiance) -> JsonOutput {
    return {{"type", "rectangle"},
            {"position", JsonOutput::array({x, y, z})},
            {"look_at", JsonOutput::array({0.0, 0.0, 0.0})},
            {"size", JsonOutput::array({width, height})},
            {"radiance", radiance}};
  };
  return {
      {"lamina", "scene"},
      {"version", 1},
      {"mm_per_unit", 1.0},
      {"camera",
       {{"position", JsonOutput::array({0.0, 10.0, 70.0})},
        {"look_at", JsonOutput::array({0.0, 0.0, 0.0})},
        {"horizontal_fov", 19.5}}},
      {"film", {{"width", side}, {"height", side}}},
      {"render", {{"samples_per_pixel", 64}}},
      {"materials", {{"swatch", {{is_thin ? "thin" : "subsurface", JsonOutput(document.root())}}}}},
      {"meshes", JsonOutput::array(
                     {JsonOutput{{"shape", "sphere"}, {"radius", 10.0}, {"material", "swatch"}}})},
      {"lights", JsonOutput::array({lamp(-40.0, 44.0, 40.0, 34.0, 34.0, 14.0),
                                    lamp(34.0, 16.0, -36.0, 22.0, 30.0, 34.0),
                                    JsonOutput{{"type", "environment"}, {"radiance", 0.2}}})}};
}

}  // namespace lamina
