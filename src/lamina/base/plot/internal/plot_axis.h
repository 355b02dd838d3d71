// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/plot/plot.h"

// Axes of a plot: what they span and where their ticks are. Not installed.

namespace lamina {

/// The values that the axis must show.
struct ValueRange {
  double low = 0.0, high = 0.0;
  bool is_empty = true;

  /// Takes in a value; those that the scale cannot show are left out.
  void add(double value, AxisScale scale);
};

/// An axis whose span is settled: low < high, and 0 < low on a logarithmic one.
struct AxisSpan {
  AxisScale scale = AxisScale::linear;
  double low = 0.0, high = 1.0;

  /// 0 at low, 1 at high. NaN for what the scale cannot show.
  [[nodiscard]] double position(double value) const;
};

/// The axis' own limits, or else a little more than the values.
/// @throws InvalidInput if the limits are no range.
[[nodiscard]] AxisSpan make_span(const PlotAxis& axis, const ValueRange& values);

struct AxisTick {
  double value;
  std::string label;     ///< empty for minor ticks
  std::string exponent;  ///< of a label 10, raised; else empty
  bool is_major;
};

/// Ticks in the span; about one label per 45 px along x, 30 px along y.
[[nodiscard]] std::vector<AxisTick> make_ticks(const AxisSpan& span, double pixels,
                                               double pixels_per_label);

}  // namespace lamina
