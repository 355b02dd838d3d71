// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/objective/map_smoothness.h"

namespace lamina::detail {
namespace {

double weighted_squares(const GridSize& size, const DerivativeWeight& derivative,
                        const std::vector<float>& map) {
  const std::vector<float> squares = squared_slopes(size, map);
  double sum = 0.0;
  for (std::size_t t = 0; t < squares.size(); ++t)
    sum += derivative.at(t) * static_cast<double>(squares[t]);
  return sum;
}

/// Adds what the differences of a map flow, each times its weight.
void add_flow(const GridSize& size, const DerivativeWeight& derivative,
              const std::vector<float>& map, std::vector<float>& sum) {
  for_neighbors(size.width, size.height, [&](std::size_t a, std::size_t b) {
    const float flow = static_cast<float>(derivative.at(a)) * (map[a] - map[b]);
    sum[a] += flow;
    sum[b] -= flow;
  });
}

}  // namespace

std::vector<float> curvature(const GridSize& size, const std::vector<float>& map) {
  std::vector<float> result(map.size(), 0.0f);
  add_flow(size, {.weight = 1.0, .share = {}}, map, result);
  return result;
}

std::vector<float> squared_slopes(const GridSize& size, const std::vector<float>& map) {
  std::vector<float> squares(map.size(), 0.0f);
  for_neighbors(size.width, size.height, [&](std::size_t a, std::size_t b) {
    squares[a] += (map[a] - map[b]) * (map[a] - map[b]);
  });
  return squares;
}

double roughness(const GridSize& size, const MapSmoothness& smoothness,
                 const std::vector<float>& map) {
  const double first = weighted_squares(size, smoothness.first, map);
  if (smoothness.third.weight == 0.0) return first;
  return first + weighted_squares(size, smoothness.third, curvature(size, map));
}

void add_roughness_matrix(const GridSize& size, const MapSmoothness& smoothness,
                          const std::vector<float>& map, std::vector<float>& sum) {
  add_flow(size, smoothness.first, map, sum);
  if (smoothness.third.weight == 0.0) return;
  std::vector<float> flow(map.size(), 0.0f);
  add_flow(size, smoothness.third, curvature(size, map), flow);
  const std::vector<float> third = curvature(size, flow);
  for (std::size_t t = 0; t < sum.size(); ++t) sum[t] += third[t];
}

}  // namespace lamina::detail
