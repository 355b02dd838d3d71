// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "invert_texture.h"

#include <fmt/core.h>

#include <array>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"

namespace lamina::cli {
namespace {

constexpr std::array<const char*, 3> rgb = {"R", "G", "B"};

/// A row of texels whose color is not reached.
struct Unreached {
  std::size_t count = 0;
  int x = 0;  ///< the first
  std::size_t channel = 0;
};

}  // namespace

InvertedTexture invert_texture(const TextureInversion& wanted, const HalfSpaceLook& look,
                               MemoryBudget memory, const Progress& progress) {
  // Colors, and what is made of them: albedos, coefficients and coverage.
  const std::size_t made = 2 * rgb.size() + (wanted.radius ? 2 * rgb.size() : 0) + 1;
  const Image texture = load_image(wanted.file,
                                   ImageReading{.encoding = of_colors(wanted.encoding),
                                                .more_bytes_per_pixel = made * sizeof(float)},
                                   memory);
  require_finite(texture, wanted.file);
  const Image colors = rgb_image(texture);
  const auto alpha = channel_index(texture, "A");
  std::vector<std::string> channels(rgb.begin(), rgb.end());
  if (wanted.radius)
    for (const char* coefficient : {"sigma_a.", "sigma_s."})
      for (const char* channel : rgb) channels.push_back(std::string(coefficient) + channel);
  if (alpha) channels.emplace_back("A");
  take_memory(memory, colors.pixels.size() / rgb.size(),
              (channels.size() + rgb.size()) * sizeof(float),
              wanted.file + ": what is inverted of it");
  InvertedTexture inverted{.image = make_image(colors.width, colors.height, channels)};

  const HalfSpaceColor half_space(look);
  const auto height = static_cast<std::size_t>(colors.height);
  std::vector<Unreached> unreached(height);  // [row]
  const auto invert_row = [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < colors.width; ++x) {
      const float* const color = colors.at(x, y);
      float* const out = inverted.image.at(x, y);
      bool is_reached = true;
      for (std::size_t c = 0; c < rgb.size(); ++c) {
        const auto wish = static_cast<double>(color[c]);
        if (is_reached && !half_space.is_reachable(wish)) {
          is_reached = false;
          if (unreached[row].count++ == 0) unreached[row] = {1, x, c};
        }
        const double albedo = half_space.nearest_albedo(wish);
        out[c] = static_cast<float>(albedo);
        if (!wanted.radius) continue;
        const Medium medium = medium_of(look, albedo, (*wanted.radius)[c], wanted.meaning);
        out[3 + c] = static_cast<float>(medium.sigma_a);
        out[6 + c] = static_cast<float>(medium.sigma_s);
      }
      if (alpha) out[channels.size() - 1] = texture.at(x, y)[*alpha];
    }
  };
  parallel_for(height, invert_row, progress);

  for (std::size_t row = height; row-- > 0;) inverted.clamped += unreached[row].count;
  if (inverted.clamped == 0 || wanted.takes_nearest) return inverted;
  std::size_t first = 0;
  while (unreached[first].count == 0) ++first;
  const Unreached& there = unreached[first];
  const float value = colors.at(there.x, static_cast<int>(first))[there.channel];
  std::string what;
  try {
    (void)half_space.albedo(static_cast<double>(value));
  } catch (const InvalidInput& error) {
    what = error.what();
  }
  throw InvalidInput(
      fmt::format("{}: {} of {} texels cannot be reached, the first at x {}, y {}: {} {}; --clamp "
                  "takes the nearest colors",
                  wanted.file, inverted.clamped, height * static_cast<std::size_t>(colors.width),
                  there.x, first, rgb[there.channel], what));
}

}  // namespace lamina::cli
