// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/transport_gradient.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/heterogeneous/internal/bounce_counter.h"
#include "lamina/solve/scattering/heterogeneous/internal/plane_paths.h"
#include "lamina/solve/scattering/heterogeneous/internal/transport_tape.h"

namespace lamina {
namespace {

using detail::Tape;
using detail::TapedPlane;

template <class T>
std::vector<T> numbers_of(const std::vector<float>& values) {
  return {values.begin(), values.end()};
}

template <class T>
std::array<MappedOperatorOf<T>, 4> operators_of(const std::array<MappedOperator, 4>& from) {
  std::array<MappedOperatorOf<T>, 4> result;
  for (std::size_t which = 0; which < 4; ++which)
    result[which] = {from[which].terms, numbers_of<T>(from[which].weights),
                     numbers_of<T>(from[which].totals)};
  return result;
}

template <class T>
TransportLayerOf<T> layer_of(const TransportLayer& from, int width, int height) {
  TransportLayerOf<T> layer{.basis = {.coordinate = make_plane<T>(width, height)},
                            .operators = operators_of<T>(from.operators),
                            .of_entry = {}};
  for (const TransportLayer::OfEntry& entry : from.of_entry)
    layer.of_entry.push_back({numbers_of<T>(entry.factor), operators_of<T>(entry.operators)});
  return layer;
}

/// Absorption as light on its way meets it (along_paths), with its steps.
template <class T>
TapedPlane taped_along_paths(Tape<T>& tape, TapedPlane sigma_a, double reduced_scattering,
                             const BlurPyramid& pyramid, double mm_per_texel) {
  const std::vector<T>& values = tape.plane(sigma_a).values;
  PathAbsorption<T> absorption(values, reduced_scattering);
  const auto for_neighbors = [&pyramid](const auto& take) {
    detail::for_plane_neighbors(pyramid.width, pyramid.height, take);
  };
  for_neighbors([&](std::size_t one, std::size_t other) { absorption.add_neighbors(one, other); });
  if (absorption.decay_length() == 0.0) return sigma_a;
  const double length = absorption.decay_length() / mm_per_texel;
  const TexelBasisOf<T> basis{.coordinate = make_plane<T>(pyramid.width, pyramid.height)};
  const auto operator_of = [](const std::vector<double>& weights) {
    return MappedOperatorOf<T>{
        .terms = 1, .weights = {weights.begin(), weights.end()}, .totals = {}};
  };
  const auto apply = [&pyramid, basis](const PlaneOf<T>& plane, const MappedOperatorOf<T>& blur) {
    return std::move(apply_operators(pyramid, plane, basis,
                                     std::array<const MappedOperatorOf<T>*, 1>{&blur})[0]);
  };
  const MappedOperatorOf<T> blur = operator_of(detail::path_scales(pyramid, length));
  PlaneOf<T> blurred = apply(tape.plane(sigma_a), blur);
  const auto [least, most] = std::ranges::minmax_element(values);
  std::vector<signed char> beyond(values.size(), 0);  // -1: below the least; 1: above the most
  for (std::size_t i = 0; i < values.size(); ++i) {
    T& value = blurred.values[i];
    if (value < *least) beyond[i] = -1;
    if (value > *most) beyond[i] = 1;
    value = std::clamp(value, *least, *most);
  }
  const auto least_at = static_cast<std::size_t>(least - values.begin());
  const auto most_at = static_cast<std::size_t>(most - values.begin());
  const TapedPlane out = tape.take(std::move(blurred));
  // The length follows the differences of neighbors: by its logarithm the blurred absorption
  // changes by `slope`, and that changes with each texel by `by_texel`.
  struct OfLength {
    std::vector<T> slope, by_texel;
  };
  OfLength made{
      apply(tape.plane(sigma_a), operator_of(detail::path_scale_slopes(pyramid, length))).values,
      std::vector<T>(values.size())};
  for (std::size_t i = 0; i < beyond.size(); ++i)
    if (beyond[i] != 0) made.slope[i] = T{};
  for_neighbors([&](std::size_t one, std::size_t other) {
    absorption.add_derivatives(one, other, 1.0, made.by_texel);
  });
  const auto of_length = std::make_shared<const OfLength>(std::move(made));
  const auto dot = [](const std::vector<T>& a, const std::vector<T>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  };
  const auto end_of = [least_at, most_at](signed char side) {
    return side < 0 ? least_at : most_at;
  };
  const auto add_times = [](std::vector<T>& sum, double factor, const std::vector<T>& more) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += static_cast<T>(factor) * more[i];
  };
  const auto back = [=, &tape, &pyramid] {
    PlaneOf<T> by_blurred = tape.derivative(out);
    if (by_blurred.values.empty()) return;
    std::vector<T>& by_sigma_a = tape.derivative_sum(sigma_a);
    add_times(by_sigma_a, dot(of_length->slope, by_blurred.values), of_length->by_texel);
    for (std::size_t i = 0; i < beyond.size(); ++i) {
      if (beyond[i] == 0) continue;
      by_sigma_a[end_of(beyond[i])] += by_blurred.values[i];
      by_blurred.values[i] = T{};
    }
    tape.add_derivative(sigma_a,
                        apply_transposed(pyramid, std::vector{by_blurred}, basis,
                                         std::array<const MappedOperatorOf<T>*, 1>{&blur}));
  };
  tape.record(back, [=, &tape] {
    const std::vector<T>& change = tape.derivative(sigma_a).values;
    if (change.empty()) return;
    PlaneOf<T> blurred_change = apply(tape.derivative(sigma_a), blur);
    for (std::size_t i = 0; i < beyond.size(); ++i)
      if (beyond[i] != 0) blurred_change.values[i] = change[end_of(beyond[i])];
    add_times(blurred_change.values, dot(of_length->by_texel, change), of_length->slope);
    tape.add_derivative(out, std::move(blurred_change));
  });
  return out;
}

/// absorption_coordinate, with its steps.
template <class T>
TapedPlane taped_coordinate(Tape<T>& tape, TapedPlane sigma_a, const AbsorptionRange& range) {
  const TapedPlane out = tape.take(absorption_coordinate(tape.plane(sigma_a), range));
  const T low = static_cast<T>(std::sqrt(range.lowest));
  const T width = static_cast<T>(std::sqrt(range.highest)) - low;
  tape.record_by_texel(sigma_a, out, [&tape, sigma_a, low, width](std::size_t i) {
    const T root = std::sqrt(tape.plane(sigma_a).values[i]);
    return low <= root && root <= low + width ? T(1) / (width * root) : T{};
  });
  return out;
}

/// What a crossing of a sheet leaves, with its steps.
template <class T>
TapedPlane taped_junction(Tape<T>& tape, TapedPlane absorbance) {
  PlaneOf<T> left = tape.plane(absorbance);
  for (T& value : left.values) value = std::exp(-value);
  const TapedPlane out = tape.take(std::move(left));
  tape.record_by_texel(absorbance, out,
                       [&tape, out](std::size_t i) { return -tape.plane(out).values[i]; });
  return out;
}

}  // namespace

template <class T>
struct DifferentiableTransport<T>::Model {
  BlurPyramid pyramid;
  double mm_per_texel;
  DifferentiableOptions options;
  std::vector<AbsorptionRange> ranges;      ///< [layer], of those that are maps
  std::vector<double> reduced_scattering;   ///< likewise [1/mm]
  std::vector<TransportLayerOf<T>> layers;  ///< a ground is the last
};

template <class T>
struct DifferentiableTransport<T>::Run {
  std::vector<TransportLayerOf<T>> layers;  ///< of these maps
  Tape<T> tape;
  std::unique_ptr<detail::TapedField<T>> field;
  std::vector<TapedPlane> sigma_a, absorbance;
  TapedPlane irradiance, reflected, transmitted;
};

template <class T>
DifferentiableTransport<T>::DifferentiableTransport(const StackTables& tables, int width,
                                                    int height,
                                                    std::span<const AbsorptionRange> ranges,
                                                    double mm_per_texel,
                                                    const DifferentiableOptions& options) {
  assert(ranges.size() == tables.layers.size());
  const double texel = mm_per_texel * mm_per_texel;
  Model model{.pyramid = make_blur_pyramid(width, height, widest_spread(tables.lattices) / texel),
              .mm_per_texel = mm_per_texel,
              .options = options,
              .ranges = {ranges.begin(), ranges.end()},
              .reduced_scattering = {},
              .layers = {}};
  std::vector<double> variances = tables.variances;
  for (double& v : variances) v /= texel;
  const std::vector<double> scales = scales_of_gaussians(model.pyramid, variances);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const StateLattice& lattice = tables.lattices[i];
    if (lattice.axes.size() != 1 || lattice.axes[0].direction[0] != 1.0)
      throw InvalidInput("layer " + std::to_string(i) +
                         ": derivatives are those of layers of which only absorption varies");
    model.reduced_scattering.push_back(
        reduced_scattering(uniform_texels(state_of(lattice.origin))));
    model.layers.push_back(layer_of<T>(
        make_absorption_layer(tables, i, ranges[i], scales, options.tolerance, options.profile),
        width, height));
  }
  if (tables.ground_reflectance > 0.0)
    model.layers.push_back(layer_of<T>(
        ground_layer(tables.ground_reflectance, width, height, scales.size()), width, height));
  check_layer_count(model.layers.size());
  model_ = std::make_unique<const Model>(std::move(model));
}

template <class T>
DifferentiableTransport<T>::~DifferentiableTransport() = default;

template <class T>
TransportLight<T> DifferentiableTransport<T>::light(const TransportMaps<T>& maps) {
  const Model& model = *model_;
  assert(maps.sigma_a.size() == model.ranges.size() &&
         maps.absorbance.size() + 1 == maps.sigma_a.size());
  const int width = model.pyramid.width, height = model.pyramid.height;
  run_ =
      std::make_unique<Run>(Run{model.layers, Tape<T>(width, height), nullptr, {}, {}, {}, {}, {}});
  Tape<T>& tape = run_->tape;
  std::vector<TapedPlane> coordinates(model.layers.size()), junctions;
  for (std::size_t i = 0; i < maps.sigma_a.size(); ++i) {
    run_->sigma_a.push_back(tape.take(maps.sigma_a[i]));
    const AbsorptionRange& range = model.ranges[i];
    if (range.lowest == range.highest) continue;
    const TapedPlane met =
        model.options.profile == ProfileAt::both
            ? taped_along_paths(tape, run_->sigma_a[i], model.reduced_scattering[i], model.pyramid,
                                model.mm_per_texel)
            : run_->sigma_a[i];
    coordinates[i] = taped_coordinate(tape, met, range);
    run_->layers[i].basis.coordinate = tape.plane(coordinates[i]);
  }
  for (const PlaneOf<T>& absorbance : maps.absorbance) {
    run_->absorbance.push_back(tape.take(absorbance));
    junctions.push_back(taped_junction(tape, run_->absorbance.back()));
  }
  if (model.layers.size() > maps.sigma_a.size())
    junctions.push_back(tape.take(make_plane<T>(width, height, T(1))));
  run_->irradiance = tape.take(maps.irradiance);
  run_->field = std::make_unique<detail::TapedField<T>>(
      tape, model.pyramid, run_->layers, std::move(coordinates), std::move(junctions));
  detail::BounceCounter counter(model.options.transport);
  const auto is_last = [&](TapedPlane down) {
    const std::vector<T>& values = tape.plane(down).values;
    return counter.is_last(std::accumulate(values.begin(), values.end(), 0.0));
  };
  const auto leaving = detail::sum_interlayer_bounces(
      *run_->field, run_->irradiance, model.options.transport.has_local_closure, is_last);
  run_->reflected = leaving.reflected;
  run_->transmitted = leaving.transmitted;
  return {tape.plane(run_->reflected), run_->transmitted.is_none() ? make_plane<T>(width, height)
                                                                   : tape.plane(run_->transmitted)};
}

template <class T>
TransportMaps<T> DifferentiableTransport<T>::gradient(const TransportLight<T>& by_light) {
  assert(run_);
  Tape<T>& tape = run_->tape;
  std::vector<typename Tape<T>::Derivative> by_results;
  if (!by_light.reflected.values.empty())
    by_results.push_back({run_->reflected, by_light.reflected});
  if (!by_light.transmitted.values.empty() && !run_->transmitted.is_none())
    by_results.push_back({run_->transmitted, by_light.transmitted});
  tape.go_back(std::move(by_results));
  const auto by = [&](TapedPlane at) {
    return PlaneOf<T>{model_->pyramid.width, model_->pyramid.height, tape.derivative_sum(at)};
  };
  TransportMaps<T> result{.sigma_a = {}, .absorbance = {}, .irradiance = by(run_->irradiance)};
  for (const TapedPlane map : run_->sigma_a) result.sigma_a.push_back(by(map));
  for (const TapedPlane map : run_->absorbance) result.absorbance.push_back(by(map));
  tape.forget_derivatives();
  return result;
}

template <class T>
TransportLight<T> DifferentiableTransport<T>::tangent(const TransportMaps<T>& change) {
  assert(run_);
  Tape<T>& tape = run_->tape;
  std::vector<typename Tape<T>::Derivative> changes;
  const auto add = [&](TapedPlane of, const PlaneOf<T>& by) {
    if (!by.values.empty()) changes.push_back({of, by});
  };
  for (std::size_t i = 0; i < change.sigma_a.size(); ++i) add(run_->sigma_a[i], change.sigma_a[i]);
  for (std::size_t i = 0; i < change.absorbance.size(); ++i)
    add(run_->absorbance[i], change.absorbance[i]);
  add(run_->irradiance, change.irradiance);
  tape.go_ahead(std::move(changes));
  const int width = model_->pyramid.width, height = model_->pyramid.height;
  const auto of = [&](TapedPlane at) {
    return at.is_none() ? make_plane<T>(width, height)
                        : PlaneOf<T>{width, height, tape.derivative_sum(at)};
  };
  TransportLight<T> result{of(run_->reflected), of(run_->transmitted)};
  tape.forget_derivatives();
  return result;
}

template class DifferentiableTransport<float>;
template class DifferentiableTransport<double>;

}  // namespace lamina
