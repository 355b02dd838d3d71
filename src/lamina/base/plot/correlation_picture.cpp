// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/plot/correlation_picture.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "lamina/base/core/number_text.h"
#include "lamina/base/plot/internal/svg_canvas.h"

namespace lamina {
namespace {

constexpr double correlation_gap = 12.0, name_size = 11.0;

/// White at 0; the ends are two of [OkabeIto2008], vermilion and blue.
std::string fill_of(double correlation) {
  const double share = std::min(std::abs(correlation), 1.0);
  const auto toward = [&](int end) {
    return 255 + static_cast<int>(std::lround(share * (end - 255)));
  };
  const bool is_positive = correlation > 0.0;
  return printf_text("fill=\"#%02x%02x%02x\"", toward(is_positive ? 213 : 0),
                     toward(is_positive ? 94 : 114), toward(is_positive ? 0 : 178));
}

/// Short enough for a cell: ".97", "−.30"; three digits where two would say 1.
std::string digits_of(double correlation) {
  const double size = std::abs(correlation);
  const std::string text = printf_text(size >= 0.995 && size < 0.9995 ? "%.3f" : "%.2f", size);
  return (correlation < -0.005 ? "−" : "") + (size >= 0.9995 ? "1"
                                              : size < 0.005 ? "0"
                                                             : text.substr(1));
}

}  // namespace

std::string format_correlations(std::span<const std::string> names,
                                const DenseMatrix& correlation) {
  const std::size_t count = names.size();
  assert(count > 0 && correlation.rows == count && correlation.columns == count);
  const double cell = count <= 12 ? 40.0 : 29.0, digit_size = count <= 12 ? 11.0 : 8.5;
  double names_width = 0.0;
  std::vector<std::string> labels;
  for (std::size_t i = 0; i < count; ++i) {
    labels.push_back(names[i] + " · " + std::to_string(i + 1));
    names_width = std::max(names_width, text_width(labels.back(), name_size));
  }
  const double left = correlation_gap + names_width + 6.0, top = correlation_gap;
  const double side = cell * static_cast<double>(count);
  SvgCanvas canvas;
  for (std::size_t i = 0; i < count; ++i) {
    const double y = top + cell * static_cast<double>(i), middle = y + 0.5 * cell + 4.0;
    canvas.text(left - 6.0, middle, labels[i], {.size = name_size, .anchor = TextAnchor::end});
    canvas.text(left + cell * (static_cast<double>(i) + 0.5), top + side + 14.0,
                std::to_string(i + 1), {.size = name_size, .anchor = TextAnchor::middle});
    for (std::size_t j = 0; j <= i; ++j) {
      const double x = left + cell * static_cast<double>(j);
      const double value = correlation(i, j);
      canvas.rectangle(x, y, cell, cell,
                       (i == j ? "fill=\"#e8e8e8\"" : fill_of(value)) +
                           " stroke=\"#ffffff\" stroke-width=\"1\"");
      canvas.text(x + 0.5 * cell, middle, i == j ? "1" : digits_of(value),
                  {.size = digit_size,
                   .anchor = TextAnchor::middle,
                   .color = i == j                   ? "#999999"
                            : std::abs(value) > 0.75 ? "#ffffff"
                                                     : "#111111"});
    }
  }

  // The legend, below.
  constexpr int steps = 40;
  const double bar = std::max(140.0, std::min(side, 240.0)), y = top + side + 30.0;
  for (int step = 0; step < steps; ++step)
    canvas.rectangle(left + bar * step / steps, y, bar / steps + 0.5, 10.0,
                     fill_of(-1.0 + 2.0 * (step + 0.5) / steps));
  const auto mark = [&](double place, const std::string& text, TextAnchor anchor) {
    canvas.text(left + bar * place, y + 24.0, text, {.size = name_size, .anchor = anchor});
  };
  mark(0.0, "−1", TextAnchor::start);
  mark(0.5, "0: independent", TextAnchor::middle);
  mark(1.0, "1", TextAnchor::end);
  return canvas.finish(left + std::max(side, bar) + correlation_gap, y + 24.0 + correlation_gap);
}

}  // namespace lamina
