// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "lamina/skin/maps/edits/internal/skin_number.h"
#include "lamina/skin/maps/edits/skin_edits.h"

// What edits are made of: how a number of skin changes, at each texel by itself or with those
// around it, as far as the mask goes.

namespace lamina::skin_edits {

inline constexpr std::size_t chunk = 1 << 14;  ///< texels that one thread takes at a time

inline constexpr std::array<const char*, 7> pigments = {
    "melanin",  "melanin_blend",        "hemoglobin_epidermis", "hemoglobin_dermis",
    "carotene", "saturation_epidermis", "saturation_dermis"};

/// A skin in the course of an edit.
struct Course {
  const SkinEdit& edit;
  EditedSkin result;

  [[nodiscard]] SkinMaps& skin() { return result.skin.skin; }
  [[nodiscard]] bool has_mask() const { return !edit.mask.pixels.empty(); }
};

[[nodiscard]] Image in_size(const Image& image, int width, int height);

/// Where a mask varies a number of one texel becomes a map of the size of the others.
[[nodiscard]] Image on_the_grid(Course& course, Image values);

[[nodiscard]] Image coordinates_of(const SkinNumber& number, const Image& values);

/// Weights of texels that an edit looks at: where it is, and there is skin; empty: all alike.
[[nodiscard]] std::vector<float> area_of(const Course& course, int width, int height);

/// The mean of the coordinate there.
[[nodiscard]] double mean_coordinate(const Course& course, const SkinNumber& number,
                                     const Image& values);

/// The value of a coordinate, which may lie out of the range.
[[nodiscard]] double unbounded_value(const FitParameter& parameter, double coordinate);

/// A value within the range of its number; counts those that were not.
[[nodiscard]] float clamped(const SkinNumber& number, double value,
                            std::atomic<std::size_t>& count);
void note_clamped(Course& course, const SkinNumber& number, std::size_t count);

/// Drops the standard deviations of a map whose texels are mixed or replaced, with a warning.
void drop_deviation(Course& course, const SkinNumber& number);

/// Sets a number to what is wanted, as far as the mask and the strength go.
void put(Course& course, const SkinNumber& number, const Image& before, const Image& wanted);

/// Sets the coordinates of a number.
void put_coordinates(Course& course, const SkinNumber& number, const Image& before,
                     const Image& coordinates);

/// Changes a number at each texel by itself, and its standard deviation by the slope.
void change(Course& course, const SkinNumber& number,
            const std::function<double(double value)>& function);
void change(Course& course, const std::string& name,
            const std::function<double(double value)>& function);

/// The spread of a blur of `size` mm [texel]. @throws InvalidInput if texels have no known size
[[nodiscard]] double spread_of(const Course& course, double size, const Image& values);
/// The size of the edit, as given or as its kind has it [mm].
[[nodiscard]] double size_of(const Course& course);

}  // namespace lamina::skin_edits
