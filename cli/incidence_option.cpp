// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "incidence_option.h"

#include <charconv>
#include <numbers>

#include "lamina/base/core/error.h"

namespace lamina::cli {

double parse_incidence_degrees(const std::string& text) {
  double degrees = 0.0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, degrees);
  if (error != std::errc() || end != last || !(degrees >= 0.0 && degrees < 90.0))
    throw InvalidInput(
        "--incidence: must be normal, diffuse or an angle in [0, 90) degrees, but is \"" + text +
        "\"");
  return degrees;
}

Incidence parse_incidence(const std::string& text) {
  if (text == "normal") return {};
  if (text == "diffuse") return {.is_diffuse = true};
  return {.theta = parse_incidence_degrees(text) * std::numbers::pi / 180.0};
}

}  // namespace lamina::cli
