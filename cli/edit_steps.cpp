// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "edit_steps.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/skin/maps/edits/files/editable_skin_file.h"

namespace lamina::cli {
namespace {

struct StepHelp {
  SkinEditKind kind;
  const char* type;
  const char* group;
  const char* text;
};

constexpr const char* look_group = "Edits of how skin looks, in the order written";
constexpr const char* number_group = "Edits of one number, in the same order";

constexpr StepHelp step_helps[] = {
    {SkinEditKind::tan, "A", look_group,
     "a tan: 1 + A times the melanin; .3 is 30 % more, and -.3 less. 74 % of what is added is "
     "eumelanin, as of skin"},
    {SkinEditKind::flush, "A", look_group,
     "a flush: 1 + A times the blood; what is added is arterial, .97 of it oxygenated"},
    {SkinEditKind::pale, "A", look_group, "1 - A times the blood"},
    {SkinEditKind::saturation, "S", look_group,
     "oxygenated share of the blood: S in the middle, detail stays"},
    {SkinEditKind::cyanosis, "A", look_group, "1 - A times the oxygenated share of the blood"},
    {SkinEditKind::freckles, "A", look_group,
     "1 + A times the contrast of freckles and moles: what of ln(melanin) lies above its "
     "surroundings within --size, 2.5 mm; -1 takes them away"},
    {SkinEditKind::even, "A", look_group,
     "1 - A times the contrast of all pigments to their surroundings within --size, 3 mm"},
    {SkinEditKind::foundation, "A", look_group,
     "the look of a foundation: the same within 10 mm, and 1 - A times the oil. It is no layer of "
     "powder"},
    {SkinEditKind::blush, "A", look_group,
     "the look of rouge where --mask says: oxygenated blood in the epidermis as its dye"},
    {SkinEditKind::lipstick, "A", look_group,
     "the look of lipstick where --mask says: the same, stronger, less melanin, and a red ink in "
     "the "
     "sheet below the epidermis"},
    {SkinEditKind::homogenize, "MAPS", look_group,
     "mean and covariance of the pigments become those of other maps, or a part of the way by "
     "--strength"},
    {SkinEditKind::scale, "NAME=F", number_group, "F times a number, as melanin=1.2"},
    {SkinEditKind::add, "NAME=D", number_group, "D more, in the number's unit"},
    {SkinEditKind::set, "NAME=V", number_group, "V everywhere"},
    {SkinEditKind::gamma, "NAME=G", number_group,
     "G times its contrast about the mean of its logarithm, or of the logit of a share"},
    {SkinEditKind::blur, "NAME=MM", number_group,
     "blurred by a Gaussian of this standard deviation"},
    {SkinEditKind::transfer, "NAME=IMAGE", number_group,
     "the first channel of an image, in the number's unit"},
};

double number_of(const std::string& option, const std::string& text) {
  double value = 0.0;
  const char *const end = text.data() + text.size(), *begin = text.data();
  if (begin != end && *begin == '+') ++begin;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value))
    throw InvalidInput(option + ": must be a finite number, but is " + text);
  return value;
}

/// The first channel of an image of quantities.
Image load_quantities(const std::string& option, const std::string& file, MemoryBudget& memory) {
  try {
    Image image = load_image(file, ColorEncoding::linear, memory);
    require_finite(image, file);
    image = select_channels(image, {image.channels.front()});
    image.channels = {"Y"};
    return image;
  } catch (const FileError& error) {
    throw FileError(option + ": " + error.what());
  }
}

EditableSkin load_reference(const std::string& option, const std::string& file,
                            MemoryBudget memory) {
  try {
    return load_editable_skin(file, memory);
  } catch (const FileError& error) {
    throw FileError(option + ": " + error.what());
  }
}

}  // namespace

std::string option_of(const EditStep& step) { return "--" + std::string(name_of(step.kind)); }

void add_edit_steps(const Command& command, std::vector<EditStep>& steps) {
  const auto last = [&steps](const char* option) -> EditStep& {
    if (steps.empty())
      throw InvalidInput(std::string(option) + ": must follow the edit that it belongs to");
    return steps.back();
  };
  for (const StepHelp& help : step_helps)
    command
        .add_step(
            option_of({.kind = help.kind, .value = {}}),
            [&steps, kind = help.kind](const std::string& value) {
              steps.push_back({.kind = kind, .value = value});
            },
            help.text)
        .type_name(help.type)
        .group(help.group);
  constexpr const char* group = "After an edit: where, and how much of it";
  command
      .add_step(
          "--mask", [last](const std::string& file) { last("--mask").mask = file; },
          "an image of the proportions of the maps: 0 (black) leaves the place as it is, 1 takes "
          "all of the edit before")
      .type_name("IMAGE")
      .group(group);
  command
      .add_step(
          "--size",
          [last](const std::string& text) {
            EditStep& step = last("--size");
            if (skin_edit_range(step.kind).size == 0.0)
              throw InvalidInput(
                  "--size: is for --freckles, --even and --foundation, but follows " +
                  option_of(step));
            step.size = number_of("--size", text);
            if (!(0.01 <= step.size && step.size <= 1000.0))
              throw InvalidInput("--size: must lie in [0.01, 1000] mm, but is " + text);
          },
          "standard deviation of the blur that is the surroundings [mm]")
      .type_name("MM")
      .group(group);
  command
      .add_step(
          "--strength",
          [last](const std::string& text) {
            EditStep& step = last("--strength");
            step.strength = number_of("--strength", text);
            if (!(0.0 <= step.strength && step.strength <= 1.0))
              throw InvalidInput("--strength: must lie in [0, 1], but is " + text);
          },
          "how far the edit before goes, from 0 to 1, in the number's logarithm or logit")
      .type_name("A")
      .group(group);
}

SkinEdit decode_step(const EditStep& step, MemoryBudget& memory) {
  const std::string option = option_of(step);
  SkinEdit edit{.kind = step.kind, .size = step.size, .strength = step.strength};
  std::string value = step.value;
  if (skin_edit_range(step.kind).has_number) {
    const std::size_t equals = value.find('=');
    if (equals == std::string::npos || equals == 0)
      throw InvalidInput(option + ": must be NAME=VALUE, as melanin=0.5, but is " + value);
    edit.number = value.substr(0, equals);
    value = value.substr(equals + 1);
  }
  if (step.kind == SkinEditKind::transfer)
    edit.image = load_quantities(option, value, memory);
  else if (step.kind == SkinEditKind::homogenize)
    edit.reference = load_reference(option, value, memory);
  else
    edit.amount = number_of(option, value);
  if (!step.mask.empty()) edit.mask = load_quantities("--mask", step.mask, memory);
  return edit;
}

JsonOutput step_json(const EditStep& step) {
  JsonOutput json = JsonOutput::object();
  json[name_of(step.kind)] = step.value;
  if (!step.mask.empty()) json["mask"] = step.mask;
  if (step.size > 0.0) json["size_mm"] = step.size;
  if (step.strength < 1.0) json["strength"] = step.strength;
  return json;
}

}  // namespace lamina::cli
