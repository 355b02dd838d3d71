// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"
#include "lamina/solve/scattering/heterogeneous/internal/interlayer_series.h"

namespace lamina::detail {

/// A plane on a tape; by default none.
struct TapedPlane {
  std::size_t number = std::numeric_limits<std::size_t>::max();
  [[nodiscard]] bool is_none() const { return number == TapedPlane{}.number; }
};

/// Planes that were made from one another, and how: so that the derivatives of a number by the last
/// of them can be brought back to the first (reverse accumulation), and changes of the first ahead
/// to the last.
template <class T>
class Tape {
 public:
  using Values = std::vector<T>;

  Tape(int width, int height) : width_(width), height_(height) {}

  /// Takes a plane in that was made otherwise.
  [[nodiscard]] TapedPlane take(PlaneOf<T> plane);
  [[nodiscard]] const PlaneOf<T>& plane(TapedPlane at) const { return planes_[at.number]; }

  /// Records what brings derivatives by later planes to earlier ones, called in reverse order; and
  /// what brings changes of earlier planes to later ones.
  void record(std::function<void()> back, std::function<void()> ahead) {
    steps_.push_back({std::move(back), std::move(ahead)});
  }
  /// Records a plane that follows another texel by texel.
  /// @param slope  (texel) -> derivative of `out` by `in` there
  template <class Slope>
  void record_by_texel(TapedPlane in, TapedPlane out, const Slope& slope) {
    const auto pass = [this, slope](TapedPlane from, TapedPlane to) {
      const Values& passed = derivative(from).values;
      if (passed.empty()) return;
      Values& sum = derivative_sum(to);
      for (std::size_t i = 0; i < passed.size(); ++i) sum[i] += passed[i] * slope(i);
    };
    record([pass, in, out] { pass(out, in); }, [pass, in, out] { pass(in, out); });
  }

  /// The derivative by a plane so far, or, on the way ahead, what the plane changes by; empty: 0.
  [[nodiscard]] const PlaneOf<T>& derivative(TapedPlane at) const {
    return derivatives_[at.number];
  }
  /// To add to it.
  [[nodiscard]] Values& derivative_sum(TapedPlane at);
  void add_derivative(TapedPlane at, PlaneOf<T> more);
  /// The derivative by a plane that no step asks for any more.
  [[nodiscard]] PlaneOf<T> take_derivative(TapedPlane at) {
    return std::exchange(derivatives_[at.number], PlaneOf<T>{width_, height_, {}});
  }

  [[nodiscard]] TapedPlane sum(TapedPlane a, TapedPlane b);
  [[nodiscard]] TapedPlane product(TapedPlane a, TapedPlane b);
  /// a / (1 - b)
  [[nodiscard]] TapedPlane series(TapedPlane a, TapedPlane b);

  /// Goes back over all steps. @param by_results  derivatives by planes, where they are not 0
  struct Derivative {
    TapedPlane of;
    PlaneOf<T> value;
  };
  void go_back(std::vector<Derivative> by_results);
  /// Goes ahead over all steps. @param changes  of planes, where they are not 0
  void go_ahead(std::vector<Derivative> changes);
  /// Frees what the last way left.
  void forget_derivatives();

 private:
  struct Step {
    std::function<void()> back, ahead;
  };
  void start_with(std::vector<Derivative> derivatives);

  int width_, height_;
  std::deque<PlaneOf<T>> planes_, derivatives_;  // references to them last
  std::vector<Step> steps_;
};

/// Layers whose coordinates and junctions are planes of a tape, and light between them, as
/// sum_interlayer_bounces takes it: a TransmittingField that records.
template <class T>
class TapedField {
 public:
  using Light = TapedPlane;

  /// @param layers       their bases hold the coordinates; no modes
  /// @param coordinates  the same on the tape, [layer]; none where nothing varies
  /// @param junctions    on the tape
  TapedField(Tape<T>& tape, const BlurPyramid& pyramid,
             const std::vector<TransportLayerOf<T>>& layers, std::vector<TapedPlane> coordinates,
             std::vector<TapedPlane> junctions)
      : tape_(tape),
        pyramid_(pyramid),
        layers_(layers),
        coordinates_(std::move(coordinates)),
        junctions_(std::move(junctions)) {}

  [[nodiscard]] std::size_t junctions() const { return junctions_.size(); }
  [[nodiscard]] bool has_bottom() const {
    return layers_.back().operators[transmission_down].terms > 0;
  }
  [[nodiscard]] Light blur(std::size_t layer, LayerOperator which, const Light& light) const {
    return apply(layer, std::array<std::size_t, 1>{which}, light)[0];
  }
  [[nodiscard]] std::array<Light, 2> blur(std::size_t layer, LayerOperator first,
                                          LayerOperator second, const Light& light) const {
    const std::vector<Light> both = apply(layer, std::array<std::size_t, 2>{first, second}, light);
    return {both[0], both[1]};
  }
  void multiply(Light& light, std::size_t junction) const {
    light = tape_.product(light, junctions_[junction]);
  }
  void add(Light& sum, Light more) const { sum = sum.is_none() ? more : tape_.sum(sum, more); }
  void close(std::vector<Light>& down) const;
  void turn_round(const std::vector<Light>& up, Light& arriving) const;

 private:
  struct Totals {  ///< of all layers, as planes
    std::vector<std::array<Light, 4>> layers;
    std::vector<Light> junctions;
  };
  [[nodiscard]] Totals totals() const;
  [[nodiscard]] std::vector<Light> apply(std::size_t layer, std::span<const std::size_t> which,
                                         Light light) const;
  [[nodiscard]] Light total(std::size_t layer, std::size_t which) const;
  void close_locally(std::vector<Light>& down) const;

  Tape<T>& tape_;
  const BlurPyramid& pyramid_;
  const std::vector<TransportLayerOf<T>>& layers_;
  std::vector<TapedPlane> coordinates_, junctions_;
};

}  // namespace lamina::detail
