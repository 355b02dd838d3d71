// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/spatial_frequency/internal/layer_at_frequency.h"

#include <algorithm>
#include <cmath>

namespace lamina::detail {
namespace {

/// Of a layer without bottom; what its reflection lacks is the square of that.
constexpr double opaque_transmission = 1e-7;
constexpr int most_doublings = 60;

/// Light in a clear layer from or to directions that never get there would stay for ever.
void keep_out_of_reach(const GridLayer& layer, const FrequencyStates& states,
                       Matrix& transmission) {
  if (layer.sigma_s > 0.0 || layer.backward > 0.0) return;
  for (std::size_t b = 0; b < states.size(); ++b)
    for (std::size_t a = 0; a < states.size(); ++a)
      if (std::max(states.node[a], states.node[b]) >= layer.reach) transmission(a, b) = 0.0;
}

}  // namespace

LayerEquation layer_equation(const FrequencySolver& solver, std::size_t index,
                             const FrequencyStates& states, double k) {
  const GridLayer& layer = solver.stack.layers[index];
  const std::size_t n = states.size();
  LayerEquation equation{Matrix(n, n), Matrix(n, n)};
  auto& [A, B, fastest] = equation;
  for (int m = 0; m <= solver.modes; ++m) {
    const PhaseMode& phase = solver.phase[index][static_cast<std::size_t>(m)];
    const std::size_t first = states.offset[static_cast<std::size_t>(m)];
    std::size_t last = first;
    while (last < n && states.mode[last] == m) ++last;
    for (std::size_t b = first; b < last; ++b) {
      const std::size_t j = states.node[b];
      for (std::size_t a = first; a < last && layer.sigma_s > 0.0; ++a) {
        const std::size_t i = states.node[a];
        const double scattering = 0.25 * layer.sigma_s * layer.weight[i] * layer.weight[j];
        A(a, b) = scattering * phase.forward(i, j);
        B(a, b) = scattering * phase.backward(i, j);
      }
      A(b, b) -= node_extinction(layer, j) / layer.cos[j];
      B(b, b) += (m % 2 == 0 ? 1.0 : -1.0) * layer.backward / layer.cos[j];
      const double tangent = solver.stack.grid.p[j] / (layer.ior * layer.cos[j]);
      fastest = std::max(fastest, layer.sigma_t / layer.cos[j] + k * tangent);
      if (tangent == 0.0 || j == solver.stack.grid.extra[0]) continue;
      if (m == solver.modes) {
        A(b, b) -= k * tangent * solver.azimuth.damping;
        continue;
      }
      const double coupling = k * tangent * solver.azimuth.coupling[static_cast<std::size_t>(m)];
      const std::size_t next = place(states, m + 1, j);
      A(b, next) -= coupling;
      A(next, b) += coupling;
    }
  }
  return equation;
}

std::vector<LayerOperators> layer_at_frequencies(const FrequencySolver& solver, std::size_t index,
                                                 std::span<const double> frequencies) {
  const GridLayer& layer = solver.stack.layers[index];
  const FrequencyStates states = make_states(solver, layer.ior);
  const std::size_t n = states.size();
  const bool has_bottom = std::isfinite(layer.thickness);
  std::vector<LayerOperators> operators(frequencies.size(), {Matrix(n, n), Matrix(n, n)});
  std::vector<LayerEquation> equations;
  std::vector<SlabProblem> problems;
  std::vector<double*> reflection, transmission;
  equations.reserve(frequencies.size());
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    const LayerEquation& equation =
        equations.emplace_back(layer_equation(solver, index, states, frequencies[i]));
    const double fastest = equation.fastest;
    if (fastest == 0.0) {  // clear, at k = 0
      for (std::size_t a = 0; a < n; ++a) operators[i].transmission(a, a) = has_bottom ? 1.0 : 0.0;
      continue;
    }
    SlabProblem& problem =
        problems.emplace_back(SlabProblem{.size = static_cast<int>(n),
                                          .even = static_cast<int>(states.even),
                                          .forward = equation.A.values.data(),
                                          .backward = equation.B.values.data(),
                                          .doublings = most_doublings,
                                          .opaque = has_bottom ? 0.0 : opaque_transmission});
    if (has_bottom)
      problem.doublings =
          static_cast<int>(std::ceil(std::max(0.0, std::log2(layer.thickness * fastest))));
    problem.step = has_bottom ? std::ldexp(layer.thickness, -problem.doublings) : 1.0 / fastest;
    reflection.push_back(operators[i].reflection.values.data());
    transmission.push_back(operators[i].transmission.values.data());
  }
  if (problems.size() == 1)
    double_slab(problems[0], reflection[0], transmission[0]);
  else if (!problems.empty())
    double_slabs(problems, reflection.data(), transmission.data());
  for (LayerOperators& of_frequency : operators) {
    if (!has_bottom) std::ranges::fill(of_frequency.transmission.values, 0.0);
    keep_out_of_reach(layer, states, of_frequency.transmission);
  }
  return operators;
}

}  // namespace lamina::detail
