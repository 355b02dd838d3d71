// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/predicted/timed_prediction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "lamina/skin/fit/measured/decoded_timed_series.h"

namespace lamina::fit_detail {
namespace {

constexpr double fewest_pulse_photons = 1e5;
/// Later ones would move by noise alone.
constexpr int most_traces = 3;
/// Layers that change by less keep the correction of photons.
constexpr double kept_change = 0.005;
/// Fewer steps of an octave of time would show in phases, of modulated light.
constexpr int steps_of_curve = 800;

bool is_near(double a, double b) {
  return a == b || std::abs(a - b) <= kept_change * std::max(std::abs(a), std::abs(b));
}

bool are_near(const LayerStack& a, const LayerStack& b) {
  if (a.layers().size() != b.layers().size()) return false;
  for (std::size_t k = 0; k < a.layers().size(); ++k) {
    const Layer &x = a.layers()[k], &y = b.layers()[k];
    if (!is_near(x.medium.sigma_a, y.medium.sigma_a) ||
        !is_near(x.medium.sigma_s, y.medium.sigma_s) ||
        !is_near(1.0 - x.medium.g, 1.0 - y.medium.g) || !is_near(x.medium.ior, y.medium.ior) ||
        !is_near(x.thickness, y.thickness) || !is_near(x.top.roughness, y.top.roughness))
      return false;
  }
  return is_near(a.ground().reflectance, b.ground().reflectance);
}

/// Amplitude and phase of what leaves over time, by its Fourier integral.
struct Wave {
  double amplitude, phase;  ///< [1/mm²], [degrees]
};

template <class Light>
Wave wave_of(const TimeCurve& curve, double frequency, const Light& light) {
  const double omega = 2e-6 * std::numbers::pi * frequency;  // MHz times ps
  const double step = std::log(curve.end() / curve.first_time) / steps_of_curve;
  double c = 0.0, s = 0.0;
  for (int i = 0; i <= steps_of_curve; ++i) {
    const double t = curve.first_time * std::exp(step * i);
    const double simpson = i == 0 || i == steps_of_curve ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    const double part = simpson * step / 3.0 * t * light(t);
    c += part * std::cos(omega * t);
    s += part * std::sin(omega * t);
  }
  return {std::hypot(c, s), std::atan2(s, c) * 180.0 / std::numbers::pi};
}

}  // namespace

TimedPrediction::TimedPrediction(const MeasuredSeries& series, std::vector<MeasuredPoint> points,
                                 std::vector<bool> is_logarithmic)
    : series_(series), points_(std::move(points)), is_logarithmic_(std::move(is_logarithmic)) {
  std::set<double> radii;
  for (const MeasuredPoint& point : points_) radii.insert(point.r);
  radii_.assign(radii.begin(), radii.end());
  at_radius_.resize(radii_.size());
  for (std::size_t p = 0; p < points_.size(); ++p)
    at_radius_[static_cast<std::size_t>(std::ranges::lower_bound(radii_, points_[p].r) -
                                        radii_.begin())]
        .push_back(p);
}

std::size_t TimedPrediction::unknown_factors() const {
  MeasuredSeries band = series_;
  band.points = points_;
  return count_unknown_factors(band);
}

double TimedPrediction::last_time(const LayerStack& stack) const {
  if (series_.kind == MeasurementKind::frequency_modulated)
    return longest_time(stack, radii_.back());
  double last = 1.0;
  double earliest = 0.0;
  for (const DelayedPart& part : series_.instrument) earliest = std::min(earliest, part.delay);
  for (const MeasuredPoint& point : points_) last = std::max(last, point.at - earliest);
  return 1.01 * last;
}

std::vector<double> TimedPrediction::predict(const LayerStack& stack) const {
  return rows_of(diffusion_curves(stack, radii_, series_.detector_width, last_time(stack)),
                 corrections_);
}

std::vector<double> TimedPrediction::rows_of(const std::vector<RingCurves>& curves,
                                             std::span<const PhotonCorrection> corrections) const {
  std::vector<double> rows(points_.size());
  for (std::size_t d = 0; d < radii_.size(); ++d) {
    const PhotonCorrection* correction = corrections.empty() ? nullptr : &corrections[d];
    const auto light = [&](double t) { return curves[d].at(t, correction); };
    double frequency = -1.0;
    Wave wave{};
    for (const std::size_t p : at_radius_[d]) {
      const MeasuredPoint& point = points_[p];
      if (series_.kind == MeasurementKind::time_resolved) {
        for (const DelayedPart& part : series_.instrument)
          rows[p] += part.weight * light(point.at - part.delay);
      } else {
        if (point.at != frequency) wave = wave_of(curves[d].parts[0].curve, point.at, light);
        frequency = point.at;
        // Lags are known but for whole turns: the one nearest to what was measured.
        rows[p] = point.quantity == MeasuredQuantity::phase
                      ? wave.phase + 360.0 * std::round((point.value - wave.phase) / 360.0)
                      : wave.amplitude;
      }
      if (is_logarithmic_[p]) rows[p] = std::log(std::max(rows[p], 1e-300));
    }
    if (series_.is_relative && series_.kind == MeasurementKind::time_resolved)
      scale(rows, at_radius_[d]);
  }
  if (series_.is_relative && series_.kind == MeasurementKind::frequency_modulated) {
    std::vector<std::size_t> amplitudes;
    for (std::size_t p = 0; p < points_.size(); ++p)
      if (points_[p].quantity == MeasuredQuantity::amplitude) amplitudes.push_back(p);
    scale(rows, amplitudes);
  }
  return rows;
}

void TimedPrediction::scale(std::vector<double>& rows,
                            std::span<const std::size_t> of_curve) const {
  double sum = 0.0, weights = 0.0;
  for (const std::size_t p : of_curve) {
    if (!is_logarithmic_[p]) continue;
    const double weight = std::pow(points_[p].value / points_[p].standard_deviation, 2.0);
    sum += weight * (std::log(points_[p].value) - rows[p]);
    weights += weight;
  }
  if (!(weights > 0.0)) return;
  for (const std::size_t p : of_curve)
    rows[p] = is_logarithmic_[p] ? rows[p] + sum / weights : rows[p] * std::exp(sum / weights);
}

void TimedPrediction::correct(const LayerStack& stack, const Progress& progress) {
  if (traces_ == most_traces || (traced_ && are_near(*traced_, stack))) return;
  ++traces_;
  double last = 0.0;
  for (const double r : radii_) last = std::max(last, 2.0 * time_of_almost_all(stack, r));
  last = std::min(last, last_time(stack));
  // As many as leave a tenth of the error of each curve as a whole, if that is not too many.
  const std::vector<double> light = light_in_rings(stack, radii_, series_.detector_width, last);
  photons_ = fewest_pulse_photons;
  for (std::size_t d = 0; d < radii_.size(); ++d) {
    double information = 0.0;
    for (const std::size_t p : at_radius_[d])
      information += is_logarithmic_[p]
                         ? std::pow(points_[p].value / points_[p].standard_deviation, 2.0)
                         : 1.0;
    photons_ = std::max(photons_,
                        std::min(series_.photons, 100.0 * information / std::max(light[d], 1e-12)));
  }
  photons_ = std::round(std::min(photons_, series_.photons));
  corrections_ =
      correct_by_photons(stack, radii_, series_.detector_width, last, photons_, progress);
  traced_ = stack;
}

DenseMatrix TimedPrediction::noise(const LayerStack& stack) const {
  constexpr std::size_t terms = PhotonCorrection::terms;
  DenseMatrix columns(points_.size(), corrections_.size() * terms);
  const auto curves = diffusion_curves(stack, radii_, series_.detector_width, last_time(stack));
  const std::vector<double> here = rows_of(curves, corrections_);
  constexpr double step = 0.1;  // of standard deviations: noise is small, and then linear
  for (std::size_t d = 0; d < corrections_.size(); ++d)
    for (std::size_t j = 0; j < terms; ++j) {
      std::vector<PhotonCorrection> moved = corrections_;
      for (std::size_t i = 0; i < terms; ++i)
        moved[d].power[i] += step * corrections_[d].noise[i][j];
      const std::vector<double> there = rows_of(curves, moved);
      for (std::size_t p = 0; p < points_.size(); ++p)
        columns(p, d * terms + j) = (there[p] - here[p]) / step;
    }
  return columns;
}

}  // namespace lamina::fit_detail
