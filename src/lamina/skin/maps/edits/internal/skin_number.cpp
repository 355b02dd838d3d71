// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/internal/skin_number.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/nearest_name.h"

namespace lamina::skin_edits {
namespace {

/// Names, scales and offsets; as skin_fit_numbers has them where it has them.
struct Scale {
  std::string_view name;
  FitScale scale = FitScale::logarithmic;
  double offset = 0.0;
};
constexpr std::array<Scale, 13> scales = {{{"melanin", FitScale::logarithmic, 1e-3},
                                           {"melanin_blend", FitScale::logit},
                                           {"hemoglobin_epidermis", FitScale::logarithmic, 3e-4},
                                           {"hemoglobin_dermis", FitScale::logarithmic, 3e-4},
                                           {"carotene", FitScale::logarithmic, 3e-4},
                                           {"saturation_epidermis", FitScale::logit},
                                           {"saturation_dermis", FitScale::logit},
                                           {"baseline_scale", FitScale::logarithmic, 0.05},
                                           {"scattering_scale"},
                                           {"scattering_power", FitScale::linear},
                                           {"epidermis_thickness"},
                                           {"junction_absorption", FitScale::logarithmic, 0.01},
                                           {"dermis_thickness"}}};

Image one_texel(double value) {
  Image image = make_image(1, 1, {"Y"});
  image.pixels[0] = static_cast<float>(value);
  return image;
}

/// The place of the number's map among those of its kind; its end if there is none.
auto find_map(auto& skin, const SkinNumber& number) {
  return std::ranges::find(skin.maps, number.name(), &SkinMap::name);
}

double mean_of(const Image& image) {
  double sum = 0.0;
  for (const float value : image.pixels) sum += static_cast<double>(value);
  return sum / static_cast<double>(image.pixels.size());
}

double& member_of(SkinMaps& skin, const SkinNumber& number) {
  if (number.of == SkinNumber::Of::oil) return skin.oiliness;
  return number.parameter ? skin.skin.*number.parameter : skin.skin.inks[number.ink].absorbance;
}

}  // namespace

std::vector<SkinNumber> numbers_of(const SkinMaps& skin) {
  std::vector<SkinNumber> numbers;
  for (const SkinParameterRange& range : skin_parameter_ranges()) {
    const Scale& scale = *std::ranges::find(scales, range.name, &Scale::name);
    numbers.push_back({.parameter = range.value,
                       .coordinate = {.name = std::string(range.name),
                                      .low = range.low,
                                      .high = range.high,
                                      .scale = scale.scale,
                                      .offset = scale.offset}});
  }
  for (std::size_t i = 0; i < skin.skin.inks.size(); ++i)
    numbers.push_back({.of = SkinNumber::Of::ink,
                       .ink = i,
                       .coordinate = {.name = "ink_" + ink_name(skin.skin, i),
                                      .low = 0.0,
                                      .high = largest_absorbance,
                                      .scale = FitScale::logarithmic,
                                      .offset = 0.01}});
  numbers.push_back(
      {.of = SkinNumber::Of::oil,
       .coordinate = {.name = "oiliness", .low = 0.0, .high = 1.0, .scale = FitScale::logit}});
  return numbers;
}

SkinNumber find_number(const SkinMaps& skin, const std::string& name) {
  std::vector<SkinNumber> numbers = numbers_of(skin);
  std::vector<std::string_view> names;
  for (const SkinNumber& number : numbers) {
    if (number.name() == name) return number;
    names.push_back(number.name());
  }
  std::string guess = did_you_mean(name, names);
  if (guess.empty()) {
    guess = "; there are ";
    for (const std::string_view known : names)
      guess += (known == names.front() ? "" : ", ") + std::string(known);
  }
  throw InvalidInput("skin has no number \"" + name + "\"" + guess);
}

bool is_map(const SkinMaps& skin, const SkinNumber& number) {
  if (number.of == SkinNumber::Of::oil) return !skin.others.empty();
  return find_map(skin, number) != skin.maps.end();
}

Image values_of(const SkinMaps& skin, const SkinNumber& number) {
  if (number.of == SkinNumber::Of::oil)
    return skin.others.empty() ? one_texel(skin.oiliness) : skin.others.front().values;
  const auto map = find_map(skin, number);
  if (map != skin.maps.end()) return map->values;
  return one_texel(number.parameter ? skin.skin.*number.parameter
                                    : skin.skin.inks[number.ink].absorbance);
}

void set_values(SkinMaps& skin, const SkinNumber& number, Image values) {
  const bool had_map = is_map(skin, number);
  if (!had_map && values.pixels.size() == 1) {
    // The shortest number that is the same float, as 0.013 and not 0.0130000003.
    member_of(skin, number) = rounded_number(number_text(values.pixels[0]));
    return;
  }
  member_of(skin, number) = mean_of(values);
  if (number.of == SkinNumber::Of::oil) {
    if (!had_map)
      skin.others.push_back(
          {{.of = MappableNumber::Of::oiliness, .name = "skin.oiliness", .low = 0.0, .high = 1.0},
           {}});
    skin.others.front().values = std::move(values);
    return;
  }
  if (!had_map) skin.maps.push_back({number.name(), number.parameter, {}, number.ink});
  find_map(skin, number)->values = std::move(values);
}

}  // namespace lamina::skin_edits
