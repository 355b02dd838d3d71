// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/internal/chart_lattice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/image/resample.h"
#include "lamina/skin/acquire/calibration/color_correction.h"
#include "lamina/skin/acquire/calibration/internal/convex_polygon.h"
#include "lamina/skin/acquire/calibration/internal/flat_patches.h"
#include "lamina/skin/acquire/calibration/internal/homography.h"

namespace lamina {
namespace {

using Node = std::array<int, 2>;              ///< place in a lattice
using Lattice = std::map<Node, std::size_t>;  ///< of patches by their number

constexpr std::size_t least_nodes = 12;

double norm(Vec2 a) { return std::hypot(a.x, a.y); }

/// The unused patch nearest to a place, if near enough and alike large.
std::optional<std::size_t> patch_near(const std::vector<FlatPatch>& patches, Vec2 place,
                                      double reach, double side, const std::vector<bool>& is_used) {
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const double away = norm(patches[i].centre - place);
    if (is_used[i] || away > reach || patches[i].side > 1.6 * side || side > 1.6 * patches[i].side)
      continue;
    reach = away;
    nearest = i;
  }
  return nearest;
}

/// From one patch on: where two steps lead, and from there, by the steps as they are there.
Lattice grown_lattice(const std::vector<FlatPatch>& patches, std::size_t seed, Vec2 across,
                      Vec2 down) {
  struct Front {
    Node node;
    std::array<Vec2, 2> steps;
  };
  constexpr int most_steps = chart_columns;
  constexpr double reach = 0.3;  // of a step
  Lattice lattice = {{{0, 0}, seed}};
  std::vector<bool> is_used(patches.size());
  is_used[seed] = true;
  std::vector<Front> front = {{{0, 0}, {across, down}}};
  for (std::size_t next = 0; next < front.size(); ++next) {
    const Front at = front[next];
    const FlatPatch& from = patches[lattice[at.node]];
    for (std::size_t axis = 0; axis < 2; ++axis)
      for (const int sign : {1, -1}) {
        Node node = at.node;
        node[axis] += sign;
        if (std::abs(node[axis]) > most_steps || lattice.contains(node)) continue;
        const Vec2 step = static_cast<double>(sign) * at.steps[axis];
        const auto found =
            patch_near(patches, from.centre + step, reach * norm(step), from.side, is_used);
        if (!found) continue;
        lattice[node] = *found;
        is_used[*found] = true;
        Front reached{node, at.steps};
        reached.steps[axis] = static_cast<double>(sign) * (patches[*found].centre - from.centre);
        front.push_back(reached);
      }
  }
  return lattice;
}

/// The lattice of the most patches.
Lattice best_lattice(const std::vector<FlatPatch>& patches) {
  Lattice best;
  const auto may_be_step = [&](std::size_t from, std::size_t to) {
    const double ratio = patches[to].side / patches[from].side;
    const double distance = norm(patches[to].centre - patches[from].centre) / patches[from].side;
    return ratio > 0.6 && ratio < 1.6 && distance > 0.9 && distance < 2.2;
  };
  for (std::size_t seed = 0; seed < patches.size(); ++seed)
    for (std::size_t i = 0; i < patches.size(); ++i) {
      if (i == seed || !may_be_step(seed, i)) continue;
      for (std::size_t j = 0; j < patches.size(); ++j) {
        if (j == seed || j == i || !may_be_step(seed, j)) continue;
        const Vec2 across = patches[i].centre - patches[seed].centre;
        const Vec2 down = patches[j].centre - patches[seed].centre;
        const double sine = turn({}, across, down) / (norm(across) * norm(down));
        // A mirrored chart goes the other way, and a step with a diagonal is no pair.
        if (sine < 0.8 || norm(across) > 1.7 * norm(down) || norm(down) > 1.7 * norm(across))
          continue;
        Lattice lattice = grown_lattice(patches, seed, across, down);
        if (lattice.size() > best.size()) best = std::move(lattice);
        if (best.size() >= chart_patches) return best;
      }
    }
  return best;
}

/// A lattice turned by quarters: (i, j) -> (-j, i).
Lattice turned(const Lattice& lattice, int quarters) {
  Lattice result;
  for (const auto& [place, patch] : lattice) {
    Node node = place;
    for (int q = 0; q < quarters; ++q) node = {-node[1], node[0]};
    result[node] = patch;
  }
  return result;
}

/// Where the chart is if its first patch is at a node; absent if too few patches are in it.
std::optional<Matrix3> placed_chart(const std::vector<FlatPatch>& patches, const Lattice& lattice,
                                    Node first) {
  std::vector<Vec2> plane, picture;
  for (const auto& [node, patch] : lattice) {
    const int column = node[0] - first[0], row = node[1] - first[1];
    if (column < 0 || row < 0 || column >= chart_columns || row >= chart_rows) continue;
    plane.push_back({static_cast<double>(column), static_cast<double>(row)});
    picture.push_back(patches[patch].centre);
  }
  if (plane.size() < least_nodes) return std::nullopt;
  return fit_homography(plane, picture);
}

/// How far the colors are from the chart's after the best matrix: CIEDE2000, mean. Absent if a
/// patch lies outside of the image.
std::optional<double> color_mismatch(const Image& rgb, const Matrix3& place,
                                     const std::array<LinearSrgb, chart_patches>& colors) {
  std::vector<ColorSample> samples;
  for (std::size_t i = 0; i < chart_patches; ++i) {
    ColorSample sample{{}, colors[i]};
    const auto column = static_cast<double>(i % chart_columns);
    const auto row = static_cast<double>(i / chart_columns);
    for (const double dx : {-0.15, 0.0, 0.15})
      for (const double dy : {-0.15, 0.0, 0.15}) {
        const Vec2 at = seen_at(place, {column + dx, row + dy});
        if (!(at.x >= 0.0 && at.y >= 0.0 && at.x < rgb.width && at.y < rgb.height))
          return std::nullopt;
        const float* pixel = rgb.at(static_cast<int>(at.x), static_cast<int>(at.y));
        for (std::size_t c = 0; c < 3; ++c) sample.camera[c] += static_cast<double>(pixel[c]) / 9.0;
      }
    samples.push_back(sample);
  }
  try {
    return fit_color_correction(samples).mean_error;
  } catch (const InvalidInput&) {  // all alike, or not finite: not the chart's
    return std::nullopt;
  }
}

}  // namespace

std::optional<ChartCorners> find_chart_corners(
    const Image& rgb, const std::array<LinearSrgb, chart_patches>& colors) {
  constexpr double longest_side = 800.0;  // more shows no more of a chart
  const double scale = std::max(1.0, std::max(rgb.width, rgb.height) / longest_side);
  const Image small = scale == 1.0
                          ? rgb
                          : resampled(rgb, std::max(1, static_cast<int>(rgb.width / scale)),
                                      std::max(1, static_cast<int>(rgb.height / scale)));
  std::vector<FlatPatch> patches = find_flat_patches(small);
  constexpr std::size_t most_patches = 200;
  std::ranges::sort(patches, std::ranges::greater{}, &FlatPatch::side);
  if (patches.size() > most_patches) patches.resize(most_patches);
  const Lattice lattice = best_lattice(patches);
  if (lattice.size() < least_nodes) return std::nullopt;

  double best = 1e9, second = 1e9;
  Matrix3 place{};
  for (int quarters = 0; quarters < 4; ++quarters) {
    const Lattice candidate = turned(lattice, quarters);
    for (int column = -2 * chart_columns; column <= 2 * chart_columns; ++column)
      for (int row = -2 * chart_columns; row <= 2 * chart_columns; ++row) {
        const auto placed = placed_chart(patches, candidate, {column, row});
        if (!placed) continue;
        const auto mismatch = color_mismatch(small, *placed, colors);
        if (!mismatch) continue;
        if (*mismatch < best) {
          second = best;
          best = *mismatch;
          place = *placed;
        } else {
          second = std::min(second, *mismatch);
        }
      }
  }
  constexpr double largest_mismatch = 8.0, least_advantage = 1.4;
  if (best > largest_mismatch || second < least_advantage * best) return std::nullopt;
  const Vec2 size{static_cast<double>(rgb.width) / small.width,
                  static_cast<double>(rgb.height) / small.height};
  ChartCorners corners{};
  constexpr std::array<Vec2, 4> on_chart = {Vec2{0, 0}, {5, 0}, {5, 3}, {0, 3}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec2 at = seen_at(place, on_chart[i]);
    corners[i] = {at.x * size.x, at.y * size.y};
  }
  return corners;
}

}  // namespace lamina
