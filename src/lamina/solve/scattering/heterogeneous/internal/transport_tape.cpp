// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/internal/transport_tape.h"

#include <algorithm>
#include <cassert>
#include <memory>
#include <type_traits>
#include <utility>

#include "lamina/base/core/dual_number.h"
#include "lamina/solve/scattering/heterogeneous/internal/local_sweep_derivatives.h"

namespace lamina::detail {
namespace {

/// Coefficients of the derivative of a sum of powers.
template <class T>
std::vector<T> slope_of_powers(std::span<const T> coefficients) {
  std::vector<T> slope;
  for (std::size_t p = 1; p < coefficients.size(); ++p)
    slope.push_back(static_cast<T>(p) * coefficients[p]);
  return slope;
}

/// What is done with light where it enters: nothing, or the terms of both ends.
template <class T>
struct Entry {
  std::vector<T> factor;  ///< empty: 1
  const std::array<MappedOperatorOf<T>, 4>* operators;

  [[nodiscard]] std::vector<const MappedOperatorOf<T>*> those(
      std::span<const std::size_t> which) const {
    std::vector<const MappedOperatorOf<T>*> chosen;
    for (const std::size_t w : which) chosen.push_back(&(*operators)[w]);
    return chosen;
  }
};

template <class T>
std::vector<Entry<T>> entries_of(const TransportLayerOf<T>& layer) {
  std::vector<Entry<T>> entries;
  for (const auto& entry : layer.of_entry) entries.push_back({entry.factor, &entry.operators});
  if (entries.empty()) entries.push_back({{}, &layer.operators});
  return entries;
}

template <class T>
void add_to(std::vector<T>& sum, std::vector<T> more) {
  if (sum.empty())
    sum = std::move(more);
  else
    for (std::size_t i = 0; i < more.size(); ++i) sum[i] += more[i];
}

template <class T>
void add_products(std::vector<T>& sum, const std::vector<T>& a, const std::vector<T>& b) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += a[i] * b[i];
}

using TotalPlanes = std::vector<std::array<TapedPlane, 4>>;

/// What a plane holds at a texel; and what it changes by.
template <class N, class T>
N number_at(const Tape<T>& tape, TapedPlane plane, std::size_t i) {
  const auto value = static_cast<double>(tape.plane(plane).values[i]);
  if constexpr (std::is_same_v<N, double>) {
    return value;
  } else {
    const std::vector<T>& change = tape.derivative(plane).values;
    return {value, change.empty() ? 0.0 : static_cast<double>(change[i])};
  }
}

/// The totals of all layers and the junctions at one texel.
template <class N = double, class T>
LocalLayersOf<N> local_layers(const Tape<T>& tape, const TotalPlanes& totals,
                              const std::vector<TapedPlane>& junctions, std::size_t i) {
  LocalLayersOf<N> here(junctions.size());
  for (std::size_t l = 0; l < totals.size(); ++l)
    for (std::size_t which = 0; which < 4; ++which)
      here.total[l][which] = number_at<N>(tape, totals[l][which], i);
  for (std::size_t j = 0; j < junctions.size(); ++j)
    here.junction[j] = number_at<N>(tape, junctions[j], i);
  return here;
}

template <class T>
void add_local(Tape<T>& tape, const TotalPlanes& totals, const std::vector<TapedPlane>& junctions,
               std::size_t i, const LocalLayers& by_here) {
  for (std::size_t l = 0; l < totals.size(); ++l)
    for (std::size_t which = 0; which < 4; ++which)
      tape.derivative_sum(totals[l][which])[i] += static_cast<T>(by_here.total[l][which]);
  for (std::size_t j = 0; j < junctions.size(); ++j)
    tape.derivative_sum(junctions[j])[i] += static_cast<T>(by_here.junction[j]);
}

template <class N = double, class T>
PerJunctionOf<N> values_at(const Tape<T>& tape, const std::vector<TapedPlane>& light,
                           std::size_t i) {
  PerJunctionOf<N> values{};
  for (std::size_t j = 0; j < light.size(); ++j) values[j] = number_at<N>(tape, light[j], i);
  return values;
}

}  // namespace

template <class T>
TapedPlane Tape<T>::take(PlaneOf<T> plane) {
  planes_.push_back(std::move(plane));
  derivatives_.push_back({width_, height_, {}});
  return {planes_.size() - 1};
}

template <class T>
typename Tape<T>::Values& Tape<T>::derivative_sum(TapedPlane at) {
  Values& sum = derivatives_[at.number].values;
  if (sum.empty()) sum.resize(planes_[at.number].values.size());
  return sum;
}

template <class T>
void Tape<T>::add_derivative(TapedPlane at, PlaneOf<T> more) {
  add_to(derivatives_[at.number].values, std::move(more.values));
}

template <class T>
TapedPlane Tape<T>::sum(TapedPlane a, TapedPlane b) {
  PlaneOf<T> result = plane(a);
  for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] += plane(b).values[i];
  const TapedPlane out = take(std::move(result));
  record(
      [this, a, b, out] {
        if (derivative(out).values.empty()) return;
        add_derivative(a, derivative(out));
        add_derivative(b, take_derivative(out));
      },
      [this, a, b, out] {
        add_derivative(out, derivative(a));
        add_derivative(out, derivative(b));
      });
  return out;
}

template <class T>
TapedPlane Tape<T>::product(TapedPlane a, TapedPlane b) {
  PlaneOf<T> result = plane(a);
  for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] *= plane(b).values[i];
  const TapedPlane out = take(std::move(result));
  record_by_texel(a, out, [this, b](std::size_t i) { return plane(b).values[i]; });
  record_by_texel(b, out, [this, a](std::size_t i) { return plane(a).values[i]; });
  return out;
}

template <class T>
TapedPlane Tape<T>::series(TapedPlane a, TapedPlane b) {
  PlaneOf<T> result = plane(a);
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] /= T(1) - plane(b).values[i];
  const TapedPlane out = take(std::move(result));
  record_by_texel(a, out, [this, b](std::size_t i) { return T(1) / (T(1) - plane(b).values[i]); });
  record_by_texel(b, out, [this, b, out](std::size_t i) {
    return plane(out).values[i] / (T(1) - plane(b).values[i]);
  });
  return out;
}

template <class T>
void Tape<T>::forget_derivatives() {
  for (PlaneOf<T>& sum : derivatives_) sum.values = {};
}

template <class T>
void Tape<T>::start_with(std::vector<Derivative> derivatives) {
  forget_derivatives();
  for (Derivative& at : derivatives) add_derivative(at.of, std::move(at.value));
}

template <class T>
void Tape<T>::go_back(std::vector<Derivative> by_results) {
  start_with(std::move(by_results));
  for (std::size_t i = steps_.size(); i-- > 0;) steps_[i].back();
}

template <class T>
void Tape<T>::go_ahead(std::vector<Derivative> changes) {
  start_with(std::move(changes));
  for (const Step& step : steps_) step.ahead();
}

/// Each operator's blurs serve its derivative by the coordinate where light comes out, too; that by
/// the coordinate where light enters falls out of the transpose.
template <class T>
std::vector<TapedPlane> TapedField<T>::apply(std::size_t number, std::span<const std::size_t> which,
                                             Light light) const {
  const TransportLayerOf<T>& layer = layers_[number];
  const std::size_t count = which.size();
  std::vector<PlaneOf<T>> sums(count);
  // What each output changes by with the coordinate where it comes out; empty: 0.
  const auto slopes = std::make_shared<std::vector<PlaneOf<T>>>(count);
  for (const Entry<T>& entry : entries_of(layer)) {
    const auto operators = entry.those(which);
    std::vector<PlaneAndSlope<T>> parts =
        entry.factor.empty()
            ? apply_operators_and_slopes(pyramid_, tape_.plane(light), layer.basis, operators)
            : apply_operators_and_slopes(pyramid_,
                                         times_basis(layer.basis, tape_.plane(light), entry.factor),
                                         layer.basis, operators);
    for (std::size_t o = 0; o < count; ++o) {
      add_to(sums[o].values, std::move(parts[o].plane.values));
      if (!parts[o].slope.values.empty())
        add_to((*slopes)[o].values, std::move(parts[o].slope.values));
    }
  }
  for (PlaneOf<T>& sum : sums) sum.width = pyramid_.width, sum.height = pyramid_.height;
  std::vector<Light> outs;
  for (PlaneOf<T>& sum : sums) outs.push_back(tape_.take(std::move(sum)));
  const std::vector numbers(which.begin(), which.end());
  const auto back = [this, &layer, number, numbers, light, outs, slopes] {
    std::vector<PlaneOf<T>> by_outs;
    std::vector<std::size_t> there;  // operators of which something comes back
    const Light coordinate = coordinates_[number];
    for (std::size_t o = 0; o < outs.size(); ++o) {
      if (tape_.derivative(outs[o]).values.empty()) continue;
      there.push_back(numbers[o]);
      const PlaneOf<T>& by_out = by_outs.emplace_back(tape_.take_derivative(outs[o]));
      const std::vector<T>& slope = (*slopes)[o].values;
      if (!slope.empty()) add_products(tape_.derivative_sum(coordinate), by_out.values, slope);
    }
    if (there.empty()) return;
    for (const Entry<T>& entry : entries_of(layer)) {
      PlaneOf<T> entered = apply_transposed(pyramid_, by_outs, layer.basis, entry.those(there));
      if (entry.factor.empty()) {
        tape_.add_derivative(light, std::move(entered));
        continue;
      }
      PlaneAndSlope<T> by_light = times_basis_and_slope(layer.basis, entered, entry.factor);
      tape_.add_derivative(light, std::move(by_light.plane));
      add_products(tape_.derivative_sum(coordinate), by_light.slope.values,
                   tape_.plane(light).values);
    }
  };
  tape_.record(back, [this, &layer, number, numbers, light, outs, slopes] {
    const Light coordinate = coordinates_[number];
    const std::vector<T> none;
    const std::vector<T>& moved = coordinate.is_none() ? none : tape_.derivative(coordinate).values;
    for (const Entry<T>& entry : entries_of(layer)) {
      PlaneOf<T> change = tape_.derivative(light);  // of what enters
      if (!entry.factor.empty() && !(change.values.empty() && moved.empty())) {
        if (!change.values.empty()) change = times_basis(layer.basis, change, entry.factor);
        change.values.resize(tape_.plane(light).values.size());
        if (!moved.empty())
          add_products(
              change.values, moved,
              times_basis_and_slope(layer.basis, tape_.plane(light), entry.factor).slope.values);
      }
      if (change.values.empty()) continue;
      std::vector<PlaneOf<T>> parts =
          apply_operators(pyramid_, change, layer.basis, entry.those(numbers));
      for (std::size_t o = 0; o < outs.size(); ++o)
        tape_.add_derivative(outs[o], std::move(parts[o]));
    }
    for (std::size_t o = 0; o < outs.size(); ++o) {
      const std::vector<T>& slope = (*slopes)[o].values;
      if (!slope.empty() && !moved.empty())
        add_products(tape_.derivative_sum(outs[o]), moved, slope);
    }
  });
  return outs;
}

template <class T>
TapedPlane TapedField<T>::total(std::size_t number, std::size_t which) const {
  const TransportLayerOf<T>& layer = layers_[number];
  const std::vector<T>& totals = layer.operators[which].totals;
  const PlaneOf<T> ones = make_plane<T>(pyramid_.width, pyramid_.height, T(1));
  if (totals.empty()) return tape_.take(make_plane<T>(pyramid_.width, pyramid_.height));
  const Light out = tape_.take(times_basis(layer.basis, ones, totals));
  const std::vector<T> coefficients = slope_of_powers<T>(totals);
  if (!coefficients.empty())
    tape_.record_by_texel(
        coordinates_[number], out,
        [slope = std::make_shared<const PlaneOf<T>>(times_basis(layer.basis, ones, coefficients))](
            std::size_t i) { return slope->values[i]; });
  return out;
}

/// As heterogeneous_transport.cpp has it.
template <class T>
void TapedField<T>::close(std::vector<Light>& down) const {
  if (down.size() > 1) return close_locally(down);
  const Light above =
      tape_.product(tape_.product(junctions_[0], junctions_[0]), total(0, reflection_below));
  Light returned = tape_.product(total(1, reflection_above), above);
  if (std::ranges::max(tape_.plane(returned).values) > static_cast<T>(most_local_return))
    returned = blur(1, reflection_above, above);
  down[0] = tape_.series(down[0], returned);
}

template <class T>
typename TapedField<T>::Totals TapedField<T>::totals() const {
  Totals all{.layers = {}, .junctions = junctions_};
  for (std::size_t layer = 0; layer < layers_.size(); ++layer) {
    auto& of_layer = all.layers.emplace_back();
    for (std::size_t which = 0; which < 4; ++which) of_layer[which] = total(layer, which);
  }
  return all;
}

template <class T>
void TapedField<T>::close_locally(std::vector<Light>& down) const {
  const std::size_t n = down.size();
  const Totals all = totals();
  const std::vector<Light> before = down;
  std::vector<PlaneOf<T>> sums(n, make_plane<T>(pyramid_.width, pyramid_.height));
  const auto texels = sums[0].values.size();
  for (std::size_t i = 0; i < texels; ++i) {
    const LocalLayers here = local_layers(tape_, all.layers, all.junctions, i);
    const PerJunction light = sum_of_sweeps(sweep_of(here), n, 1.0, values_at(tape_, before, i));
    for (std::size_t j = 0; j < n; ++j) sums[j].values[i] = static_cast<T>(light[j]);
  }
  for (std::size_t j = 0; j < n; ++j) down[j] = tape_.take(std::move(sums[j]));
  const auto back = [this, all, before, after = down, n, texels] {
    for (const Light light : after) (void)tape_.derivative_sum(light);
    for (std::size_t i = 0; i < texels; ++i) {
      const LocalLayers here = local_layers(tape_, all.layers, all.junctions, i);
      Sweep<double> transposed{};
      const Sweep<double> sweep = sweep_of(here);
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t k = 0; k < n; ++k) transposed[j][k] = sweep[k][j];
      PerJunction by_after{};
      for (std::size_t j = 0; j < n; ++j)
        by_after[j] = static_cast<double>(tape_.derivative(after[j]).values[i]);
      // (1 - sweep) after = before: derivatives by the sweep's entries are by_before after^T.
      const PerJunction by_before = sum_of_sweeps(transposed, n, 1.0, by_after);
      for (std::size_t j = 0; j < n; ++j)
        tape_.derivative_sum(before[j])[i] += static_cast<T>(by_before[j]);
      LocalLayers by_here(n);
      back_over_sweep(here, values_at(tape_, after, i), by_before, by_here);
      add_local(tape_, all.layers, all.junctions, i, by_here);
    }
  };
  tape_.record(back, [this, all, before, after = down, n, texels] {
    for (std::size_t i = 0; i < texels; ++i) {
      const auto here = local_layers<Dual>(tape_, all.layers, all.junctions, i);
      const auto light =
          sum_of_sweeps(sweep_of(here), n, Dual{1.0}, values_at<Dual>(tape_, before, i));
      for (std::size_t j = 0; j < n; ++j)
        tape_.derivative_sum(after[j])[i] += static_cast<T>(light[j].change);
    }
  });
}

template <class T>
void TapedField<T>::turn_round(const std::vector<Light>& up, Light& arriving) const {
  const std::size_t n = up.size();
  const Totals all = totals();
  PlaneOf<T> sum = tape_.plane(arriving);
  const std::size_t texels = sum.values.size();
  for (std::size_t i = 0; i < texels; ++i) {
    const LocalLayers here = local_layers(tape_, all.layers, all.junctions, i);
    sum.values[i] += static_cast<T>(light_down(here, values_at(tape_, up, i))[n - 1]);
  }
  const Light before = arriving;
  arriving = tape_.take(std::move(sum));
  const auto back = [this, all, up, before, after = arriving, n, texels] {
    if (tape_.derivative(after).values.empty()) return;
    tape_.add_derivative(before, tape_.derivative(after));
    for (std::size_t i = 0; i < texels; ++i) {
      const LocalLayers here = local_layers(tape_, all.layers, all.junctions, i);
      const PerJunction going_up = values_at(tape_, up, i);
      PerJunction by_down{};
      by_down[n - 1] = static_cast<double>(tape_.derivative(after).values[i]);
      LocalLayers by_here(n);
      const PerJunction by_up =
          back_over_light_down(here, going_up, light_down(here, going_up), by_down, by_here);
      for (std::size_t j = 0; j < n; ++j)
        tape_.derivative_sum(up[j])[i] += static_cast<T>(by_up[j]);
      add_local(tape_, all.layers, all.junctions, i, by_here);
    }
  };
  tape_.record(back, [this, all, up, before, after = arriving, n, texels] {
    std::vector<T>& change = tape_.derivative_sum(after);
    for (std::size_t i = 0; i < texels; ++i) {
      const auto here = local_layers<Dual>(tape_, all.layers, all.junctions, i);
      const auto down = light_down(here, values_at<Dual>(tape_, up, i));
      change[i] += static_cast<T>(down[n - 1].change);
    }
    tape_.add_derivative(after, tape_.derivative(before));
  });
}

#define LAMINA_INSTANTIATE(T) \
  template class Tape<T>;     \
  template class TapedField<T>
LAMINA_INSTANTIATE(float);
LAMINA_INSTANTIATE(double);
#undef LAMINA_INSTANTIATE

}  // namespace lamina::detail
