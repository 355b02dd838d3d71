// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/base/image/image.h"

namespace lamina {

/// The window in a black tape that limits light to a piece of skin, as an image shows it.
struct LightWindow {
  /// In pixels from the upper left corner of the image, from the one nearest to it clockwise.
  std::array<Vec2, 4> corners{};
  double error = 0.0;      ///< expected error of a corner [pixel]
  double roughness = 0.0;  ///< root mean square distance of the edge from straight lines [pixel]
};

struct LightWindowOptions {
  double least_area = 0.01;     ///< share of the image
  double most_roughness = 1.5;  ///< [pixel], of a window; more is something else
};

/// Finds a bright convex quadrilateral in a dark frame: the largest bright region by Otsu's
/// threshold of the mean over the channels, its four corners, and along each side the places where
/// the image passes the middle between bright and dark, to which a robust line is fitted.
///
/// Corners are found to some hundredths of a pixel in sharp images with noise of 1 % (tests). Light
/// that skin carries below the tape moves no edge, as tape lies above it; blur moves none, either,
/// but rounds corners, which are left out. Lens distortion bends sides: see `roughness`.
///
/// @param name  of the image in messages
/// @throws InvalidInput if there is none: give its corners instead.
///
/// Source: [Donner2008] §6.2 for the tape; [Otsu1979].
[[nodiscard]] LightWindow find_light_window(const Image& image, const std::string& name,
                                            const LightWindowOptions& options = {});

/// How much of each pixel a polygon covers, exactly, in a channel "Y": the pattern of light that
/// shines through a window, or a mask (mask_from_image).
/// @param corners  in pixels, in either direction, of a polygon without crossings; parts may lie
///                 beyond the image.
/// @throws InvalidInput if there are fewer than 3 or more than 10000 corners, they are not finite,
///         sides cross each other (looked at up to 1000 corners), or there is no area.
[[nodiscard]] Image polygon_image(std::span<const Vec2> corners, int width, int height);

}  // namespace lamina
