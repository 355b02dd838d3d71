// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

// Writes SVG elements. Lengths are in px, y points down. Not installed.

namespace lamina {

/// A length with at most two decimals.
[[nodiscard]] std::string svg_number(double value);

/// Text with the characters that XML keeps for itself replaced.
[[nodiscard]] std::string svg_escaped(std::string_view text);

/// About how wide text is [px], rather too wide.
[[nodiscard]] double text_width(std::string_view text, double font_size);

enum class TextAnchor { start, middle, end };

struct TextStyle {
  double size = 11.0;
  TextAnchor anchor = TextAnchor::start;
  std::string_view color = "#222222";
  bool is_bold = false;
  double turn = 0.0;      ///< clockwise [degrees]
  bool has_halo = false;  ///< a white rim, for text on lines
};

class SvgCanvas {
 public:
  void line(double x0, double y0, double x1, double y1, std::string_view color, double width);
  void rectangle(double x, double y, double width, double height, std::string_view attributes);
  void circle(double x, double y, double radius, std::string_view attributes);
  void path(std::string_view data, std::string_view attributes);

  /// A picture by its address, which may hold it ("data:...").
  void image(double x, double y, double width, double height, std::string_view address);

  /// Text whose baseline starts, has its middle, or ends at (x, y); `raised` follows as exponent.
  void text(double x, double y, std::string_view text, const TextStyle& style,
            std::string_view raised = {});

  void begin_group(std::string_view attributes);
  void end_group();

  /// Clips what follows, until the group ends, to a rectangle.
  void begin_clip(double x, double y, double width, double height);

  /// The whole file, on white.
  [[nodiscard]] std::string finish(double width, double height) const;

 private:
  std::string body_;
  int clips_ = 0;
};

}  // namespace lamina
