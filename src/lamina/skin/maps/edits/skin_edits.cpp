// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/skin_edits.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/image/blur.h"
#include "lamina/skin/maps/edits/internal/detail_edits.h"
#include "lamina/skin/maps/edits/internal/homogenize.h"

namespace lamina {
namespace {

using namespace skin_edits;

constexpr std::size_t most_inks = 16;  // of a recipe

/// What make-up of full amount does. There is no layer above the epidermis: oxygenated blood stands
/// for red dye in it, and less melanin for what covers the skin below. An ink alone, seen through
/// the epidermis, would look mauve. Chosen by eye.
struct MakeUp {
  double blood;  ///< added in the epidermis
  double cover;  ///< share of the melanin that does not show
  double dye;    ///< absorbance of red dye in the sheet below
};
constexpr MakeUp rouge = {.blood = 0.012, .cover = 0.15, .dye = 0.1};
constexpr MakeUp lip_color = {.blood = 0.045, .cover = 0.7, .dye = 0.5};

/// Factors on the absorbance of the dye: ours, of the kind that lips are painted with, no
/// measurement of a product.
const std::vector<std::array<double, 2>> red_dye = {{400, 0.8}, {460, 0.8}, {520, 1.0},
                                                    {575, 1.0}, {605, 0.4}, {640, 0.06}};

void put_on(Course& course, const MakeUp& make_up) {
  const double amount = course.edit.amount;
  const std::string name(name_of(course.edit.kind));
  std::vector<SkinInk>& inks = course.skin().skin.inks;
  if (std::ranges::find(inks, name, &SkinInk::name) == inks.end()) {
    if (inks.size() >= most_inks)
      throw InvalidInput("there must be at most " + std::to_string(most_inks) +
                         " inks, but there would be one more");
    inks.push_back({.name = name, .absorbance = 0.0, .spectrum = red_dye});
  }
  change(course, "ink_" + name, [&](double x) { return x + amount * make_up.dye; });
  change(course, "hemoglobin_epidermis", [&](double x) { return x + amount * make_up.blood; });
  change(course, "saturation_epidermis", [&](double x) { return x + amount * (1.0 - x); });
  change(course, "melanin", [&](double x) { return (1.0 - amount * make_up.cover) * x; });
}

/// Blood of both layers, or the oxygenated share of it.
void change_blood(Course& course, const std::function<double(double value)>& function) {
  for (const char* name : {"hemoglobin_epidermis", "hemoglobin_dermis"})
    change(course, name, function);
}
void change_saturation(Course& course, const std::function<double(double value)>& function) {
  for (const char* name : {"saturation_epidermis", "saturation_dermis"})
    change(course, name, function);
}

void transfer(Course& course, const SkinNumber& number) {
  const Image& image = course.edit.image;
  if (image.pixels.empty() || image.channel_count() != 1)
    throw InvalidInput("the image must have one channel");
  require_alike("the image", image, course.skin());
  Image wanted = image;
  std::atomic<std::size_t> count = 0;
  for (float& value : wanted.pixels) {
    if (!std::isfinite(value))
      throw InvalidInput("the image must be finite, but has " + number_text(value));
    value = clamped(number, static_cast<double>(value), count);
  }
  note_clamped(course, number, count);
  drop_deviation(course, number);
  put(course, number, values_of(course.skin(), number), wanted);
}

void change_number(Course& course) {
  const SkinNumber number = find_number(course.skin(), course.edit.number);
  const double amount = course.edit.amount;
  const FitParameter& coordinate = number.coordinate;
  const Image values = values_of(course.skin(), number);
  const bool is_infinite = values.pixels.size() == 1 && std::isinf(values.pixels[0]);
  if (is_infinite &&
      (course.edit.kind != SkinEditKind::set || course.has_mask() || course.edit.strength < 1.0))
    throw InvalidInput(number.name() + " is infinite, and can only be set, everywhere");
  switch (course.edit.kind) {
    case SkinEditKind::scale:
      return change(course, number, [&](double x) { return amount * x; });
    case SkinEditKind::add:
      return change(course, number, [&](double x) { return x + amount; });
    case SkinEditKind::set:
      if (!(coordinate.low <= amount && amount <= coordinate.high))
        throw InvalidInput(number.name() + " must lie in [" + number_text(coordinate.low) + ", " +
                           number_text(coordinate.high) + "], but is " + number_text(amount));
      drop_deviation(course, number);
      return change(course, number, [&](double) { return amount; });
    case SkinEditKind::gamma: {
      const double mean = mean_coordinate(course, number, values);
      return change(course, number, [&](double x) {
        return unbounded_value(coordinate, mean + amount * (fit_coordinate(coordinate, x) - mean));
      });
    }
    case SkinEditKind::blur:
      if (values.pixels.size() == 1) return;
      drop_deviation(course, number);
      return put(course, number, values, blurred(values, spread_of(course, amount, values)));
    default:
      return transfer(course, number);
  }
}

/// The amount that changes nothing.
std::optional<double> neutral_amount(SkinEditKind kind) {
  switch (kind) {
    case SkinEditKind::scale:
    case SkinEditKind::gamma:
      return 1.0;
    case SkinEditKind::saturation:
    case SkinEditKind::homogenize:
    case SkinEditKind::set:
    case SkinEditKind::transfer:
      return std::nullopt;
    default:
      return 0.0;
  }
}

void check(const SkinEdit& edit, const SkinMaps& skin) {
  const SkinEditRange range = skin_edit_range(edit.kind);
  const auto require = [](const std::string& what, double low, double value, double high,
                          const char* unit) {
    if (!(low <= value && value <= high))
      throw InvalidInput(what + "must lie in [" + number_text(low) + ", " + number_text(high) +
                         "]" + unit + ", but is " + number_text(value));
  };
  require("", range.low, edit.amount, range.high, "");
  require("the strength ", 0.0, edit.strength, 1.0, "");
  if (edit.size != 0.0) {
    if (range.size == 0.0) throw InvalidInput("has no size");
    require("the size ", 0.01, edit.size, 1000.0, " mm");
  }
  if (range.has_number) (void)find_number(skin, edit.number);
  if (edit.mask.pixels.empty()) {
    if (range.needs_mask) throw InvalidInput("needs a mask that says where");
    return;
  }
  if (edit.mask.channel_count() != 1) throw InvalidInput("the mask must have one channel");
  for (const float value : edit.mask.pixels)
    if (!(0.0f <= value && value <= 1.0f))
      throw InvalidInput("the mask must lie in [0, 1], but has " + number_text(value));
  require_alike("the mask", edit.mask, skin);
}

}  // namespace

SkinEditRange skin_edit_range(SkinEditKind kind) {
  switch (kind) {
    case SkinEditKind::tan:
      return {.low = -0.95, .high = 10.0};
    case SkinEditKind::flush:
      return {.low = 0.0, .high = 10.0};
    case SkinEditKind::freckles:
      return {.low = -1.0, .high = 4.0, .size = 2.5};
    case SkinEditKind::even:
      return {.low = 0.0, .high = 1.0, .size = 3.0};
    case SkinEditKind::foundation:
      return {.low = 0.0, .high = 1.0, .size = 10.0};
    case SkinEditKind::blush:
    case SkinEditKind::lipstick:
      return {.low = 0.0, .high = 1.0, .needs_mask = true};
    case SkinEditKind::scale:
      return {.low = 0.0, .high = 1000.0, .has_number = true};
    case SkinEditKind::add:
    case SkinEditKind::set:
      return {.low = -1000.0, .high = 1000.0, .has_number = true};
    case SkinEditKind::gamma:
      return {.low = 0.0, .high = 10.0, .has_number = true};
    case SkinEditKind::blur:
      return {.low = 0.0, .high = 1000.0, .has_number = true};
    case SkinEditKind::transfer:
      return {.has_number = true};
    case SkinEditKind::homogenize:
      return {};
    case SkinEditKind::pale:
    case SkinEditKind::saturation:
    case SkinEditKind::cyanosis:
      break;
  }
  return {.low = 0.0, .high = 1.0};
}

EditedSkin edited_skin(EditableSkin skin, const SkinEdit& edit) {
  check(edit, skin.skin);
  Course course{edit, {std::move(skin), {}}};
  if (edit.strength == 0.0 || neutral_amount(edit.kind) == edit.amount)
    return std::move(course.result);
  const double amount = edit.amount;
  /// What mixes in the amount, of another composition.
  const auto mixed_with = [amount](double composition) {
    return [amount, composition](double share) {
      return std::clamp((share + amount * composition) / (1.0 + amount), 0.0, 1.0);
    };
  };
  const auto times = [](double factor) { return [factor](double x) { return factor * x; }; };
  switch (edit.kind) {
    case SkinEditKind::tan:
      change(course, "melanin", times(1.0 + amount));
      change(course, "melanin_blend", mixed_with(tanned_blend));
      break;
    case SkinEditKind::flush:
      change_blood(course, times(1.0 + amount));
      change_saturation(course, mixed_with(flush_saturation));
      break;
    case SkinEditKind::pale:
      change_blood(course, times(1.0 - amount));
      break;
    case SkinEditKind::cyanosis:
      change_saturation(course, times(1.0 - amount));
      break;
    case SkinEditKind::saturation:
      for (const char* name : {"saturation_epidermis", "saturation_dermis"}) {
        const SkinNumber number = find_number(course.skin(), name);
        const Image values = values_of(course.skin(), number);
        const double shift =
            fit_coordinate(number.coordinate, amount) - mean_coordinate(course, number, values);
        const bool is_end = values.pixels.size() == 1 || amount == 0.0 || amount == 1.0;
        change(course, number, [&](double x) {
          if (is_end) return amount;
          return fit_value(number.coordinate, fit_coordinate(number.coordinate, x) + shift);
        });
      }
      break;
    case SkinEditKind::freckles:
      change_freckles(course);
      break;
    case SkinEditKind::foundation:
      make_even(course);
      change(course, "oiliness", times(1.0 - amount));
      break;
    case SkinEditKind::even:
      make_even(course);
      break;
    case SkinEditKind::blush:
      put_on(course, rouge);
      break;
    case SkinEditKind::lipstick:
      put_on(course, lip_color);
      break;
    case SkinEditKind::homogenize:
      homogenize(course);
      break;
    default:
      change_number(course);
  }
  return std::move(course.result);
}

}  // namespace lamina
