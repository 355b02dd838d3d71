// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/plot/internal/plot_axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

bool is_log(AxisScale scale) { return scale == AxisScale::logarithmic; }

/// A number as people write it, with a true minus sign.
std::string tick_text(double value, int decimals) {
  std::string text = printf_text("%.*f", decimals, value);
  if (text.find_first_of("123456789") == std::string::npos && text[0] == '-') text.erase(0, 1);
  if (text[0] == '-') text.replace(0, 1, "−");
  return text;
}

std::string integer_text(int value) { return tick_text(value, 0); }

std::vector<AxisTick> linear_ticks(const AxisSpan& span, double labels) {
  const double rough = (span.high - span.low) / std::max(labels, 2.0);
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * decade;
  int minor_count = 5;
  for (const auto& [multiple, minors] : {std::pair{5.0, 5}, std::pair{2.0, 4}, std::pair{1.0, 5}})
    if (multiple * decade >= rough) {
      step = multiple * decade;
      minor_count = minors;
    }
  // Large and small numbers share a power of ten only through the unit, so plain digits are right
  // for the spans of fractions, angles and wavelengths that plots have; others get an exponent.
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  const bool is_plain = decimals <= 5 && std::max(std::abs(span.low), std::abs(span.high)) < 1e6;
  std::vector<AxisTick> ticks;
  const double minor = step / minor_count;
  const double tolerance = 1e-6 * minor;
  for (double i = std::ceil((span.low - tolerance) / minor);
       i * minor <= span.high + tolerance && ticks.size() < 200; ++i) {
    const bool is_major = std::fmod(std::abs(i), minor_count) == 0.0;
    AxisTick tick{.value = i * minor, .label = {}, .exponent = {}, .is_major = is_major};
    if (is_major && is_plain) tick.label = tick_text(tick.value, decimals);
    if (is_major && !is_plain)
      tick.label = printf_text("%.3g", tick.value == 0.0 ? 0.0 : tick.value);
    ticks.push_back(tick);
  }
  return ticks;
}

std::vector<AxisTick> log_ticks(const AxisSpan& span, double labels) {
  const double low = std::log10(span.low), high = std::log10(span.high);
  const double decades = high - low;
  const int every = std::max(1, static_cast<int>(std::ceil(decades / std::max(labels, 2.0))));
  const bool labels_within_decades = decades < 1.6;  // else 10 and 100 alone would stand there
  std::vector<AxisTick> ticks;
  for (int power = static_cast<int>(std::floor(low)); power <= static_cast<int>(std::ceil(high));
       ++power)
    for (int digit = 1; digit <= 9; ++digit) {
      const double value = digit * std::pow(10.0, power);
      if (value < span.low * (1.0 - 1e-9) || value > span.high * (1.0 + 1e-9)) continue;
      const bool is_decade = digit == 1;
      const bool is_major = is_decade && power % every == 0;
      if (!is_decade && decades > 12.0) continue;
      AxisTick tick{.value = value, .label = {}, .exponent = {}, .is_major = is_major};
      if (is_major || (labels_within_decades && (digit == 2 || digit == 5))) {
        const bool is_plain = labels_within_decades || (low > -3.01 && high < 4.01);
        if (is_plain && power >= -4 && power <= 4) {
          tick.label = tick_text(value, std::max(0, -power));
        } else {
          tick.label = is_decade ? "10" : integer_text(digit) + "·10";
          tick.exponent = integer_text(power);
        }
        tick.is_major = true;
      }
      ticks.push_back(tick);
    }
  return ticks;
}

}  // namespace

void ValueRange::add(double value, AxisScale scale) {
  if (!std::isfinite(value) || (is_log(scale) && value <= 0.0)) return;
  low = is_empty ? value : std::min(low, value);
  high = is_empty ? value : std::max(high, value);
  is_empty = false;
}

double AxisSpan::position(double value) const {
  if (!is_log(scale)) return (value - low) / (high - low);
  if (!(value > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return std::log(value / low) / std::log(high / low);
}

AxisSpan make_span(const PlotAxis& axis, const ValueRange& values) {
  const bool log = is_log(axis.scale);
  double low = log ? 0.1 : 0.0, high = 1.0;
  if (!values.is_empty) {
    low = values.low;
    high = values.high;
    if (log) {
      constexpr double most_decades = 14.0;  // numbers below are rounding errors
      low = std::max(low, high * std::pow(10.0, -most_decades));
      const double margin = low < high ? std::pow(high / low, 0.04) : 2.0;
      low /= margin;
      high *= margin;
    } else {
      const bool is_near_zero = low >= 0.0 && low < 0.3 * high;
      const double margin = low < high ? 0.05 * (high - low) : std::max(0.5 * std::abs(low), 0.5);
      low = is_near_zero ? 0.0 : low - margin;
      high += margin;
    }
  }
  const AxisSpan span{
      .scale = axis.scale, .low = axis.low.value_or(low), .high = axis.high.value_or(high)};
  if (!(std::isfinite(span.low) && std::isfinite(span.high) && span.low < span.high) ||
      (log && span.low <= 0.0))
    throw InvalidInput("axis \"" + axis.label + "\": its limits must ascend" +
                       (log ? " and be positive" : "") + ", but are " + number_text(span.low) +
                       " and " + number_text(span.high));
  return span;
}

std::vector<AxisTick> make_ticks(const AxisSpan& span, double pixels, double pixels_per_label) {
  const double labels = pixels / pixels_per_label;
  return is_log(span.scale) ? log_ticks(span, labels) : linear_ticks(span, labels);
}

}  // namespace lamina
