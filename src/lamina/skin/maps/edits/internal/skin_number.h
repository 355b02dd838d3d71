// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/skin/fit/least_squares/fit_parameter.h"
#include "lamina/skin/maps/skin_maps.h"

namespace lamina::skin_edits {

/// A number of skin that can be edited, whether a map gives it or not.
struct SkinNumber {
  enum class Of { skin, ink, oil };
  Of of = Of::skin;
  double SkinParameters::*parameter = nullptr;
  std::size_t ink = 0;
  /// Range and coordinate of a number, in which it is blended: logarithm of amounts,
  /// logit of shares. An amount within the offset of none counts linearly.
  FitParameter coordinate;

  [[nodiscard]] const std::string& name() const { return coordinate.name; }
};

/// All numbers of a skin: those of skin_parameter_ranges, its inks as "ink_NAME", and "oiliness".
[[nodiscard]] std::vector<SkinNumber> numbers_of(const SkinMaps& skin);

/// @throws InvalidInput naming the known ones, or the nearest.
[[nodiscard]] SkinNumber find_number(const SkinMaps& skin, const std::string& name);

[[nodiscard]] bool is_map(const SkinMaps& skin, const SkinNumber& number);

/// The map, or an image of one texel.
[[nodiscard]] Image values_of(const SkinMaps& skin, const SkinNumber& number);

/// One texel is a number, if there was no map before.
void set_values(SkinMaps& skin, const SkinNumber& number, Image values);

}  // namespace lamina::skin_edits
