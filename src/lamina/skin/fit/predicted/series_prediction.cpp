// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/predicted/series_prediction.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "lamina/base/core/quadrature.h"
#include "lamina/skin/fit/predicted/sphere_totals.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/adding_doubling_derivatives.h"
#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_derivatives.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina::fit_detail {
namespace {

constexpr int quick_nodes = 8;
/// Of waves, whose time goes with the cube of their product. Derivatives are right to .3 % in skin
/// and other thick layers at k up to three times the reduced scattering, to 1 % in thin layers that
/// scatter sharply forward (3 % at such k).
constexpr int quick_wave_nodes = 6, quick_wave_modes = 4;

double total_of(const AddingDoublingTotals& found, const MeasuredSeries& series,
                MeasuredQuantity quantity) {
  switch (quantity) {
    case MeasuredQuantity::transmittance:
      return found.totals.transmittance;
    case MeasuredQuantity::unscattered_transmittance:
      return found.unscattered_transmittance;
    case MeasuredQuantity::reflectance:
    case MeasuredQuantity::amplitude:
    case MeasuredQuantity::phase:
      break;
  }
  return found.totals.diffuse_reflectance +
         (series.has_specular ? found.totals.specular_reflectance : 0.0);
}

const std::vector<LayerDerivatives>& derivatives_of(const AddingDoublingDerivatives& found,
                                                    MeasuredQuantity quantity) {
  switch (quantity) {
    case MeasuredQuantity::transmittance:
      return found.transmittance;
    case MeasuredQuantity::unscattered_transmittance:
      return found.unscattered_transmittance;
    case MeasuredQuantity::reflectance:
    case MeasuredQuantity::amplitude:
    case MeasuredQuantity::phase:
      break;
  }
  return found.diffuse_reflectance;
}

/// Totals, with derivatives where the solver gives them.
/// @param solve  totals of a stack under an incidence, as AddingDoublingDerivatives
template <class Solve>
SeriesPrediction predict_totals(const LayerStack& stack, const MeasuredSeries& series,
                                std::span<const MeasuredPoint> points, const LostTotals& lost,
                                const Solve& solve) {
  const AddingDoublingDerivatives found = solve(stack, series.incidence);
  std::optional<AddingDoublingDerivatives> above, below;  // of diffuse light
  SeriesPrediction prediction;
  for (const MeasuredPoint& point : points) {
    if (!point.sphere) {
      prediction.values.push_back(total_of(found.totals, series, point.quantity));
      prediction.derivatives.push_back(derivatives_of(found, point.quantity));
      continue;
    }
    const bool is_behind = point.quantity == MeasuredQuantity::transmittance;
    auto& diffuse = is_behind ? below : above;
    if (!diffuse)
      diffuse = solve(is_behind ? lit_from_below({&stack, 1})[0] : stack, {.is_diffuse = true});
    SphereTotal total = sphere_total(point, series.has_specular, found, *diffuse, lost);
    prediction.values.push_back(total.value);
    prediction.derivatives.push_back(std::move(total.derivatives));
  }
  return prediction;
}

SeriesPrediction quick_totals(const LayerStack& stack, const MeasuredSeries& series,
                              std::span<const MeasuredPoint> points, bool with_derivatives) {
  return predict_totals(
      stack, series, points, {}, [&](const LayerStack& solved, const Incidence& incidence) {
        if (with_derivatives)
          return adding_doubling_derivatives_on_grid(solved, incidence, quick_nodes);
        return AddingDoublingDerivatives{
            .totals = adding_doubling_on_grid(solved, incidence, quick_nodes)};
      });
}

Illumination illumination_of(const MeasuredSeries& series) {
  return series.incidence.is_diffuse ? Illumination::diffuse : Illumination::normal_beam;
}

SeriesPrediction quick_responses(const LayerStack& stack, const MeasuredSeries& series,
                                 std::span<const MeasuredPoint> points, bool with_derivatives) {
  const Illumination illumination = illumination_of(series);
  detail::FrequencySolver solver =
      detail::make_frequency_solver(stack, quick_wave_nodes, quick_wave_modes);
  SeriesPrediction prediction;
  const auto add = [&](const detail::FrequencyResponse& response, MeasuredQuantity quantity) {
    prediction.values.push_back(quantity == MeasuredQuantity::reflectance ? response.reflectance
                                                                          : response.transmittance);
  };
  if (with_derivatives) {
    const detail::DifferentiatedSolver differentiated =
        detail::differentiate_solver(stack, std::move(solver));
    for (const MeasuredPoint& point : points) {
      auto found = detail::response_derivatives(differentiated, illumination, point.at);
      add(found.response, point.quantity);
      prediction.derivatives.push_back(point.quantity == MeasuredQuantity::reflectance
                                           ? std::move(found.reflectance)
                                           : std::move(found.transmittance));
    }
    return prediction;
  }
  std::vector<double> k;
  for (const MeasuredPoint& point : points) k.push_back(point.at);
  const auto found = illumination == Illumination::diffuse ? detail::diffuse_responses(solver, k)
                                                           : detail::responses(solver, k);
  for (std::size_t i = 0; i < points.size(); ++i) add(found[i], points[i].quantity);
  return prediction;
}

/// The mean over the ring that a detector sees, of a profile of one band.
std::vector<double> seen(const Profile& profile, const MeasuredSeries& series,
                         std::span<const MeasuredPoint> points) {
  const double half = 0.5 * series.detector_width;
  std::vector<double> values;
  for (const MeasuredPoint& point : points) {
    double sum = 0.0, area = 0.0;
    const Quadrature rule = half > 0.0 ? gauss_legendre(8, point.at - half, point.at + half)
                                       : Quadrature{{point.at}, {1.0}};
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double weight = rule.weights[i] * rule.nodes[i];
      sum += weight * reflectance_profile(profile, rule.nodes[i], 0);
      area += weight;
    }
    values.push_back(sum / area);
  }
  return values;
}

/// From the nearest edge of a detector to the farthest one [mm].
std::pair<double, double> radii_seen(const MeasuredSeries& series,
                                     std::span<const MeasuredPoint> points) {
  const auto [first, last] = std::ranges::minmax(points, {}, &MeasuredPoint::at);
  const double half = 0.5 * series.detector_width;
  return {std::max(first.at - half, 1e-3), last.at + half};
}

double smallest_relative_error(std::span<const MeasuredPoint> points) {
  double least = 1.0;
  for (const MeasuredPoint& point : points)
    if (point.value > 0.0) least = std::min(least, point.standard_deviation / point.value);
  return least;
}

}  // namespace

bool has_derivatives(const LayerStack& stack, const MeasuredSeries& series) {
  const bool is_endless = is_semi_infinite(stack) && stack.layers().back().medium.sigma_a == 0.0;
  const bool is_total =
      series.kind == MeasurementKind::totals || series.kind == MeasurementKind::spatial_frequency;
  return is_total && is_smooth(stack) && !is_endless;
}

bool corrects_derivatives(const MeasuredSeries& series) {
  return series.kind == MeasurementKind::radial_profile || series.beam_diameter.has_value();
}

SeriesPrediction predict_quickly(const LayerStack& stack, const MeasuredSeries& series,
                                 std::span<const MeasuredPoint> points, bool with_derivatives) {
  switch (series.kind) {
    case MeasurementKind::spatial_frequency:
      return quick_responses(stack, series, points, with_derivatives);
    case MeasurementKind::radial_profile:
      return {seen(make_diffusion_profile({&stack, 1}).profile, series, points), {}};
    case MeasurementKind::time_resolved:
    case MeasurementKind::frequency_modulated:  // TimedPrediction's
    case MeasurementKind::totals:
      break;
  }
  return quick_totals(stack, series, points, with_derivatives);
}

std::vector<double> predict_accurately(const LayerStack& stack, const MeasuredSeries& series,
                                       std::span<const MeasuredPoint> points) {
  if (series.kind == MeasurementKind::totals) {
    double least = 1.0;
    for (const MeasuredPoint& point : points) least = std::min(least, point.standard_deviation);
    const AddingDoublingOptions options{.accuracy = std::clamp(0.1 * least, 1e-9, 1e-5)};
    return predict_totals(stack, series, points, lost_totals(stack, series, points),
                          [&](const LayerStack& solved, const Incidence& incidence) {
                            return AddingDoublingDerivatives{
                                .totals = adding_doubling(solved, incidence, options)};
                          })
        .values;
  }
  const double wanted = 0.1 * smallest_relative_error(points);
  std::vector<double> values;
  TransferProfileOptions options{.accuracy = std::clamp(3.0 * wanted, 1e-3, 0.005),
                                 .illumination = illumination_of(series)};
  if (series.kind == MeasurementKind::spatial_frequency) {
    std::vector<double> k;
    for (const MeasuredPoint& point : points) k.push_back(point.at);
    const auto found = spatial_frequency_response({&stack, 1}, k, options);
    for (std::size_t i = 0; i < points.size(); ++i)
      values.push_back(points[i].quantity == MeasuredQuantity::reflectance
                           ? found.reflectance[i]
                           : found.transmittance[i]);
    return values;
  }
  std::tie(options.r_lowest, options.r_highest) = radii_seen(series, points);
  options.accuracy = std::clamp(wanted, 0.002, 0.01);
  return seen(transfer_profile({&stack, 1}, {}, options).profile, series, points);
}

}  // namespace lamina::fit_detail
