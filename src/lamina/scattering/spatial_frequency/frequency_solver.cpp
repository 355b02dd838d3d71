// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/spatial_frequency/frequency_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lamina/scattering/spatial_frequency/kept_rough_boundaries.h"

namespace lamina::detail {
namespace {

/// Of a layer without bottom; what its reflection lacks is the square of that.
constexpr double opaque_transmission = 1e-7;
constexpr int most_doublings = 60;

/// The states of one medium: even modes first, as the slab's symmetry wants them.
struct States {
  std::vector<std::size_t> node;
  std::vector<int> mode;
  std::size_t even = 0;
  std::vector<std::size_t> offset;  ///< [mode] where it starts
  std::vector<std::size_t> local;   ///< [node] place within a mode other than 0

  [[nodiscard]] std::size_t size() const { return node.size(); }
};

/// In mode 0 all active nodes; in the others all but the beam, which has no azimuth.
States make_states(const FrequencySolver& solver, double ior) {
  const std::size_t beam = solver.stack.grid.extra[0];
  const std::size_t active = active_count(solver.stack.grid, ior);
  States states;
  states.offset.resize(static_cast<std::size_t>(solver.modes) + 1);
  for (std::size_t i = 0; i < active; ++i) states.local.push_back(i < beam ? i : i - 1);
  for (const int parity : {0, 1}) {
    for (int m = parity; m <= solver.modes; m += 2) {
      states.offset[static_cast<std::size_t>(m)] = states.size();
      for (std::size_t i = 0; i < active; ++i) {
        if (m > 0 && i == beam) continue;
        states.node.push_back(i);
        states.mode.push_back(m);
      }
    }
    if (parity == 0) states.even = states.size();
  }
  return states;
}

std::size_t place(const States& states, int mode, std::size_t node) {
  return states.offset[static_cast<std::size_t>(mode)] + (mode == 0 ? node : states.local[node]);
}

/// A layer's equation at one frequency: dF+/dz = A F+ + B F-.
struct LayerEquation {
  Matrix A, B;
  double fastest = 0.0;  ///< [1/mm] at which the light of any state changes
};

LayerEquation layer_equation(const FrequencySolver& solver, std::size_t index, const States& states,
                             double k) {
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

/// Light in a clear layer from or to directions that never get there would stay for ever.
void keep_out_of_reach(const GridLayer& layer, const States& states, Matrix& transmission) {
  if (layer.sigma_s > 0.0 || layer.backward > 0.0) return;
  for (std::size_t b = 0; b < states.size(); ++b)
    for (std::size_t a = 0; a < states.size(); ++a)
      if (std::max(states.node[a], states.node[b]) >= layer.reach) transmission(a, b) = 0.0;
}

/// [frequency]
std::vector<LayerOperators> layer_operators(const FrequencySolver& solver, std::size_t index,
                                            std::span<const double> frequencies) {
  const GridLayer& layer = solver.stack.layers[index];
  const States states = make_states(solver, layer.ior);
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

/// A rough boundary between states: each mode for itself.
Matrix of_all_modes(const FrequencySolver& solver, std::size_t index, Matrix RoughBoundary::*member,
                    const States& to, const States& from) {
  Matrix all(to.size(), from.size());
  for (std::size_t b = 0; b < from.size(); ++b) {
    const Matrix& of_mode = solver.rough[static_cast<std::size_t>(from.mode[b])][index].*member;
    for (std::size_t a = 0; a < to.size(); ++a)
      if (to.mode[a] == from.mode[b]) all(a, b) = of_mode(to.node[a], from.node[b]);
  }
  return all;
}

Covered cover_by_rough_interface(const FrequencySolver& solver, std::size_t index, Matrix below) {
  const States before = make_states(solver, solver.stack.ior[index]);
  const States behind = make_states(solver, solver.stack.ior[index + 1]);
  const auto of = [&](Matrix RoughBoundary::*member, const States& to, const States& from) {
    return of_all_modes(solver, index, member, to, from);
  };
  const Matrix returns = between(of(&RoughBoundary::reflection_below, behind, behind), below);
  Matrix pass = product(returns, of(&RoughBoundary::transmission_down, behind, before));
  Matrix reflection =
      product(of(&RoughBoundary::transmission_up, before, behind), product(below, pass));
  const Matrix first = of(&RoughBoundary::reflection_above, before, before);
  for (std::size_t k = 0; k < reflection.values.size(); ++k)
    reflection.values[k] += first.values[k];
  return {{std::move(pass), std::move(below)}, std::move(reflection)};
}

Covered cover_by_interface(const FrequencySolver& solver, std::size_t index, Matrix below) {
  const GridStack& stack = solver.stack;
  if (is_rough(stack.interfaces[index], stack.ior[index], stack.ior[index + 1]))
    return cover_by_rough_interface(solver, index, std::move(below));
  const double ior_before = stack.ior[index], ior_behind = stack.ior[index + 1];
  const States before = make_states(solver, ior_before), behind = make_states(solver, ior_behind);
  const std::size_t common =
      std::min(active_count(stack.grid, ior_before), active_count(stack.grid, ior_behind));
  const auto reflectance = [&](std::size_t node) {
    return node < common ? node_fresnel(stack.grid, node, ior_before, ior_behind) : 1.0;
  };
  Matrix mirror(behind.size(), behind.size());
  for (std::size_t a = 0; a < behind.size(); ++a) mirror(a, a) = reflectance(behind.node[a]);
  const Matrix returns = between(mirror, below);
  const Matrix sent_back = product(below, returns);
  Covered covered{{Matrix(behind.size(), before.size()), std::move(below)},
                  Matrix(before.size(), before.size())};
  for (std::size_t b = 0; b < before.size(); ++b) {
    const double r_b = reflectance(before.node[b]);
    covered.reflection(b, b) += r_b;
    if (before.node[b] >= common) continue;
    const std::size_t from = place(behind, before.mode[b], before.node[b]);
    for (std::size_t a = 0; a < behind.size(); ++a)
      covered.crossing.pass(a, b) = returns(a, from) * (1.0 - r_b);
    for (std::size_t a = 0; a < before.size(); ++a) {
      if (before.node[a] >= common) continue;
      const std::size_t to = place(behind, before.mode[a], before.node[a]);
      covered.reflection(a, b) +=
          (1.0 - reflectance(before.node[a])) * sent_back(to, from) * (1.0 - r_b);
    }
  }
  return covered;
}

Matrix ground_reflection(const FrequencySolver& solver) {
  const GridStack& stack = solver.stack;
  const std::size_t active = active_count(stack.grid, stack.ior.back());
  const std::size_t n = make_states(solver, stack.ior.back()).size();
  Matrix ground(n, n);
  if (stack.ground_reflectance == 0.0) return ground;
  const auto& etendue = stack.grid.etendue;
  const double all =
      std::accumulate(etendue.begin(), etendue.begin() + static_cast<std::ptrdiff_t>(active), 0.0);
  for (std::size_t j = 0; j < active; ++j)  // mode 0 comes first
    for (std::size_t i = 0; i < active; ++i)
      ground(i, j) = stack.ground_reflectance * std::sqrt(etendue[i] * etendue[j]) / all;
  return ground;
}

bool is_extra(const DirectionGrid& grid, std::size_t node) {
  return std::ranges::find(grid.extra, node) != grid.extra.end();
}

/// Flux of mode 0 in all directions but the beams'.
double scattered_flux(const FrequencySolver& solver, const std::vector<double>& state, double ior) {
  double sum = 0.0;
  for (std::size_t i = 0; i < active_count(solver.stack.grid, ior); ++i)
    if (!is_extra(solver.stack.grid, i)) sum += std::sqrt(solver.stack.grid.etendue[i]) * state[i];
  return sum;
}

}  // namespace

FrequencySolver make_frequency_solver(const LayerStack& stack, int nodes, int modes,
                                      std::span<const GridDirection> oblique,
                                      Illumination illumination, RoughModes rough) {
  std::vector<GridDirection> beams{direction_in(stack.ior_above(), 0.0)};
  beams.insert(beams.end(), oblique.begin(), oblique.end());
  // Light of an oblique beam that is scattered once is known by azimuths, as a chain cut off is.
  const AzimuthEnd end = oblique.empty() ? AzimuthEnd::absorbing : AzimuthEnd::cut_off;
  FrequencySolver solver{.stack = make_grid_stack(stack, nodes, beams),
                         .modes = modes,
                         .azimuth = make_azimuth_chain(modes, end)};
  solver.waves = azimuth_waves(solver.azimuth);
  for (const GridLayer& layer : solver.stack.layers) {
    auto& kernels = solver.phase.emplace_back();
    for (int m = 0; m <= modes; ++m) kernels.push_back(phase_mode(layer.moments, layer.cos, m));
  }
  solver.rough = kept_rough_boundaries(solver.stack, rough == RoughModes::first ? 1 : modes + 1);
  solver.top = make_top_passage(solver.stack, solver.rough[0], illumination);
  return solver;
}

namespace {

/// The whole stack at one spatial frequency.
struct StackAtFrequency {
  std::vector<Crossing> crossings;  ///< bottom first
  Matrix reflection;                ///< of the whole, for light from above
};

/// [frequency]
std::vector<StackAtFrequency> stacks_at(const FrequencySolver& solver,
                                        std::span<const double> frequencies) {
  std::vector<StackAtFrequency> stacks(frequencies.size(), {{}, ground_reflection(solver)});
  const auto take = [](StackAtFrequency& stack, Covered covered) {
    stack.crossings.push_back(std::move(covered.crossing));
    stack.reflection = std::move(covered.reflection);
  };
  for (std::size_t index = solver.stack.layers.size(); index-- > 0;) {
    const auto operators = layer_operators(solver, index, frequencies);
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
      take(stacks[i], cover_by_interface(solver, index + 1, std::move(stacks[i].reflection)));
      take(stacks[i], cover_by_layer(operators[i], std::move(stacks[i].reflection)));
    }
  }
  for (StackAtFrequency& stack : stacks)
    take(stack, cover_by_interface(solver, 0, std::move(stack.reflection)));
  return stacks;
}

StackAtFrequency stack_at_frequency(const FrequencySolver& solver, double k) {
  return stacks_at(solver, {&k, 1}).front();
}

/// What a rough top alone throws back of a state that arrives from above, the beams apart.
double thrown_back_by_rough_top(const FrequencySolver& solver, const std::vector<double>& state) {
  if (!solver.top.is_rough) return 0.0;
  const std::size_t active = active_count(solver.stack.grid, solver.stack.ior[0]);
  const std::vector<double> first_mode(state.begin(),
                                       state.begin() + static_cast<std::ptrdiff_t>(active));
  return scattered_flux(solver, product(solver.rough[0][0].reflection_above, first_mode),
                        solver.stack.ior[0]);
}

/// What leaves the stack in mode 0, the beam apart, for a state that arrives from above.
FrequencyResponse leaving_flux(const FrequencySolver& solver, const StackAtFrequency& at,
                               std::vector<double> state) {
  FrequencyResponse result;
  result.reflectance =
      scattered_flux(solver, product(at.reflection, state), solver.stack.ior.front());
  if (solver.stack.is_semi_infinite) return result;
  for (std::size_t c = at.crossings.size(); c-- > 0;) state = product(at.crossings[c].pass, state);
  result.transmittance = (1.0 - solver.stack.ground_reflectance) *
                         scattered_flux(solver, state, solver.stack.ior.back());
  return result;
}

}  // namespace

std::vector<FrequencyResponse> responses(const FrequencySolver& solver,
                                         std::span<const double> frequencies) {
  std::vector<FrequencyResponse> result;
  for (const StackAtFrequency& at : stacks_at(solver, frequencies)) {
    std::vector<double> state(at.reflection.rows, 0.0);
    state[solver.stack.grid.extra[0]] = 1.0 / std::sqrt(extra_node_etendue);
    const double mirrored = thrown_back_by_rough_top(solver, state);
    result.push_back(leaving_flux(solver, at, std::move(state)));
    result.back().reflectance -= mirrored;
  }
  return result;
}

FrequencyResponse response(const FrequencySolver& solver, double k) {
  return responses(solver, {&k, 1}).front();
}

SpectralReflection spectral_reflection(const FrequencySolver& solver, double k) {
  States states = make_states(solver, solver.stack.ior.front());
  return {stack_at_frequency(solver, k).reflection, std::move(states.mode), std::move(states.node)};
}

std::vector<std::vector<FrequencyResponse>> oblique_responses(const FrequencySolver& solver,
                                                              std::span<const double> frequencies) {
  const States outside = make_states(solver, solver.stack.ior.front());
  std::vector<std::vector<FrequencyResponse>> result;
  for (const StackAtFrequency& at : stacks_at(solver, frequencies)) {
    std::vector<FrequencyResponse>& modes = result.emplace_back();
    for (int m = 0; m <= solver.modes; ++m) {
      std::vector<double> state(at.reflection.rows, 0.0);
      state[place(outside, m, solver.stack.grid.extra[1])] = 1.0 / std::sqrt(extra_node_etendue);
      modes.push_back(leaving_flux(solver, at, std::move(state)));
    }
  }
  return result;
}

std::vector<FrequencyResponse> oblique_response(const FrequencySolver& solver, double k) {
  return oblique_responses(solver, {&k, 1}).front();
}

std::vector<FrequencyResponse> diffuse_responses(const FrequencySolver& solver,
                                                 std::span<const double> frequencies) {
  const GridStack& stack = solver.stack;
  const std::size_t outside = active_count(stack.grid, stack.ior[0]);
  const std::size_t inside = active_count(stack.grid, stack.ior[1]);
  std::vector<FrequencyResponse> result;
  for (const StackAtFrequency& at : stacks_at(solver, frequencies)) {
    std::vector<double> state(at.reflection.rows, 0.0);
    double arriving = 0.0, mirrored = 0.0;
    for (std::size_t i = 0; i < outside; ++i) {  // mode 0 comes first
      if (i == stack.grid.extra[0]) continue;
      const double etendue = stack.grid.etendue[i];
      state[i] = std::sqrt(etendue);
      arriving += etendue;
      if (solver.top.is_rough) continue;
      mirrored +=
          etendue * (i < inside ? node_fresnel(stack.grid, i, stack.ior[0], stack.ior[1]) : 1.0);
    }
    mirrored += thrown_back_by_rough_top(solver, state);
    const FrequencyResponse leaving = leaving_flux(solver, at, std::move(state));
    result.push_back({.reflectance = (leaving.reflectance - mirrored) / arriving,
                      .transmittance = leaving.transmittance / arriving});
  }
  return result;
}

FrequencyResponse diffuse_response(const FrequencySolver& solver, double k) {
  return diffuse_responses(solver, {&k, 1}).front();
}

}  // namespace lamina::detail
