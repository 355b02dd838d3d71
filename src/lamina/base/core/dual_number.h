// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lamina {

/// A number and what it changes by: arithmetic with both gives derivatives (forward mode).
struct Dual {
  double value = 0.0, change = 0.0;
};
[[nodiscard]] inline Dual operator+(Dual a, Dual b) {
  return {a.value + b.value, a.change + b.change};
}
[[nodiscard]] inline Dual operator-(Dual a, Dual b) {
  return {a.value - b.value, a.change - b.change};
}
[[nodiscard]] inline Dual operator*(Dual a, Dual b) {
  return {a.value * b.value, a.change * b.value + a.value * b.change};
}
[[nodiscard]] inline Dual operator/(Dual a, Dual b) {
  const double ratio = a.value / b.value;
  return {ratio, (a.change - ratio * b.change) / b.value};
}

}  // namespace lamina
