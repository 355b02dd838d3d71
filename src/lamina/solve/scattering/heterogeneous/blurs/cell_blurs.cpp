// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/blurs/cell_blurs.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "lamina/solve/scattering/heterogeneous/blurs/for_cells.h"

namespace lamina {
namespace {

using detail::for_cells;

/// Steps in time, each a variance in typical areas of the level. A step of variance t weakens a
/// wave by 1 - t (1 - cos k); their product falls about as a Gaussian does, with fewer steps than
/// equal ones would take.
struct Steps {
  std::array<float, 4> variance{};
  int count = 0;
};
constexpr std::array<Steps, 5> finest = {{{{0.25f}, 1},
                                          {{0.25f}, 1},
                                          {{0.5f}, 1},
                                          {{0.35f, 0.65f}, 2},
                                          {{0.35f, 0.45f, 0.55f, 0.65f}, 4}}};
constexpr std::array<Steps, 2> coarser = {{{{0.25f, 0.44f}, 2}, {{0.35f, 0.45f, 0.55f, 0.65f}, 4}}};
/// After light of a coarse level has been handed to its children, all alike.
constexpr Steps smoothing = {{0.25f, 0.5f}, 2};

template <int N>
BandValues<N> stepped(const CellLevel& level, const CellField<N>& from, float variance,
                      std::size_t i) {
  BandValues<N> around;
  for (std::uint32_t k = level.first[i]; k < level.first[i + 1]; ++k)
    around += level.neighbors[k].rate * from[level.neighbors[k].cell];
  return (1.0f - variance * level.rate[i]) * from[i] + variance * around;
}

/// Blurs a field; `use(i, value)` sees each result.
template <int N, class Use>
CellField<N> blurred(const CellLevel& level, CellField<N> field, const Steps& steps,
                     const Use& use) {
  CellField<N> next(field.size());
  for (int s = 0; s < steps.count; ++s) {
    const float variance = steps.variance[static_cast<std::size_t>(s)];
    const bool is_last = s + 1 == steps.count;
    for_cells(field.size(), [&](std::size_t i) {
      next[i] = stepped(level, field, variance, i);
      if (is_last) use(i, next[i]);
    });
    std::swap(field, next);
  }
  return field;
}

template <int N>
CellField<N> blurred(const CellLevel& level, CellField<N> field, const Steps& steps) {
  return blurred(level, std::move(field), steps, [](std::size_t, const BandValues<N>&) {});
}

template <int N>
CellField<N> coarsened(const CellLevel& level, const CellField<N>& field) {
  CellField<N> result(level.first_child.size() - 1);
  for_cells(result.size(), [&](std::size_t p) {
    BandValues<N> sum;
    float area = 0.0f;
    for (std::uint32_t k = level.first_child[p]; k < level.first_child[p + 1]; ++k) {
      const std::uint32_t child = level.children[k];
      sum += level.area[child] * field[child];
      area += level.area[child];
    }
    result[p] = (1.0f / area) * sum;
  });
  return result;
}

template <int N>
CellField<N> handed_down(const CellLevel& level, const CellField<N>& coarse) {
  CellField<N> result(level.parent.size());
  for_cells(result.size(), [&](std::size_t i) { result[i] = coarse[level.parent[i]]; });
  return result;
}

/// The weight of one scale of an operator at a cell.
template <int N>
BandValues<N> weight_at(const CellOperator<N>& op, std::size_t scales, std::size_t scale,
                        const CellBasis<N>& basis, std::size_t cell) {
  return basis_sum(basis, cell, op.terms,
                   [&](std::size_t p) { return op.weights[p * scales + scale]; });
}

/// What one power's weights make of the scales of the coarse levels, on level 1.
template <int N>
CellField<N> sum_of_scales(const CellGraph& graph,
                           const std::vector<std::array<CellField<N>, 2>>& scales,
                           const BandValues<N>* weights) {
  CellField<N> sum;
  for (std::size_t level = scales.size(); level-- > 0;) {
    const auto& [first, second] = scales[level];
    const BandValues<N> a = weights[2 * level], b = weights[2 * level + 1];
    const auto own = [&](std::size_t i) { return a * first[i] + b * second[i]; };
    if (sum.empty()) {
      sum.resize(first.size());
      for_cells(sum.size(), [&](std::size_t i) { sum[i] = own(i); });
    } else {
      sum = blurred(graph.levels[level + 1], handed_down(graph.levels[level + 1], sum), smoothing);
      for_cells(sum.size(), [&](std::size_t i) { sum[i] += own(i); });
    }
  }
  return sum;
}

/// Transfer of each scale at a spatial frequency [1/typical cell], what folds back left out.
std::vector<double> scale_transfers(std::size_t levels, double k) {
  const auto transfer = [](const Steps& steps, double at) {
    double product = 1.0;
    for (int s = 0; s < steps.count; ++s)
      product *= 1.0 - static_cast<double>(steps.variance[static_cast<std::size_t>(s)]) *
                           (1.0 - std::cos(at));
    return product;
  };
  std::vector<double> transfers = {1.0};
  double down = 1.0, up = 1.0;
  for (const Steps& steps : finest) transfers.push_back(down *= transfer(steps, k));
  for (std::size_t level = 1; level < levels; ++level) {
    const double finer = k * std::ldexp(1.0, static_cast<int>(level) - 1), at = 2.0 * finer;
    const double mean = at < 2.0 * std::numbers::pi ? std::cos(0.5 * finer) : 0.0;
    down *= mean;
    up *= mean * transfer(smoothing, finer);
    for (const Steps& steps : coarser) {
      down *= transfer(steps, at);
      transfers.push_back(at < std::numbers::pi ? down * up : 0.0);
    }
  }
  return transfers;
}

}  // namespace

std::size_t scale_count(const CellGraph& graph) {
  return 1 + finest.size() + coarser.size() * (graph.levels.size() - 1);
}

std::vector<double> cell_scales_of_gaussians(const CellGraph& graph,
                                             std::span<const double> variances) {
  const CellLevel& fine = graph.levels.front();
  std::vector<double> in_cells;
  for (const double v : variances) in_cells.push_back(v / static_cast<double>(fine.typical_area));
  const double widest = std::ldexp(1.0, static_cast<int>(graph.levels.size()) + 2);
  return detail::fit_scales(in_cells, 1.0 / (16.0 * widest), scale_count(graph),
                            [&](double k) { return scale_transfers(graph.levels.size(), k); });
}

template <int N>
std::vector<CellField<N>> apply_cell_operators(const CellGraph& graph, const CellField<N>& input,
                                               const CellBasis<N>& basis,
                                               std::span<const CellOperator<N>* const> operators) {
  const CellLevel& fine = graph.levels.front();
  assert(input.size() == fine.area.size());
  const std::size_t scales = scale_count(graph);
  std::vector<CellField<N>> results(operators.size(), CellField<N>(input.size()));
  const auto add = [&](std::size_t scale, std::size_t i, const BandValues<N>& value) {
    for (std::size_t o = 0; o < operators.size(); ++o)
      results[o][i] += value * weight_at(*operators[o], scales, scale, basis, i);
  };
  for_cells(input.size(), [&](std::size_t i) { add(0, i, input[i]); });
  CellField<N> last = input;
  for (std::size_t r = 0; r < finest.size(); ++r) {
    last = blurred(fine, std::move(last), finest[r],
                   [&](std::size_t i, const BandValues<N>& value) { add(r + 1, i, value); });
  }
  if (graph.levels.size() == 1) return results;

  std::vector<std::array<CellField<N>, 2>> coarse;
  for (std::size_t l = 1; l < graph.levels.size(); ++l) {
    CellField<N> first = blurred(graph.levels[l], coarsened(graph.levels[l - 1], last), coarser[0]);
    last = blurred(graph.levels[l], first, coarser[1]);
    coarse.push_back({std::move(first), last});
  }
  for (std::size_t o = 0; o < operators.size(); ++o) {
    CellField<N> sum;
    for (std::size_t p = operators[o]->terms; p-- > 0;) {
      const CellField<N> of_power =
          sum_of_scales(graph, coarse, &operators[o]->weights[p * scales + 1 + finest.size()]);
      CellField<N> up = blurred(fine, handed_down(fine, of_power), smoothing);
      if (!basis.modes.empty())
        for_cells(up.size(), [&](std::size_t i) { results[o][i] += basis.modes[p][i] * up[i]; });
      else if (sum.empty())
        sum = std::move(up);
      else
        for_cells(sum.size(),
                  [&](std::size_t i) { sum[i] = sum[i] * basis.coordinate[i] + up[i]; });
    }
    for_cells(sum.size(), [&](std::size_t i) { results[o][i] += sum[i]; });
  }
  return results;
}

template <int N>
CellField<N> mean_on_level(const CellGraph& graph, CellField<N> field, std::size_t level,
                           std::size_t coarser) {
  for (; level < coarser; ++level) field = coarsened(graph.levels[level], field);
  return field;
}

template <int N>
CellField<N> smooth_on_finest(const CellGraph& graph, CellField<N> field, std::size_t level) {
  while (level-- > 0)
    field = blurred(graph.levels[level], handed_down(graph.levels[level], field), coarser[1]);
  return field;
}

#define LAMINA_INSTANTIATE(N)                                                                    \
  template std::vector<CellField<N>> apply_cell_operators<N>(                                    \
      const CellGraph&, const CellField<N>&, const CellBasis<N>&,                                \
      std::span<const CellOperator<N>* const>);                                                  \
  template CellField<N> mean_on_level(const CellGraph&, CellField<N>, std::size_t, std::size_t); \
  template CellField<N> smooth_on_finest(const CellGraph&, CellField<N>, std::size_t)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
