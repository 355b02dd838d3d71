// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/rgb_encoding.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/spectrum/rgb_space.h"
#include "lamina/base/spectrum/srgb.h"

namespace lamina {
namespace {

constexpr double adobe_rgb_exponent = 563.0 / 256.0;

double rec709_decode(double number) {
  const double value = std::abs(number);
  const double light = value < 0.081 ? value / 4.5 : std::pow((value + 0.099) / 1.099, 1.0 / 0.45);
  return std::copysign(light, number);
}

/// Other names for one encoding: those of later releases of MaterialX, and of ACES.
constexpr std::array<std::array<std::string_view, 2>, 8> other_names = {{
    {"lin_srgb", "lin_rec709"},
    {"lin_rec709_scene", "lin_rec709"},
    {"srgb_rec709_scene", "srgb_texture"},
    {"lin_ap1", "acescg"},
    {"lin_ap1_scene", "acescg"},
    {"lin_p3d65_scene", "lin_displayp3"},
    {"srgb_p3d65_scene", "srgb_displayp3"},
    {"lin_adobergb_scene", "lin_adobergb"},
}};

constexpr std::array<std::string_view, 11> names = {
    "srgb_texture", "lin_rec709", "g22_rec709",   "g18_rec709",     "rec709_display", "acescg",
    "g22_ap1",      "adobergb",   "lin_adobergb", "srgb_displayp3", "lin_displayp3"};

}  // namespace

double linear_light(const RgbCurve& curve, double number) {
  switch (curve.kind) {
    case RgbCurve::Kind::srgb:
      return srgb_decode(number);
    case RgbCurve::Kind::rec709:
      return rec709_decode(number);
    case RgbCurve::Kind::power:
      break;
  }
  if (curve.exponent == 1.0) return number;
  return std::copysign(std::pow(std::abs(number), curve.exponent), number);
}

std::array<double, 3> linear_rec709(const RgbEncoding& encoding,
                                    const std::array<double, 3>& color) {
  const std::array<double, 3> light = {linear_light(encoding.curve, color[0]),
                                       linear_light(encoding.curve, color[1]),
                                       linear_light(encoding.curve, color[2])};
  const RgbPrimaries rec709 = rec709_primaries();
  if (are_alike(encoding.primaries, rec709)) return light;
  return rgb_conversion(encoding.primaries, rec709) * light;
}

RgbPrimaries display_p3_primaries() {
  return {{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, {0.3127, 0.3290}};
}

RgbPrimaries adobe_rgb_primaries() {
  return {{0.64, 0.33}, {0.21, 0.71}, {0.15, 0.06}, {0.3127, 0.3290}};
}

RgbEncoding adobe_rgb() {
  return {.primaries = adobe_rgb_primaries(), .curve = {.exponent = adobe_rgb_exponent}};
}

std::optional<RgbEncoding> rgb_encoding_named(std::string_view name) {
  name = usual_rgb_encoding_name(name);
  const RgbPrimaries rec709 = rec709_primaries(), ap1 = primaries_of(RgbSpace::acescg);
  const RgbCurve linear{}, srgb{.kind = RgbCurve::Kind::srgb};
  const auto power = [](double exponent) { return RgbCurve{.exponent = exponent}; };
  if (name == "srgb_texture") return RgbEncoding{rec709, srgb};
  if (name == "lin_rec709") return RgbEncoding{rec709, linear};
  if (name == "g22_rec709") return RgbEncoding{rec709, power(2.2)};
  if (name == "g18_rec709") return RgbEncoding{rec709, power(1.8)};
  if (name == "rec709_display") return RgbEncoding{rec709, power(2.4)};
  if (name == "acescg") return RgbEncoding{ap1, linear};
  if (name == "g22_ap1") return RgbEncoding{ap1, power(2.2)};
  if (name == "adobergb") return adobe_rgb();
  if (name == "lin_adobergb") return RgbEncoding{adobe_rgb_primaries(), linear};
  if (name == "srgb_displayp3") return RgbEncoding{display_p3_primaries(), srgb};
  if (name == "lin_displayp3") return RgbEncoding{display_p3_primaries(), linear};
  return std::nullopt;
}

std::string_view usual_rgb_encoding_name(std::string_view name) {
  for (const auto& [other, usual] : other_names)
    if (name == other) return usual;
  return name;
}

std::span<const std::string_view> rgb_encoding_names() { return names; }

}  // namespace lamina
