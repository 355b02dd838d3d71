// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/errors/smoothness_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>

#include "lamina/base/core/parallel.h"

namespace lamina::detail {
namespace {

/// Means over about 4 x 4 texels.
std::vector<float> mean_around(const GridSize& size, const std::vector<float>& map) {
  const GridSize half = size.half();
  return on_fine(size, on_fine(half, on_half(half, on_half(size, map))));
}

void find_edges_of(const GridSize& size, const std::vector<float>& squares,
                   DerivativeWeight& derivative) {
  constexpr double freedom = 2.0;  // of Student's t
  constexpr double terms = 2.0;    // differences that belong to a texel
  constexpr int most_rounds = 10;
  constexpr double least_square = 1e-12;
  const std::vector<float> around = mean_around(size, squares);
  derivative.share.assign(squares.size(), 1.0f);
  for (int round = 0; round < most_rounds; ++round) {
    double sum = 0.0;
    for (std::size_t t = 0; t < squares.size(); ++t)
      sum += static_cast<double>(derivative.share[t] * squares[t]);
    const double mean = sum / static_cast<double>(squares.size()) + least_square;
    for (std::size_t t = 0; t < squares.size(); ++t)
      derivative.share[t] = static_cast<float>(
          (freedom + terms) / (freedom + terms * static_cast<double>(around[t]) / mean));
  }
}

/// The mean of the weight over all texels.
double mean_weight(const DerivativeWeight& derivative) {
  if (derivative.share.empty()) return derivative.weight;
  const double sum = std::accumulate(derivative.share.begin(), derivative.share.end(), 0.0);
  return derivative.weight * sum / static_cast<double>(derivative.share.size());
}

/// How many texels the images tell of a number, as waves of octaves, from the finest on.
std::vector<double> told_by_octave(GridSize size, std::vector<float> pushed,
                                   std::vector<float> moved) {
  constexpr int least_side = 8;
  std::vector<double> parts;
  double texels = 1.0;  // of the finest grid, each
  while (true) {
    const bool is_last = std::min(size.width, size.height) < least_side;
    const double product =
        is_last ? dot({pushed}, {moved}) : dot({details(size, pushed)}, {details(size, moved)});
    parts.push_back(std::max(0.0, texels * product));
    if (is_last) return parts;
    pushed = on_half(size, pushed);
    moved = on_half(size, moved);
    size = size.half();
    texels *= 4.0;
  }
}

/// How many texels each weight stands against: of waves the part that it has of their precision.
struct Told {
  double all = 0.0, first = 0.0, third = 0.0;
};
Told told_of(const GridSize& size, const MapSmoothness& smoothness,
             const std::vector<float>& pushed, const std::vector<float>& moved) {
  const double texels = static_cast<double>(size.texels());
  const double all = std::clamp(dot({pushed}, {moved}), 1.0, texels);
  const std::vector<double> octaves = told_by_octave(size, pushed, moved);
  const double sum = std::accumulate(octaves.begin(), octaves.end(), 1e-30);
  Told told{.all = all};
  double wave_square = 4.0;
  for (const double octave : octaves) {
    const double first = mean_weight(smoothness.first);
    const double third = mean_weight(smoothness.third) * wave_square * wave_square;
    const double part = all * octave / sum;
    told.first += part * first / (first + third + 1e-30);
    told.third += part * third / (first + third + 1e-30);
    wave_square *= 0.25;
  }
  return told;
}

}  // namespace

std::vector<MapSmoothness> usual_smoothness(const InversionTables& tables, double mm_per_texel) {
  static constexpr std::array<std::pair<std::string_view, double>, 7> usual = {
      {{"melanin", 10.0},
       {"melanin_blend", 100.0},
       {"hemoglobin_epidermis", 30.0},
       {"hemoglobin_dermis", 100.0},
       {"carotene", 300.0},
       {"saturation", 300.0},
       {"baseline_scale", 300.0}}};
  constexpr double reach = 0.2;  // [mm], of waves of which both count alike, over 2 pi
  std::vector<MapSmoothness> result;
  for (const SkinFitNumber& number : tables.numbers)
    for (const auto& [name, weight] : usual)
      if (number.parameter.name == name)
        result.push_back(
            {.first = {.weight = weight, .share = {}},
             .third = {.weight = weight * std::pow(reach / mm_per_texel, 4), .share = {}}});
  return result;
}

void find_edges(const GridSize& size, const std::vector<float>& map, MapSmoothness& smoothness) {
  find_edges_of(size, squared_slopes(size, map), smoothness.first);
  find_edges_of(size, squared_slopes(size, curvature(size, map)), smoothness.third);
}

std::vector<MapSmoothness> likely_smoothness(const PatchObjective& objective,
                                             const TexelMaps& coordinates,
                                             const PosteriorSample& draw) {
  constexpr double hardly_told = 20.0;           // texels
  constexpr double least = 0.01, most = 1000.0;  // of what is usual
  constexpr int rounds = 10;
  const GridSize size = objective.size();
  const std::vector<MapSmoothness> usual =
      usual_smoothness(objective.tables(), objective.capture().mm_per_texel);
  std::vector<MapSmoothness> result = objective.smoothness();
  parallel_for(result.size(), [&](std::size_t n) {
    MapSmoothness& each = result[n];
    MapSmoothness by_weight{.first = {.weight = 1.0, .share = {}},
                            .third = {.weight = 1.0, .share = {}}};
    find_edges(size, coordinates[n], by_weight);
    const double first_squares =
        roughness(size, {.first = by_weight.first, .third = {}}, coordinates[n]);
    const double third_squares =
        roughness(size, {.first = {}, .third = by_weight.third}, coordinates[n]);
    each.first.share = std::move(by_weight.first.share);
    each.third.share = std::move(by_weight.third.share);
    const auto toward = [&](double told, double wanted, double usual_weight) {
      const double share = told / (told + hardly_told);
      return usual_weight * std::pow(std::clamp(wanted / usual_weight, least, most), share);
    };
    for (int round = 0; round < rounds; ++round) {
      const Told told = told_of(size, each, draw.pushed[n], draw.off[n]);
      each.first.weight =
          toward(told.all, told.first / std::max(first_squares, 1e-12), usual[n].first.weight);
      each.third.weight =
          toward(told.all, told.third / std::max(third_squares, 1e-12), usual[n].third.weight);
    }
  });
  return result;
}

}  // namespace lamina::detail
