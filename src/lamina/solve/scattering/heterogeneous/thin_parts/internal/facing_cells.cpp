// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/thin_parts/internal/facing_cells.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "lamina/base/core/parallel_chunks.h"
#include "lamina/solve/scattering/heterogeneous/blurs/cell_blurs.h"

namespace lamina::detail {
namespace {

/// A shell lets more through than the slab on which two of its places lie, on either way: 1 + .42
/// d² / (R r), whose radii are in the bends.
constexpr float shell_gain = static_cast<float>(0.42 / (bend_width * bend_width));

/// A cell is taken as a whole from so many of its radii on.
constexpr float radii_away = 4.0f;
/// Normals within a cell that is taken as a whole differ by less than this length of their mean.
constexpr float least_normal = 0.9f;

std::vector<FacingCell> coarser_cells(const CellLevel& level, std::span<const FacingCell> fine) {
  std::vector<FacingCell> coarse(level.first_child.size() - 1);
  for (std::size_t p = 0; p < coarse.size(); ++p) {
    FacingCell& cell = coarse[p];
    const auto children =
        std::span(level.children)
            .subspan(level.first_child[p], level.first_child[p + 1] - level.first_child[p]);
    for (const std::uint32_t child : children) {
      cell.area += fine[child].area;
      cell.position += fine[child].area * fine[child].position;
      cell.normal += fine[child].area * fine[child].normal;
      for (std::size_t w = 0; w < cell.bend.size(); ++w)
        cell.bend[w] += fine[child].area * fine[child].bend[w];
    }
    cell.position = cell.position / cell.area;
    cell.normal = cell.normal / cell.area;
    for (float& bend : cell.bend) bend /= cell.area;
    for (const std::uint32_t child : children)
      cell.radius =
          std::max(cell.radius, length(fine[child].position - cell.position) + fine[child].radius);
  }
  return coarse;
}

/// The surface from a level on.
CellGraph from_level(const CellGraph& graph, std::size_t level) {
  return {{graph.levels.begin() + static_cast<std::ptrdiff_t>(level), graph.levels.end()}};
}

void find_bends(const CellGraph& graph, std::vector<FacingCell>& cells) {
  constexpr std::size_t widths = std::tuple_size_v<decltype(FacingCell::bend)>;
  std::array<double, widths> variances{};
  for (std::size_t w = 0; w < widths; ++w) {
    const double width = bend_width * std::exp2(w);
    variances[w] = width * width;
  }
  const std::size_t scales = scale_count(graph);
  const std::vector<double> weights = cell_scales_of_gaussians(graph, variances);
  std::array<CellOperator<8>, widths> blurs;
  std::array<const CellOperator<8>*, widths> operators{};
  for (std::size_t w = 0; w < widths; ++w) {
    blurs[w] = {.terms = 1, .weights = {}, .totals = {BandValues<8>::filled(1.0f)}};
    for (std::size_t k = 0; k < scales; ++k)
      blurs[w].weights.push_back(
          BandValues<8>::filled(static_cast<float>(weights[w * scales + k])));
    operators[w] = &blurs[w];
  }
  CellField<8> field(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      field[i][axis] = cells[i].normal[axis];
      field[i][4 + axis] = cells[i].position[axis];
    }
  const auto blurred =
      apply_cell_operators<8>(graph, field, {CellField<8>(cells.size())}, operators);
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t w = 0; w < widths; ++w) {
      const BandValues<8>& mean = blurred[w][i];
      const Vec3f normal{mean[0], mean[1], mean[2]}, around{mean[4], mean[5], mean[6]};
      const float bend = -std::log(std::clamp(length(normal), 0.01f, 1.0f));
      cells[i].bend[w] = dot(cells[i].position - around, cells[i].normal) < 0.0f ? -bend : bend;
    }
}

/// All cells that a cell takes light from, coarse ones where they are far.
class Finder {
 public:
  Finder(const CellGraph& graph, const FacingCells& found) : graph_(graph), found_(found) {}

  void find(const FacingCell& to, std::size_t level, std::uint32_t index,
            std::vector<std::uint32_t>& from) const {
    const FacingCell& cell = found_.cells[found_.begin[level - found_.level] + index];
    const Vec3f offset = cell.position - to.position;
    const float distance2 = dot(offset, offset);
    const float most = thin_reach + cell.radius;
    if (distance2 > most * most) return;
    const bool is_whole =
        level == found_.level || (distance2 > radii_away * radii_away * cell.radius * cell.radius &&
                                  dot(cell.normal, cell.normal) > least_normal * least_normal);
    if (is_whole) {
      constexpr float least = 1e-3f;
      const FacingPair pair = facing_pair(to, cell);
      if (pair.of_slab > least || pair.of_distance > least)
        from.push_back(static_cast<std::uint32_t>(found_.begin[level - found_.level] + index));
      return;
    }
    const CellLevel& finer = graph_.levels[level - 1];
    for (std::uint32_t k = finer.first_child[index]; k < finer.first_child[index + 1]; ++k)
      find(to, level - 1, finer.children[k], from);
  }

 private:
  const CellGraph& graph_;
  const FacingCells& found_;
};

}  // namespace

FacingPair facing_pair(const FacingCell& to, const FacingCell& from) {
  const Vec3f offset = to.position - from.position;
  const float distance2 = dot(offset, offset);
  const float up = dot(offset, to.normal), down = -dot(offset, from.normal);
  if (distance2 >= thin_reach * thin_reach || !(up + down > 0.0f)) return {};
  const float distance = std::sqrt(distance2);
  constexpr float fades = 0.75f;
  const float left = std::clamp((1.0f - distance / thin_reach) / (1.0f - fades), 0.0f, 1.0f);
  const float near = left * left * (3.0f - 2.0f * left);

  FacingPair pair{.distance2 = distance2};
  const Vec3f across = to.normal - from.normal;
  const float length2 = dot(across, across);
  float flatness = 0.0f;
  // Of a wedge the two faces exchange sin(x) of the T of that slab, with 2 x between their normals,
  // of which R over the edge has a part, cos(x)^3 times its R at the distance through the body.
  const float sine_of_wedge = std::min(0.5f * std::sqrt(length2), 1.0f);
  const float cosine2 = 1.0f - sine_of_wedge * sine_of_wedge;
  constexpr float slab_over_half_space = 4.2f;  // T over R at the same distance, right across
  const float of_wedge = sine_of_wedge - cosine2 * std::sqrt(cosine2) / slab_over_half_space;
  const float lengths = std::sqrt(dot(to.normal, to.normal) * dot(from.normal, from.normal));
  pair.opening = 0.5f * (1.0f + dot(to.normal, from.normal) / std::max(lengths, 1e-6f));
  if (of_wedge > 0.0f) {
    pair.thickness = dot(offset, across) / std::sqrt(length2);
    pair.lateral2 = std::max(distance2 - pair.thickness * pair.thickness, 0.0f);
    const float width = std::clamp(std::log2(std::max(pair.thickness, 1.0f)), 0.0f, 3.999f);
    const auto w = static_cast<std::size_t>(width);
    const auto bend = [&](const FacingCell& cell) {
      return std::lerp(cell.bend[w], cell.bend[w + 1], width - static_cast<float>(w));
    };
    const float a = bend(to), b = bend(from);
    flatness = std::exp(-std::max(a + b, 0.0f));
    const float of_shell =
        a * b < 0.0f ? std::min(1.0f + shell_gain * std::sqrt(-a * b), 2.0f) : 1.0f;
    pair.of_slab = near * flatness * of_shell * of_wedge;
  }
  // On a ball light goes 2 R sin(x) through it or 2 R x over it, with x the angle of both normals
  // to the plane across the way; R falls as the third power of distance.
  if (up > 0.0f && down > 0.0f) {
    const float sine = std::min(std::sqrt(up * down) / distance, 1.0f);
    const float over = sine / std::max(std::asin(sine), 1e-3f);
    pair.of_distance = near * (1.0f - flatness) * (1.0f - over * over * over);
  }
  return pair;
}

FacingCells find_facing_cells(const CellGraph& graph, std::span<const Vec3f> positions,
                              std::span<const Vec3f> normals, float spacing) {
  assert(positions.size() == graph.levels.front().area.size());
  FacingCells found;
  std::vector<FacingCell> cells(positions.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const float area = graph.levels.front().area[i];
    cells[i] = {.position = positions[i],
                .normal = normals[i],
                .area = area,
                .radius = std::sqrt(0.5f * area)};
  }
  while (found.level + 1 < graph.levels.size() &&
         graph.levels[found.level + 1].typical_area < spacing * spacing)
    cells = coarser_cells(graph.levels[found.level++], cells);
  find_bends(from_level(graph, found.level), cells);
  const std::size_t takers = cells.size();
  found.begin = {0};
  for (std::size_t level = found.level;; ++level) {
    found.cells.insert(found.cells.end(), cells.begin(), cells.end());
    found.begin.push_back(found.cells.size());
    if (level + 1 == graph.levels.size()) break;
    cells = coarser_cells(graph.levels[level], cells);
  }

  // The coarsest cells near each of the coarsest, then what is near each cell below it.
  const std::size_t last = graph.levels.size() - 1;
  const std::vector<FacingCell>& coarsest = cells;
  std::vector<std::uint32_t> top(takers);
  for (std::uint32_t i = 0; i < takers; ++i) {
    top[i] = i;
    for (std::size_t level = found.level; level < last; ++level)
      top[i] = graph.levels[level].parent[top[i]];
  }
  std::vector<std::vector<std::uint32_t>> near(coarsest.size());
  parallel_chunks(coarsest.size(), 16, [&](std::size_t i) {
    for (std::uint32_t j = 0; j < coarsest.size(); ++j) {
      const float most = thin_reach + coarsest[i].radius + coarsest[j].radius;
      const Vec3f offset = coarsest[i].position - coarsest[j].position;
      if (dot(offset, offset) < most * most) near[i].push_back(j);
    }
  });
  const Finder finder(graph, found);
  std::vector<std::vector<std::uint32_t>> from(takers);
  parallel_chunks(takers, 64, [&](std::size_t i) {
    const FacingCell& to = found.cells[i];
    if (!(dot(to.normal, to.normal) > 0.01f)) return;
    for (const std::uint32_t j : near[top[i]]) finder.find(to, last, j, from[i]);
    from[i].shrink_to_fit();
  });
  found.first = {0};
  for (std::uint32_t i = 0; i < takers; ++i) {
    if (from[i].empty()) continue;
    found.taking.push_back(i);
    found.from.insert(found.from.end(), from[i].begin(), from[i].end());
    found.first.push_back(found.from.size());
    from[i] = {};
  }
  return found;
}

}  // namespace lamina::detail
