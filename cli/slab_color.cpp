// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "slab_color.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lamina/base/spectrum/band_color.h"
#include "lamina/solve/reflectance/skin_colors.h"

namespace lamina::cli {
namespace {

/// Light less than this share of what arrives has no color worth telling.
constexpr double least_light = 1e-4;

JsonOutput color_json(const DisplayColor& color) {
  JsonOutput linear, srgb = JsonOutput::array();
  for (const double channel : color.linear) linear.push_back(channel);
  for (const int channel : color.srgb) srgb.push_back(channel);
  return {{"linear_srgb", linear},
          {"srgb", srgb},
          {"hex", color.hex()},
          {"is_cut_off", color.is_cut_off}};
}

std::string color_text(std::string_view name, const DisplayColor& color, bool has_chips) {
  const auto& [red, green, blue] = color.srgb;
  return fmt::format(
      "{:<22}  {}  sRGB {:3} {:3} {:3}{}{}\n", name, color.hex(), red, green, blue,
      has_chips ? fmt::format("  \x1b[48;2;{};{};{}m        \x1b[0m", red, green, blue) : "",
      color.is_cut_off ? "  (cut off: sRGB cannot show it)" : "");
}

}  // namespace

std::string DisplayColor::hex() const {
  return fmt::format("#{:02x}{:02x}{:02x}", srgb[0], srgb[1], srgb[2]);
}

DisplayColor display_color(const LinearSrgb& linear) {
  DisplayColor color{.linear = linear};
  for (std::size_t c = 0; c < linear.size(); ++c) {
    const double encoded = 255.0 * srgb_encode(linear[c]);
    color.srgb[c] = static_cast<int>(std::lround(std::clamp(encoded, 0.0, 255.0)));
    if (encoded < -0.5 || encoded >= 255.5) color.is_cut_off = true;
  }
  return color;
}

std::optional<SlabColors> slab_colors(const Material& material,
                                      const std::vector<SlabTotals>& totals) {
  const BandWeights weights = material.skin
                                  ? make_skin_band_weights(material.bands, material.skin->skin)
                                  : make_band_weights(material.bands);
  if (!tells_colors(weights)) return std::nullopt;
  std::vector<double> reflected, transmitted;
  for (const SlabTotals& band : totals) {
    reflected.push_back(band.diffuse_reflectance);
    transmitted.push_back(band.transmittance);
  }
  SlabColors colors{.reflected = display_color(linear_srgb(weights, reflected))};
  if (std::ranges::max(transmitted) >= least_light)
    colors.transmitted = display_color(linear_srgb(weights, transmitted));
  return colors;
}

JsonOutput slab_colors_json(const SlabColors& colors) {
  JsonOutput json = {{"reflected", color_json(colors.reflected)}};
  if (colors.transmitted) json["transmitted"] = color_json(*colors.transmitted);
  return json;
}

std::string slab_colors_text(const SlabColors& colors, bool has_chips) {
  std::string text = color_text("color", colors.reflected, has_chips);
  if (colors.transmitted) text += color_text("color, seen through", *colors.transmitted, has_chips);
  return text;
}

}  // namespace lamina::cli
