// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/internal/connected_regions.h"

#include <algorithm>
#include <map>

namespace lamina {

std::vector<PixelRegion> connected_regions(const std::vector<bool>& set, int width, int height) {
  struct RowSpan {
    int first, last;
  };
  std::vector<PixelRegion> regions;
  std::vector<bool> left = set;
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  };
  std::vector<std::pair<int, int>> waiting;
  for (int y0 = 0; y0 < height; ++y0)
    for (int x0 = 0; x0 < width; ++x0) {
      if (!left[index(x0, y0)]) continue;
      PixelRegion region;
      std::map<int, RowSpan> rows;
      left[index(x0, y0)] = false;
      waiting.emplace_back(x0, y0);
      while (!waiting.empty()) {
        const auto [x, y] = waiting.back();
        waiting.pop_back();
        ++region.pixels;
        region.centroid = region.centroid + Vec2{x + 0.5, y + 0.5};
        region.touches_edge =
            region.touches_edge || x == 0 || y == 0 || x == width - 1 || y == height - 1;
        const auto [row, is_new] = rows.try_emplace(y, RowSpan{x, x});
        row->second = {std::min(row->second.first, x), std::max(row->second.last, x)};
        for (const auto& [i, j] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}}) {
          if (i < 0 || j < 0 || i >= width || j >= height || !left[index(i, j)]) continue;
          left[index(i, j)] = false;
          waiting.emplace_back(i, j);
        }
      }
      region.centroid = (1.0 / static_cast<double>(region.pixels)) * region.centroid;
      for (const auto& [y, span] : rows)
        for (const int down : {0, 1})
          for (const int x : {span.first, span.last + 1})
            region.rim.push_back({static_cast<double>(x), static_cast<double>(y + down)});
      regions.push_back(std::move(region));
    }
  return regions;
}

}  // namespace lamina
