// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/plot/picture_sheet.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/base64.h"
#include "lamina/base/plot/internal/svg_canvas.h"
#include "lamina/base/spectrum/srgb.h"

namespace lamina {
namespace {

double luminance(const float* rgb) {
  return 0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
         0.0722 * static_cast<double>(rgb[2]);
}

}  // namespace

std::string format_sheet(const std::string& title, const std::vector<SheetPicture>& pictures,
                         int columns) {
  assert(columns >= 1);
  constexpr double gap = 12.0, caption_size = 13.0, caption_height = 28.0;
  const double top = title.empty() ? gap : 40.0;
  double cell_width = 1.0, cell_height = 1.0;
  for (const SheetPicture& picture : pictures) {
    cell_width = std::max({cell_width, static_cast<double>(picture.image.width),
                           text_width(picture.caption, caption_size)});
    cell_height = std::max(cell_height, static_cast<double>(picture.image.height));
  }
  SvgCanvas canvas;
  if (!title.empty()) canvas.text(gap, 26.0, title, {.size = 17.0, .is_bold = true});
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const double column = static_cast<double>(i % static_cast<std::size_t>(columns));
    const double row = static_cast<double>(i / static_cast<std::size_t>(columns));
    const double x = gap + column * (cell_width + gap);
    const double y = top + row * (cell_height + caption_height);
    canvas.image(x, y, pictures[i].image.width, pictures[i].image.height,
                 "data:image/png;base64," + base64(encode_png(pictures[i].image)));
    canvas.text(x, y + pictures[i].image.height + 16.0, pictures[i].caption,
                {.size = caption_size});
  }
  const double rows = std::ceil(static_cast<double>(pictures.size()) / columns);
  return canvas.finish(gap + columns * (cell_width + gap),
                       top + rows * (cell_height + caption_height));
}

Image difference_map(const Image& render, const Image& reference, double range) {
  assert(range > 0.0);
  const Image a = select_channels(render, {"R", "G", "B"});
  const Image b = select_channels(reference, {"R", "G", "B"});
  if (a.width != b.width || a.height != b.height)
    throw InvalidInput("difference_map: the images must have one size");
  double mean = 0.0;
  const std::size_t count = b.pixels.size() / 3;
  for (std::size_t i = 0; i < count; ++i)
    mean += luminance(&b.pixels[3 * i]) / static_cast<double>(count);
  Image map = make_image(a.width, a.height, {"R", "G", "B"});
  for (std::size_t i = 0; i < count; ++i) {
    const double there = luminance(&b.pixels[3 * i]);
    const double scale = range * std::max(std::max(there, 0.25 * mean), 1e-30);
    const double d = std::clamp((luminance(&a.pixels[3 * i]) - there) / scale, -1.0, 1.0);
    const double away = std::abs(d);
    // Even steps to the eye, so in encoded values: white to vermilion, white to blue.
    const double red = d > 0.0 ? 1.0 - 0.16 * away : 1.0 - away;
    const double green = 1.0 - (d > 0.0 ? 0.63 : 0.55) * away;
    const double blue = d > 0.0 ? 1.0 - away : 1.0 - 0.30 * away;
    map.pixels[3 * i] = static_cast<float>(srgb_decode(red));
    map.pixels[3 * i + 1] = static_cast<float>(srgb_decode(green));
    map.pixels[3 * i + 2] = static_cast<float>(srgb_decode(blue));
  }
  return map;
}

}  // namespace lamina
