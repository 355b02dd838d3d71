// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/number_text.h"
#include "lamina/exchange/internal/blender_texts.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/exchange/internal/walk_medium.h"

namespace lamina::detail {

ExportedMaterial write_blender(const ExportInput& input) {
  const WalkMedium medium = make_walk_medium(input, "blender");
  const JsonOutput json = walk_medium_json(input, "blender", medium);
  ExportedMaterial result{.notes = {"tested in Blender 3.4; rules for 4.0 and later are read from "
                                    "the sources of Cycles"},
                          .misfits = medium.misfits};
  if (medium.is_sheet())
    result.notes.emplace_back(
        "thin: a diffuse and a translucent lobe below a reflecting surface; give it to a mesh "
        "without thickness. From Blender 5.2 on a thin wall, with one color for both sides");
  std::vector<std::string> lines = {
      "makes or renews the material that MEDIUM names: open it in Blender's text editor",
      "and run it, or blender --background FILE.blend --python this", channels_text(input)};
  for (const std::string& line : misfit_lines(medium.misfits)) lines.push_back(line);
  for (const std::string& note : result.notes) lines.push_back("note: " + note);
  // Of JSON Python takes all but null, true and false, which are not in it.
  std::string text = python_head("Blender 3.0 and later", lines) + "\n" +
                     std::string(blender_rules_text) + "\n\n" + std::string(blender_nodes_text) +
                     "\n\nMM_PER_UNIT = " + number_text(input.options.mm_per_unit) +
                     "\nMETHOD = \"RANDOM_WALK\"\nMEDIUM = " + json.text(1) +
                     "\n\nmake_material(MEDIUM[\"material\"], plan(MEDIUM, bpy.app.version, "
                     "MM_PER_UNIT, METHOD))\n";
  result.files.push_back({input.stem + "_blender.py", std::move(text)});
  result.files.push_back({input.stem + "_blender.json", json.text(1) + "\n"});
  return result;
}

}  // namespace lamina::detail
