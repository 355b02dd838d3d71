// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/vec.h"
#include "lamina/base/image/image.h"
#include "lamina/base/spectrum/color.h"
#include "lamina/skin/acquire/calibration/color_correction.h"

namespace lamina {

/// Charts of 24 patches are made with other pigments since November 2014; the date is on the back.
enum class ColorChartEdition { before_november_2014, from_november_2014 };

template <>
inline constexpr auto enum_names<ColorChartEdition> = std::to_array<EnumName<ColorChartEdition>>(
    {{"before_november_2014", ColorChartEdition::before_november_2014},
     {"from_november_2014", ColorChartEdition::from_november_2014}});

inline constexpr int chart_columns = 6, chart_rows = 4;
inline constexpr std::size_t chart_patches = 24;

/// Color of a patch by its maker, for illuminant D50 and the 2 degree observer; from dark skin by
/// rows, with the white one first in the last.
struct ChartColor {
  std::string_view name;
  Lab lab;
};

/// Source: [XRite2016]; the chart is that of [McCamy1976].
[[nodiscard]] const std::array<ChartColor, chart_patches>& chart_colors(ColorChartEdition edition);

/// Colors of a chart as linear sRGB, where (1, 1, 1) is a perfect white: adapted from D50 to D65
/// (Bradford). That of cyan lies outside of [0, 1].
[[nodiscard]] std::array<LinearSrgb, chart_patches> chart_srgb(ColorChartEdition edition);

/// Centres of the corner patches in an image, in pixels from its upper left corner: dark skin,
/// bluish green, black, white.
using ChartCorners = std::array<Vec2, 4>;

/// Reading of an image in the middle of a patch.
struct PatchReading {
  std::array<double, 3> mean{}, deviation{};  ///< of pixels
  std::size_t pixels = 0, saturated = 0;
};

struct ChartReading {
  ChartCorners corners{};
  std::array<PatchReading, chart_patches> patches;
};

struct ChartOptions {
  /// Numbers from this on are saturated.
  double saturation = std::numeric_limits<double>::infinity();
  ColorChartEdition edition = ColorChartEdition::before_november_2014;
};

/// Finds a chart and reads it: flat quadrilaterals in a lattice of 6 by 4, at any size, turn and
/// perspective, in the one place and turn where a matrix turns their colors into the chart's.
///
/// Not found are charts whose patches are less than some 8 pixels wide, half of which are hidden,
/// that are mirrored or out of focus, or with more than one light on them; of several charts the
/// one with the most patches is taken.
///
/// @param image  linear, with channels "R", "G", "B"
/// @param name   of the image in messages
/// @throws InvalidInput if there is none: give its corners instead.
[[nodiscard]] ChartReading find_color_chart(const Image& image, const std::string& name,
                                            const ChartOptions& options = {});

/// Reads a chart whose corners are known: means over the middle of each patch, .4 of the way to the
/// next one wide.
/// @throws InvalidInput if the corners lie outside of the image, go the wrong way round, are not
///         those of a convex quadrilateral, or so near that patches have fewer than 9 pixels.
[[nodiscard]] ChartReading read_color_chart(const Image& image, const ChartCorners& corners,
                                            const std::string& name,
                                            const ChartOptions& options = {});

/// The outline of a chart with these corners, a quarter of a patch beyond its patches: where there
/// is chart and no skin.
[[nodiscard]] std::array<Vec2, 4> chart_outline(const ChartCorners& corners);

/// The patches of a reading for fit_color_correction, without those of which one pixel in a hundred
/// is saturated. @throws InvalidInput if fewer than 12 are left.
[[nodiscard]] std::vector<ColorSample> color_samples(const ChartReading& reading,
                                                     ColorChartEdition edition);

}  // namespace lamina
