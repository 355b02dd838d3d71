// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace lamina::detail {

/// Bessel functions J_0, J_1, ... of x >= 0, as many as `out` holds, to 1e-13. Time grows with x.
///
/// Source: [AbramowitzStegun1964] 9.12, Example 1: Miller's backward recurrence.
void bessel_functions(double x, std::span<double> out);

/// Bessel functions J_0, J_1, ... of x >= 0, to 1e-7, of few orders and arguments from a table,
/// some ten times quicker: cubics with the slopes J_m' = (J_{m-1} - J_{m+1}) / 2
/// ([AbramowitzStegun1964] 9.1.27).
void tabulated_bessel_functions(double x, std::span<double> out);

}  // namespace lamina::detail
