// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/internal/detail_edits.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/image/blur.h"

namespace lamina::skin_edits {
namespace {

/// How far ln(melanin) lies above what it is between freckles, and above the unevenness there.
Image freckles_above(const Image& coordinates, double spread) {
  // Freckles draw a blur of all up: what exceeds it is cut off, and the rest blurred again.
  Image around = blurred(coordinates, spread);
  for (int pass = 0; pass < 2; ++pass) {
    Image low = coordinates;
    for (std::size_t i = 0; i < low.pixels.size(); ++i)
      low.pixels[i] = std::min(low.pixels[i], around.pixels[i]);
    around = blurred(low, spread);
  }
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < coordinates.pixels.size(); ++i) {
    const auto below = static_cast<double>(around.pixels[i] - coordinates.pixels[i]);
    if (below <= 0.0) continue;
    squares += below * below;
    count += 1.0;
  }
  const auto unevenness = static_cast<float>(count > 0.0 ? 2.0 * std::sqrt(squares / count) : 0.0);
  for (std::size_t i = 0; i < around.pixels.size(); ++i)
    around.pixels[i] = std::max(0.0f, coordinates.pixels[i] - around.pixels[i] - unevenness);
  return around;
}

/// Where freckles fade, the composition of their melanin becomes that of the skin between them.
void fade_blend(Course& course, const Image& above, double amount) {
  const SkinNumber number = find_number(course.skin(), "melanin_blend");
  const Image before = values_of(course.skin(), number);
  if (before.pixels.size() == 1) return;
  const Image height = in_size(above, before.width, before.height);
  Image coordinates = coordinates_of(number, before);
  Image between = coordinates, share = coordinates;  // of what is no freckle
  for (std::size_t i = 0; i < share.pixels.size(); ++i) {
    share.pixels[i] = std::exp(-4.0f * height.pixels[i]);
    between.pixels[i] *= share.pixels[i];
  }
  const double spread = spread_of(course, size_of(course), before);
  between = blurred(between, spread);
  const Image weight = blurred(share, spread);
  for (std::size_t i = 0; i < share.pixels.size(); ++i)
    coordinates.pixels[i] +=
        static_cast<float>(amount) * (1.0f - share.pixels[i]) *
        (between.pixels[i] / std::max(weight.pixels[i], 1e-6f) - coordinates.pixels[i]);
  put_coordinates(course, number, before, coordinates);
}

}  // namespace

void make_even(Course& course) {
  for (const char* name : pigments) {
    const SkinNumber number = find_number(course.skin(), name);
    const Image before = values_of(course.skin(), number);
    if (before.pixels.size() == 1) continue;
    Image coordinates = coordinates_of(number, before);
    const Image around = blurred(coordinates, spread_of(course, size_of(course), before));
    const auto part = static_cast<float>(1.0 - course.edit.amount);
    for (std::size_t i = 0; i < coordinates.pixels.size(); ++i)
      coordinates.pixels[i] = around.pixels[i] + part * (coordinates.pixels[i] - around.pixels[i]);
    put_coordinates(course, number, before, coordinates);
  }
}

void change_freckles(Course& course) {
  const SkinNumber number = find_number(course.skin(), "melanin");
  const Image before = values_of(course.skin(), number);
  if (before.pixels.size() == 1) {
    course.skin().warnings.emplace_back("melanin is one number, without freckles");
    return;
  }
  Image coordinates = coordinates_of(number, before);
  const Image above = freckles_above(coordinates, spread_of(course, size_of(course), before));
  const auto amount = static_cast<float>(course.edit.amount);
  // Stronger ones gain by a factor of exp(A) at most, or moles would turn black.
  for (std::size_t i = 0; i < coordinates.pixels.size(); ++i)
    coordinates.pixels[i] +=
        amount * (amount < 0.0f ? above.pixels[i] : 1.0f - std::exp(-above.pixels[i]));
  if (course.edit.amount < 0.0) fade_blend(course, above, -course.edit.amount);
  put_coordinates(course, number, before, coordinates);
}

}  // namespace lamina::skin_edits
