// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/internal/layer_at_frequency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lamina::detail {
namespace {

/// Of a layer without bottom; what its reflection lacks is the square of that.
constexpr double opaque_transmission = 1e-7;
constexpr int most_doublings = 60;
/// Beyond, matrices of several frequencies together are more than caches hold: one by one is
/// faster.
constexpr std::size_t most_states_together = 64;

/// Light in a clear layer from or to directions that never get there would stay for ever.
void keep_out_of_reach(const GridLayer& layer, const FrequencyStates& states, Matrix& passes) {
  if (layer.sigma_s > 0.0 || layer.backward > 0.0) return;
  for (std::size_t b = 0; b < states.size(); ++b)
    for (std::size_t a = 0; a < states.size(); ++a)
      if (std::max(states.node[a], states.node[b]) >= layer.reach) passes(a, b) = 0.0;
}

/// What a layer does to light of the states but for streaming.
struct Scattering {
  const std::vector<PhaseMode>& phase;  ///< [mode]
  double sigma_s = 1.0;                 ///< that multiplies them
  std::vector<double> extinction;       ///< [node]
  double backward = 0.0;                ///< scattering straight back
};

LayerEquation scattering_part(const GridLayer& layer, const FrequencyStates& states,
                              const Scattering& scattering) {
  const std::size_t n = states.size();
  LayerEquation equation{Matrix(n, n), Matrix(n, n)};
  auto& [A, B, fastest] = equation;
  for (std::size_t b = 0, first = 0; b < n; ++b) {
    const int m = states.mode[b];
    if (states.mode[first] != m) first = b;
    const PhaseMode& phase = scattering.phase[static_cast<std::size_t>(m)];
    const std::size_t j = states.node[b];
    for (std::size_t a = first; a < n && states.mode[a] == m && scattering.sigma_s > 0.0; ++a) {
      const std::size_t i = states.node[a];
      const double of_pair = 0.25 * scattering.sigma_s * layer.weight[i] * layer.weight[j];
      A(a, b) = of_pair * phase.forward(i, j);
      B(a, b) = of_pair * phase.backward(i, j);
    }
    A(b, b) -= scattering.extinction[j] / layer.cos[j];
    B(b, b) += (m % 2 == 0 ? 1.0 : -1.0) * scattering.backward / layer.cos[j];
  }
  return equation;
}

/// [node]
std::vector<double> extinctions(const GridLayer& layer) {
  std::vector<double> extinction;
  for (std::size_t i = 0; i < layer.cos.size(); ++i)
    extinction.push_back(node_extinction(layer, i));
  return extinction;
}

/// Points to the equation.
SlabProblem slab_problem(const GridLayer& layer, const FrequencyStates& states,
                         const LayerEquation& equation) {
  const bool has_bottom = std::isfinite(layer.thickness);
  SlabProblem problem{.size = static_cast<int>(states.size()),
                      .even = static_cast<int>(states.even),
                      .forward = equation.A.values.data(),
                      .backward = equation.B.values.data(),
                      .doublings = most_doublings,
                      .opaque = has_bottom ? 0.0 : opaque_transmission};
  if (has_bottom)
    problem.doublings =
        static_cast<int>(std::ceil(std::max(0.0, std::log2(layer.thickness * equation.fastest))));
  problem.step =
      has_bottom ? std::ldexp(layer.thickness, -problem.doublings) : 1.0 / equation.fastest;
  return problem;
}

}  // namespace

LayerEquation layer_equation(const FrequencySolver& solver, std::size_t index,
                             const FrequencyStates& states, double k) {
  const GridLayer& layer = solver.stack.layers[index];
  LayerEquation equation = scattering_part(
      layer, states, {solver.phase[index], layer.sigma_s, extinctions(layer), layer.backward});
  auto& [A, B, fastest] = equation;
  for (std::size_t b = 0; b < states.size(); ++b) {
    const std::size_t j = states.node[b];
    const int m = states.mode[b];
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
    if (equation.fastest == 0.0) {  // clear, at k = 0
      for (std::size_t a = 0; a < n; ++a) operators[i].transmission(a, a) = has_bottom ? 1.0 : 0.0;
      continue;
    }
    problems.push_back(slab_problem(layer, states, equation));
    reflection.push_back(operators[i].reflection.values.data());
    transmission.push_back(operators[i].transmission.values.data());
  }
  if (n > most_states_together || problems.size() == 1)
    for (std::size_t i = 0; i < problems.size(); ++i)
      double_slab(problems[i], reflection[i], transmission[i]);
  else if (!problems.empty())
    double_slabs(problems, reflection.data(), transmission.data());
  for (LayerOperators& of_frequency : operators) {
    if (!has_bottom) std::ranges::fill(of_frequency.transmission.values, 0.0);
    keep_out_of_reach(layer, states, of_frequency.transmission);
  }
  return operators;
}

std::vector<std::vector<LayerOperators>> layer_ladder_at_frequencies(
    const FrequencySolver& solver, std::size_t index, double thinnest, std::size_t rungs,
    std::span<const double> frequencies) {
  GridLayer layer = solver.stack.layers[index];
  layer.thickness = std::ldexp(thinnest, static_cast<int>(rungs) - 1);
  const FrequencyStates states = make_states(solver, layer.ior);
  const std::size_t n = states.size();
  std::vector<std::vector<LayerOperators>> ladder(
      rungs, std::vector<LayerOperators>(frequencies.size(), {Matrix(n, n), Matrix(n, n)}));
  std::vector<LayerEquation> equations;
  equations.reserve(frequencies.size());
  std::vector<SlabProblem> problems;
  for (const double k : frequencies)
    problems.push_back(slab_problem(
        layer, states, equations.emplace_back(layer_equation(solver, index, states, k))));
  std::vector<double*> reflection, transmission;
  for (std::vector<LayerOperators>& rung : ladder)
    for (LayerOperators& operators : rung) {
      reflection.push_back(operators.reflection.values.data());
      transmission.push_back(operators.transmission.values.data());
    }
  double_slab_ladder(problems, rungs, reflection.data(), transmission.data());
  return ladder;
}

DifferentiatedLayer differentiate_layer_at(const DifferentiatedSolver& differentiated,
                                           std::size_t index, double k) {
  const FrequencySolver& solver = differentiated.solver;
  const GridLayer& layer = solver.stack.layers[index];
  const FrequencyStates states = make_states(solver, layer.ior);
  const LayerEquation equation = layer_equation(solver, index, states, k);
  const auto by = [&](const ScatteringDerivative& derivative) {
    return scattering_part(
        layer, states,
        {derivative.phase, 1.0, derivative.on_grid.extinction, derivative.on_grid.backward});
  };
  const std::array changes{by(differentiated.by_sigma_a[index]),
                           by(differentiated.by_sigma_s[index]), by(differentiated.by_g[index])};
  std::vector<SlabProblemDerivative> derivatives;
  for (const LayerEquation& change : changes)
    derivatives.push_back({change.A.values.data(), change.B.values.data()});
  DifferentiatedSlab slab =
      double_slab_with_derivatives(slab_problem(layer, states, equation), derivatives);
  const auto finish = [&](Matrix& transmission) {
    if (!std::isfinite(layer.thickness)) std::ranges::fill(transmission.values, 0.0);
    keep_out_of_reach(layer, states, transmission);
  };
  finish(slab.transmission);
  DifferentiatedLayer result{
      .operators = {std::move(slab.reflection), std::move(slab.transmission)}};
  const std::array members{&result.by_sigma_a, &result.by_sigma_s, &result.by_g};
  for (std::size_t p = 0; p < members.size(); ++p) {
    *members[p] = {std::move(slab.reflection_derivatives[p]),
                   std::move(slab.transmission_derivatives[p])};
    finish(members[p]->transmission);
    keep_out_of_reach(layer, states, members[p]->reflection);  // light caught there is lost
  }
  result.by_thickness = by_thickness(result.operators, equation.A, equation.B);
  return result;
}

}  // namespace lamina::detail
