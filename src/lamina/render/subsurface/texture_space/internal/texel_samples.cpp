// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/texture_space/internal/texel_samples.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "lamina/base/core/low_discrepancy.h"
#include "lamina/base/core/parallel_chunks.h"

namespace lamina {
namespace {

constexpr std::size_t chunk = 4096;

template <int N>
float brightness(const BandValues<N>& values) {
  float sum = 0.0f;
  for (int b = 0; b < N; ++b) sum += values[b];
  return sum / static_cast<float>(N);
}

/// What is known of the light of a texel, or of a group of them.
struct Spread {
  double squares = 0.0;  ///< of deviations from the mean of a texel
  double light = 0.0;    ///< sum of the texels' means
  int degrees = 0, texels = 0;
};

template <int N>
Spread spread_of(const TexelSamples<N>& of, double sky_share) {
  if (of.count == 0) return {};
  const double count = of.count;
  const double sum = static_cast<double>(brightness(of.irradiance)) +
                     sky_share * static_cast<double>(brightness(of.missed));
  const double squares = static_cast<double>(of.irradiance2) +
                         2.0 * sky_share * static_cast<double>(of.irradiance_missed) +
                         sky_share * sky_share * static_cast<double>(of.missed2);
  return {std::max(squares - sum * sum / count, 0.0), sum / count, of.count - 1, 1};
}

/// Counts that are in proportion to the deviation together with those that there are.
template <int N>
std::vector<int> in_proportion(std::span<const TexelSamples<N>> samples,
                               std::span<const float> deviation, float budget) {
  const auto more = [&](std::size_t i, float factor) {
    constexpr float most = 64.0f;
    if (!samples[i].may_have_more) return 0.0f;
    return std::clamp(factor * deviation[i] - static_cast<float>(samples[i].count), 0.0f, most);
  };
  // One texel of each few tells the sum well enough.
  constexpr std::size_t stride = 7;
  double wanted = 0.0;
  for (std::size_t i = 0; i < samples.size(); i += stride)
    if (samples[i].may_have_more) wanted += static_cast<double>(budget);
  float low = 0.0f, high = 1e6f;
  for (int turn = 0; turn < 40 && !(low > 0.0f && high < 1.01f * low); ++turn) {
    const float middle = low > 0.0f ? std::sqrt(low * high) : 0.5f * high;
    double total = 0.0;
    for (std::size_t i = 0; i < samples.size(); i += stride)
      total += static_cast<double>(more(i, middle));
    (total < wanted ? low : high) = middle;
  }
  std::vector<int> result(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    result[i] = static_cast<int>(
        more(i, low) + detail::unit_fraction(detail::hash_bits(static_cast<std::uint32_t>(i))));
  return result;
}

/// The group of each texel: its ancestor some levels up.
std::vector<std::uint32_t> groups_of(const CellGraph& graph) {
  constexpr std::size_t levels_up = 3;
  std::vector<std::uint32_t> group(graph.levels.front().area.size());
  for (std::uint32_t i = 0; i < group.size(); ++i) {
    group[i] = i;
    for (std::size_t level = 0; level < std::min(levels_up, graph.levels.size() - 1); ++level)
      group[i] = graph.levels[level].parent[group[i]];
  }
  return group;
}

}  // namespace

template <int N>
void TexelSamples<N>::add(const EnteringLight<N>& light) {
  irradiance += light.irradiance;
  missed += light.missed;
  open += light.open;
  seen += light.seen;
  const float f = brightness(light.irradiance), m = brightness(light.missed);
  irradiance2 += f * f;
  irradiance_missed += f * m;
  missed2 += m * m;
  ++count;
}

template <int N>
std::vector<float> sky_shares(const CellLevel& cells, std::span<const TexelSamples<N>> samples) {
  std::vector<float> shares(samples.size());
  parallel_chunks(samples.size(), chunk, [&](std::size_t i) {
    float open = 0.0f, seen = 0.0f;
    for (std::uint32_t k = cells.first[i]; k < cells.first[i + 1]; ++k) {
      const TexelSamples<N>& beside = samples[cells.neighbors[k].cell];
      open += beside.open;
      seen += beside.seen;
    }
    if (open > 0.0f) shares[i] = seen / open;
  });
  return shares;
}

template <int N>
std::vector<int> more_samples(const CellGraph& graph, std::span<const TexelSamples<N>> samples,
                              std::span<const float> shares, float budget) {
  const std::vector<std::uint32_t> group_of = groups_of(graph);
  std::vector<Spread> groups(group_of.empty() ? 0 : *std::ranges::max_element(group_of) + 1);
  Spread all;
  const auto spread = [&](std::size_t i) {
    return spread_of(samples[i], static_cast<double>(shares[i]));
  };
  const auto add = [](Spread& to, const Spread& more, int sign) {
    to.squares += sign * more.squares;
    to.light += sign * more.light;
    to.degrees += sign * more.degrees;
    to.texels += sign * more.texels;
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    add(groups[group_of[i]], spread(i), 1);
    add(all, spread(i), 1);
  }
  // In the dark errors count by a little of the light of all.
  const double dark = 0.05 * all.light / std::max(all.texels, 1);
  std::vector<float> deviation(samples.size());
  parallel_chunks(samples.size(), chunk, [&](std::size_t i) {
    if (!samples[i].may_have_more) return;
    Spread others = groups[group_of[i]];
    add(others, spread(i), -1);
    if (others.degrees <= 0) return;
    const double light = std::max(others.light / others.texels, 0.0) + dark;
    if (light > 0.0)
      deviation[i] =
          static_cast<float>(std::sqrt(std::max(others.squares, 0.0) / others.degrees) / light);
  });
  return in_proportion<N>(samples, deviation, budget);
}

template <int N>
void spread_rare_light(const CellGraph& graph, std::span<const TexelSamples<N>> samples,
                       std::span<const float> shares, std::span<BandValues<N>> light) {
  constexpr double most_variance = 25.0;  // over that of the texels around
  constexpr float least_brighter = 1.1f;
  const CellLevel& cells = graph.levels.front();
  const std::vector<std::uint32_t> group_of = groups_of(graph);
  struct Group {
    double variance = 0.0;  ///< sum of those of means
    int texels = 0;
    float area = 0.0f;
    BandValues<N> rare;
  };
  std::vector<Group> groups(group_of.empty() ? 0 : *std::ranges::max_element(group_of) + 1);
  std::vector<double> variance(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].count < 2) continue;
    const Spread spread = spread_of(samples[i], static_cast<double>(shares[i]));
    variance[i] = spread.squares / spread.degrees / samples[i].count;
    Group& group = groups[group_of[i]];
    group.variance += variance[i];
    group.area += cells.area[i];
    ++group.texels;
  }
  std::vector<BandValues<N>> found(light.begin(), light.end());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Group& group = groups[group_of[i]];
    if (samples[i].count < 2 || group.texels < 2 || cells.first[i] == cells.first[i + 1]) continue;
    const double of_others = (group.variance - variance[i]) / (group.texels - 1);
    if (!(variance[i] > most_variance * of_others)) continue;
    BandValues<N> around;
    for (std::uint32_t k = cells.first[i]; k < cells.first[i + 1]; ++k)
      around += found[cells.neighbors[k].cell];
    around *= 1.0f / static_cast<float>(cells.first[i + 1] - cells.first[i]);
    if (!(brightness(found[i]) > least_brighter * brightness(around))) continue;
    light[i] = around;
    group.rare += cells.area[i] * (found[i] - around);
  }
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (const Group& group = groups[group_of[i]]; samples[i].count >= 2 && group.area > 0.0f)
      light[i] += (1.0f / group.area) * group.rare;
}

#define LAMINA_INSTANTIATE(N)                                                                 \
  template struct TexelSamples<N>;                                                            \
  template std::vector<float> sky_shares(const CellLevel&, std::span<const TexelSamples<N>>); \
  template std::vector<int> more_samples(const CellGraph&, std::span<const TexelSamples<N>>,  \
                                         std::span<const float>, float);                      \
  template void spread_rare_light(const CellGraph&, std::span<const TexelSamples<N>>,         \
                                  std::span<const float>, std::span<BandValues<N>>)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
