// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/base/image/image.h"
#include "lamina/skin/acquire/calibration/color_chart.h"
#include "lamina/skin/acquire/calibration/pixel_mask.h"
#include "lamina/skin/acquire/calibration/polarized_pair.h"
#include "lamina/skin/acquire/capture.h"

namespace lamina {

/// Photograph as a camera has it, with what develops it. Images are linear, and have the size and
/// channels of `image`. Strings `place` are where messages say that something is wrong.
struct PhotographDescription {
  /// White card within the image.
  struct Card {
    std::string place;
    std::vector<Vec2> corners;        ///< [pixel]
    std::vector<double> reflectance;  ///< [channel]
  };
  /// Photograph of a white that fills the image.
  struct White {
    std::string place;
    Image image;
    std::vector<double> reflectance = {1.0};  ///< of all channels, or [channel]
    double exposure_ratio = 1.0;              ///< over that of the image
    int count = 1;                            ///< of the photographs that it is the mean of
  };
  /// Other photograph of a pair, through parallel polarizers.
  struct Parallel {
    std::string place;
    Image image;
    PolarizedPairOptions options;
  };
  struct Chart {
    std::string place;
    std::optional<Image> image;  ///< absent: it lies in the photograph
    std::vector<Vec2> corners;   ///< as ChartCorners; empty: found
    ColorChartEdition edition = ColorChartEdition::before_november_2014;
  };
  std::string place;
  Image image;
  PixelMask mask;
  std::vector<double> errors;              ///< [channel] relative, as stated
  std::variant<double, Image> dark = 0.0;  ///< without light
  std::vector<double> saturation;          ///< [channel] or one; empty: found from a white's image
  /// Numbers of white, [channel], or how it is measured.
  std::variant<std::vector<double>, Card, White> white;
  std::optional<Parallel> parallel;
  std::optional<Chart> chart;
  double light = 1.0;  ///< on the skin over that on the white
};

/// Capture whose photographs are not developed yet.
struct CaptureDescription {
  struct Window {
    std::string place;
    std::vector<Vec2> corners;  ///< [pixel]; empty: found
    int edge = 2;               ///< pixels along it that are left out
  };
  /// All but reflectances, their deviations and mask, and what follows from these. Channels of
  /// `reflectance` are the bands.
  Capture capture;
  std::string place;  ///< of the photographs
  std::vector<PhotographDescription> photographs;
  std::optional<std::string> registered;  ///< place that wants bands moved onto the first
  bool masks_highlights = false;
  std::optional<Window> window;
  std::optional<PixelMask> mask;
  std::optional<std::string> gains_from_skin;  ///< place that wants them
};

/// Develops the photographs of a capture: to reflectances by white, dark and chart, joined,
/// registered, masked, and multiplied by gains that make them skin where these are wanted.
/// @throws InvalidInput, which begins with a place
[[nodiscard]] Capture develop_capture(CaptureDescription description);

}  // namespace lamina
