// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/slab_family.h"

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "lamina/solve/scattering/spatial_frequency/internal/frequency_states.h"
#include "lamina/solve/scattering/spatial_frequency/internal/layer_at_frequency.h"
#include "lamina/solve/scattering/spatial_frequency/internal/leaving_light.h"
#include "lamina/solve/scattering/spatial_frequency/internal/stack_at_frequency.h"

namespace lamina::detail {
namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// A row vector times a matrix.
std::vector<double> row_product(const std::vector<double>& row, const Matrix& m) {
  std::vector<double> result(m.columns, 0.0);
  for (std::size_t j = 0; j < m.columns; ++j)
    for (std::size_t i = 0; i < m.rows; ++i) result[j] += row[i] * m(i, j);
  return result;
}

/// The layers above the inner one, at one frequency.
struct Coat {
  Matrix returns;                ///< reflection of light that comes from inside
  std::vector<double> entering;  ///< state that comes down from it, before any return
  std::vector<double> leaving;   ///< flux outside per state that comes up to it
  double thrown_back = 0.0;      ///< flux of the arriving light that it scatters back
};

/// Layers and the interfaces below each but the first, on top of one another, [frequency].
class Pile {
 public:
  explicit Pile(std::vector<Matrix> bottom) : at_(bottom.size()) {
    for (std::size_t i = 0; i < bottom.size(); ++i) at_[i].reflection = std::move(bottom[i]);
  }
  void cover_by_interfaces(const FrequencySolver& solver, std::size_t index) {
    for (StackAtFrequency& at : at_) take(at, cover_by_interface(solver, index, at.reflection));
  }
  void cover_by_layers(std::span<const LayerOperators> layers) {
    for (std::size_t i = 0; i < at_.size(); ++i)
      take(at_[i], cover_by_layer(layers[i], at_[i].reflection));
  }
  [[nodiscard]] const StackAtFrequency& operator[](std::size_t i) const { return at_[i]; }

 private:
  static void take(StackAtFrequency& at, Covered covered) {
    at.crossings.push_back(std::move(covered.crossing));
    at.reflection = std::move(covered.reflection);
  }
  std::vector<StackAtFrequency> at_;
};

std::vector<Coat> make_coats(const SlabFamily& family, std::span<const double> frequencies,
                             const ArrivingLight& arriving) {
  const FrequencySolver& solver = family.slab;
  const GridStack& stack = solver.stack;
  const std::size_t inside = make_states(solver, stack.layers[family.inner].ior).size();
  Pile below({frequencies.size(), ground_reflection(solver)}),
      above({frequencies.size(), Matrix(inside, inside)});
  std::vector<std::vector<LayerOperators>> layers;
  for (std::size_t l = 0; l < family.inner; ++l)
    layers.push_back(layer_at_frequencies(solver, l, frequencies));
  // The lower coat is the upper one turned over.
  for (std::size_t l = 0; l < family.inner; ++l) {
    below.cover_by_interfaces(solver, stack.layers.size() - l);
    below.cover_by_layers(layers[l]);
  }
  below.cover_by_interfaces(solver, family.inner + 1);
  for (std::size_t l = family.inner; l > 0; --l) {
    above.cover_by_interfaces(solver, l);
    above.cover_by_layers(layers[l - 1]);
  }
  above.cover_by_interfaces(solver, 0);
  std::vector<Coat> coats;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    Coat& coat = coats.emplace_back(Coat{.returns = below[i].reflection,
                                         .entering = arriving.state,
                                         .leaving = weights_of_flux(solver, stack.ior.back())});
    for (const Crossing& crossing : below[i].crossings)
      coat.leaving = row_product(coat.leaving, crossing.pass);
    const auto& crossings = above[i].crossings;
    for (std::size_t c = crossings.size(); c-- > 0;)
      coat.entering = product(crossings[c].pass, coat.entering);
    coat.thrown_back = dot(weights_of_flux(solver, stack.ior.front()),
                           product(above[i].reflection, arriving.state)) -
                       arriving.mirrored;
  }
  return coats;
}

/// Flux that leaves through a coat over what responds inside, with all returns between both.
double leaving_flux(const Coat& coat, const Matrix& inside) {
  const std::vector<double> down = product(between(coat.returns, inside), coat.entering);
  return dot(coat.leaving, product(inside, down));
}

Matrix sum(const Matrix& a, const Matrix& b, double factor) {
  Matrix result = a;
  for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] += factor * b.values[i];
  return result;
}

}  // namespace

double SlabFamily::inner_thickness(std::size_t slab_index) const {
  const double step = slab_index % 2 == 0 ? 1.0 : std::numbers::sqrt2;
  return std::ldexp(thinnest * step, static_cast<int>(slab_index / 2));
}

SlabFamily make_slab_family(const LayerStack& half_space, const LayerStack& thinnest,
                            std::size_t slabs, int nodes, int modes) {
  const std::size_t inner = half_space.layers().size() - 1;
  return {.slab = make_frequency_solver(thinnest, nodes, modes, {}, Illumination::diffuse),
          .half_space = make_frequency_solver(half_space, nodes, modes, {}, Illumination::diffuse),
          .inner = inner,
          .thinnest = thinnest.layers()[inner].thickness,
          .slabs = slabs};
}

std::vector<FamilyResponse> family_responses(const SlabFamily& family,
                                             std::span<const double> frequencies) {
  const ArrivingLight arriving = arriving_light(family.slab, Illumination::diffuse);
  const std::vector<Coat> coats = make_coats(family, frequencies, arriving);
  std::vector<FamilyResponse> responses(frequencies.size());
  const auto endless = layer_at_frequencies(family.half_space, family.inner, frequencies);
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    responses[i].half_space.reflectance =
        (coats[i].thrown_back + leaving_flux(coats[i], endless[i].reflection)) / arriving.flux;
    responses[i].slabs.resize(family.slabs);
  }
  for (std::size_t first = 0; first < std::min<std::size_t>(family.slabs, 2); ++first) {
    const std::size_t rungs = (family.slabs - first + 1) / 2;
    const auto ladder = layer_ladder_at_frequencies(
        family.slab, family.inner, family.inner_thickness(first), rungs, frequencies);
    for (std::size_t rung = 0; rung < rungs; ++rung)
      for (std::size_t i = 0; i < frequencies.size(); ++i) {
        const auto& [reflection, transmission] = ladder[rung][i];
        const double alike = leaving_flux(coats[i], sum(reflection, transmission, 1.0));
        const double opposite = leaving_flux(coats[i], sum(reflection, transmission, -1.0));
        responses[i].slabs[2 * rung + first] = {
            .reflectance = (coats[i].thrown_back + 0.5 * (alike + opposite)) / arriving.flux,
            .transmittance = 0.5 * (alike - opposite) / arriving.flux};
      }
  }
  return responses;
}

}  // namespace lamina::detail
