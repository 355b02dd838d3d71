// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "command.h"
#include "lamina/base/core/memory_budget.h"
#include "lamina/base/io/json_output.h"
#include "lamina/skin/maps/edits/skin_edits.h"

namespace lamina::cli {

/// An edit as it was written, with what follows it: --tan .3 --mask face.png.
struct EditStep {
  SkinEditKind kind = SkinEditKind::tan;
  std::string value;      ///< ".3", "melanin=.5" or a path
  std::string mask = {};  ///< a path, or none
  double size = 0.0, strength = 1.0;
};

/// Adds an option for each kind of edit, and --mask, --size and --strength, which belong to the
/// edit before them. `steps` get the edits in the order written; they must outlive the parse.
void add_edit_steps(const Command& command, std::vector<EditStep>& steps);

/// An edit with its images. @throws InvalidInput naming the option; FileError as load_image
[[nodiscard]] SkinEdit decode_step(const EditStep& step, MemoryBudget& memory);

/// The option, for messages: "--tan".
[[nodiscard]] std::string option_of(const EditStep& step);

/// One step of an edit, in a result.
[[nodiscard]] JsonOutput step_json(const EditStep& step);

}  // namespace lamina::cli
