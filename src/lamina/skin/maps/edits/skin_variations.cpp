// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/skin_variations.h"

#include <atomic>
#include <utility>

#include "lamina/base/core/parallel_chunks.h"
#include "lamina/skin/maps/edits/internal/edit_course.h"

namespace lamina {
namespace {

using namespace skin_edits;

/// Moves the coordinates of a number by as much as its mean has to.
void move_mean(double wanted, const SkinNumber& number, EditedSkin& edited) {
  Image values = values_of(edited.skin.skin, number);
  const FitParameter& coordinate = number.coordinate;
  double shift = fit_coordinate(coordinate, wanted);
  for (const float value : values.pixels)
    shift -= fit_coordinate(coordinate, static_cast<double>(value)) /
             static_cast<double>(values.pixels.size());
  std::atomic<std::size_t> count = 0;
  const bool is_number = values.pixels.size() == 1;
  parallel_chunks(values.pixels.size(), chunk, [&](std::size_t i) {
    const double at = fit_coordinate(coordinate, static_cast<double>(values.pixels[i])) + shift;
    values.pixels[i] = clamped(number, is_number ? wanted : unbounded_value(coordinate, at), count);
  });
  if (count > 0) edited.clamped.push_back({number.name(), count});
  set_values(edited.skin.skin, number, std::move(values));
}

}  // namespace

EditedSkin skin_of_person(EditableSkin skin, const SkinParameters& person) {
  EditedSkin edited{std::move(skin), {}};
  for (const SkinFitNumber& number : skin_fit_numbers({}))
    for (double SkinParameters::*const member : number.values)
      for (const SkinNumber& own : numbers_of(edited.skin.skin))
        if (own.parameter == member) move_mean(person.*member, own, edited);
  return edited;
}

}  // namespace lamina
