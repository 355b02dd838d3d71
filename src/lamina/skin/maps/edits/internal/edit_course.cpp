// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/internal/edit_course.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/float_within.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel_chunks.h"
#include "lamina/base/image/resample.h"

namespace lamina::skin_edits {
namespace {

using Function = std::function<double(double value)>;

/// How far the edit goes at each texel; empty: all the way.
std::vector<float> weights_of(const SkinEdit& edit, int width, int height) {
  if (edit.mask.pixels.empty() && edit.strength == 1.0) return {};
  const std::size_t texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<float> weights = edit.mask.pixels.empty() ? std::vector<float>(texels, 1.0f)
                                                        : in_size(edit.mask, width, height).pixels;
  for (float& weight : weights) weight *= static_cast<float>(edit.strength);
  return weights;
}

/// How much the coordinate of a number changes with that before.
double coordinate_slope(const FitParameter& parameter, const Function& function, double value) {
  constexpr double step = 1e-4;
  const double at = fit_coordinate(parameter, value);
  const auto moved = [&](double by) {
    return fit_coordinate(parameter, std::clamp(function(unbounded_value(parameter, at + by)),
                                                parameter.low, parameter.high));
  };
  return (moved(step) - moved(-step)) / (2.0 * step);
}

}  // namespace

Image in_size(const Image& image, int width, int height) {
  if (image.width == width && image.height == height) return image;
  return resampled(image, width, height);
}

/// Where a mask varies a number of one texel becomes a map of this size.
Image on_the_grid(Course& course, Image values) {
  if (values.pixels.size() > 1 || !course.has_mask()) return values;
  const Image* map = first_map(course.skin());
  const Image& grid = map ? *map : course.edit.mask;
  return resampled(values, grid.width, grid.height);
}

/// A number of coordinates [texel] into a value of the number, and whether it had to be clamped.
float clamped(const SkinNumber& number, double value, std::atomic<std::size_t>& count) {
  const auto& [low, high] = std::pair(number.coordinate.low, number.coordinate.high);
  constexpr double rounding = 1e-6;
  if (value < low - rounding * (high - low) || value > high + rounding * (high - low)) ++count;
  return float_within(value, low, high);
}

/// The value of a coordinate, which may lie out of the range.
double unbounded_value(const FitParameter& parameter, double coordinate) {
  return parameter.scale == FitScale::logarithmic ? std::exp(coordinate) - parameter.offset
                                                  : fit_value(parameter, coordinate);
}

Image coordinates_of(const SkinNumber& number, const Image& values) {
  Image result = values;
  parallel_chunks(values.pixels.size(), chunk, [&](std::size_t i) {
    result.pixels[i] = static_cast<float>(
        fit_coordinate(number.coordinate, static_cast<double>(values.pixels[i])));
  });
  return result;
}

void note_clamped(Course& course, const SkinNumber& number, std::size_t count) {
  if (count > 0) course.result.clamped.push_back({number.name(), count});
}

void drop_deviation(Course& course, const SkinNumber& number) {
  auto& deviations = course.result.skin.deviations;
  const auto found = std::ranges::find(deviations, number.name(), &SkinMapDeviation::name);
  if (found == deviations.end()) return;
  deviations.erase(found);
  course.skin().warnings.push_back(number.name() + ": its standard deviations are dropped, for " +
                                   std::string(name_of(course.edit.kind)) +
                                   " mixes or replaces its texels");
}

/// Sets a number to what is wanted, as far as the mask and the strength go.
void put(Course& course, const SkinNumber& number, const Image& before, const Image& wanted) {
  Image values = in_size(before, wanted.width, wanted.height);
  const std::size_t channels = values.channel_count(), given = wanted.channel_count();
  const std::vector<float> weights = weights_of(course.edit, values.width, values.height);
  std::atomic<bool> has_changed = false;
  parallel_chunks(values.pixels.size(), chunk, [&](std::size_t i) {
    const float weight = weights.empty() ? 1.0f : weights[i / channels];
    const float from = values.pixels[i], to = wanted.pixels[given == channels ? i : i / channels];
    if (weight <= 0.0f || from == to) return;
    has_changed = true;
    if (weight >= 1.0f) {
      values.pixels[i] = to;
      return;
    }
    const double start = fit_coordinate(number.coordinate, static_cast<double>(from));
    const double end = fit_coordinate(number.coordinate, static_cast<double>(to));
    values.pixels[i] = static_cast<float>(std::clamp(
        fit_value(number.coordinate, start + static_cast<double>(weight) * (end - start)),
        number.coordinate.low, number.coordinate.high));
  });
  if (has_changed) set_values(course.skin(), number, std::move(values));
}

/// Changes a number at each texel by itself.
void change(Course& course, const SkinNumber& number, const Function& function) {
  const Image before = on_the_grid(course, values_of(course.skin(), number));
  Image wanted = before;
  std::atomic<std::size_t> count = 0;
  const std::vector<float> weights = weights_of(course.edit, before.width, before.height);
  const std::size_t channels = before.channel_count();
  const auto weight = [&](std::size_t i) {
    return weights.empty() ? 1.0 : static_cast<double>(weights[i / channels]);
  };
  parallel_chunks(before.pixels.size(), chunk, [&](std::size_t i) {
    if (weight(i) <= 0.0) return;
    wanted.pixels[i] = clamped(number, function(static_cast<double>(before.pixels[i])), count);
  });
  note_clamped(course, number, count);
  auto& deviations = course.result.skin.deviations;
  const auto found = std::ranges::find(deviations, number.name(), &SkinMapDeviation::name);
  if (found != deviations.end())
    parallel_chunks(before.pixels.size(), chunk, [&](std::size_t i) {
      const double slope =
          coordinate_slope(number.coordinate, function, static_cast<double>(before.pixels[i]));
      found->values.pixels[i] *= static_cast<float>(std::abs(1.0 + weight(i) * (slope - 1.0)));
    });
  put(course, number, before, wanted);
}

void change(Course& course, const std::string& name, const Function& function) {
  change(course, find_number(course.skin(), name), function);
}

std::vector<float> area_of(const Course& course, int width, int height) {
  std::vector<float> area;
  for (const Image* mask : {&course.edit.mask, &course.result.skin.mask}) {
    if (mask->pixels.empty()) continue;
    const Image part = in_size(*mask, width, height);
    if (area.empty()) area.assign(part.pixels.size(), 1.0f);
    for (std::size_t i = 0; i < area.size(); ++i) area[i] *= part.pixels[i];
  }
  return area;
}

double mean_coordinate(const Course& course, const SkinNumber& number, const Image& values) {
  const std::vector<float> weights = area_of(course, values.width, values.height);
  const std::size_t channels = values.channel_count();
  double sum = 0.0, all = 0.0;
  for (std::size_t i = 0; i < values.pixels.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : static_cast<double>(weights[i / channels]);
    all += weight;
    sum += weight * fit_coordinate(number.coordinate, static_cast<double>(values.pixels[i]));
  }
  return all > 0.0 ? sum / all : 0.0;
}

/// The spread of a blur of `size` mm [texel].
double spread_of(const Course& course, double size, const Image& values) {
  if (!(course.result.skin.width_mm > 0.0))
    throw InvalidInput(
        "the size of a texel in mm must be known, but maps over a mesh do not say it");
  return size * values.width / course.result.skin.width_mm;
}

double size_of(const Course& course) {
  return course.edit.size > 0.0 ? course.edit.size : skin_edit_range(course.edit.kind).size;
}

/// The values of coordinates, as what is wanted.
void put_coordinates(Course& course, const SkinNumber& number, const Image& before,
                     const Image& coordinates) {
  Image wanted = coordinates;
  std::atomic<std::size_t> count = 0;
  parallel_chunks(wanted.pixels.size(), chunk, [&](std::size_t i) {
    wanted.pixels[i] = clamped(
        number, unbounded_value(number.coordinate, static_cast<double>(coordinates.pixels[i])),
        count);
  });
  note_clamped(course, number, count);
  drop_deviation(course, number);
  put(course, number, before, wanted);
}

}  // namespace lamina::skin_edits
