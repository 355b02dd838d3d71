// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace lamina {

/// A number, or a list of them; one number stands for a list of any length.
using ExpressionValue = std::vector<double>;

/// Values that an expression gets from outside.
struct ExpressionSources {
  /// Value of a name with its path, as written: `mc.reflectance_profile[:][1]`.
  std::function<ExpressionValue(std::string_view path)> value;
  /// Values that a path leads to in every run whose name starts with `prefix`, one after the other.
  std::function<ExpressionValue(const std::string& prefix, const std::string& path)> runs;
  /// A channel of a picture, row by row, within a part of its width and height.
  std::function<ExpressionValue(const std::string& file, const std::string& channel, double left,
                                double top, double right, double bottom)>
      pixels;
};

/// The value of an expression, by which entries of a reproduction say what they draw and check:
///
///     max(abs(mc.transmittance / dipole.transmittance - 1)) < 0.05
///
/// Numbers, lists [a, b], names with their paths, + - * / ^, comparisons (1 or 0), & and |, and
/// functions, element by element:
///
/// | abs sqrt exp log log10 sin cos | of each |
/// | min max | of all, or of two lists each |
/// | mean sum rms count first last all any | of all |
/// | at(x, y, x0) | y at x0, linear between points; ends beyond them |
/// | integral(x, y) | by trapezoids |
/// | peak(x, y) | the x of the largest y |
/// | slice(a, i, j) | elements i to j - 1; from the end if negative |
/// | reverse(a) | from the last element to the first |
/// | range(a, b, n) | n numbers from a to b |
/// | if(c, a, b) | of each |
/// | runs('PREFIX', 'path') | the path in each run whose name starts so |
/// | pixels('FILE', 'CHANNEL', left, top, right, bottom) | of a picture, in fractions of its size |
///
/// @throws InvalidInput naming the expression and the place in it where it cannot be understood,
/// where lengths differ, or whatever `sources` throw.
[[nodiscard]] ExpressionValue evaluate_expression(std::string_view text,
                                                  const ExpressionSources& sources);

/// Evaluates an expression where one number is wanted. @throws InvalidInput if it is a list.
[[nodiscard]] double evaluate_number(std::string_view text, const ExpressionSources& sources);

}  // namespace lamina
