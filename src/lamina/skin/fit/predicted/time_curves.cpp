// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/predicted/time_curves.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/speed_of_light.h"
#include "lamina/solve/scattering/diffusion/pulsed_diffusion.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina::fit_detail {
namespace {

constexpr std::size_t curve_points = 160;
/// Photons are counted in rings of this part of their radius, if detectors are much narrower.
constexpr double ring_share = 0.2;
constexpr int photon_bins = 400, most_rings = 1000;

/// Least time of light at a radius [ps], by its fastest layer.
double least_time(const LayerStack& stack, double r) {
  double ior = std::numeric_limits<double>::infinity();
  for (const Layer& layer : stack.layers()) ior = std::min(ior, layer.medium.ior);
  return r * ior / speed_of_light;
}

double ring_width(double r, double width) {
  return width >= 0.5 * ring_share * r ? width : ring_share * r;
}

/// What is known of the polynomial before photons are traced, standard deviations. Late light of a
/// half-space is that of diffusion to a few percent; that of thin layers may be off by a third. The
/// boundary matters as 1 / scatterings, and early light is slower than diffusion has it by
/// scatterings times u³.
std::array<double, PhotonCorrection::terms> known_before(const LayerStack& stack, double r) {
  double depth = 1.0, scattering = sigma_s_prime(stack.layers()[0].medium);
  for (const Layer& layer : stack.layers()) {
    if (depth <= 0.0) break;
    scattering = sigma_s_prime(layer.medium);
    depth -= scattering * layer.thickness;
  }
  const double far = std::max(0.5, r * scattering);
  const bool is_half_space = stack.layers().size() == 1 && is_semi_infinite(stack);
  return {is_half_space ? 0.05 : 0.3, 3.0 / far + (is_half_space ? 0.0 : 0.5), 2.0, far, far, far};
}

/// Powers of least time over time.
std::array<double, PhotonCorrection::terms> powers(double u) {
  u = std::min(u, 1.0);
  std::array<double, PhotonCorrection::terms> power{1.0};
  for (std::size_t i = 1; i < power.size(); ++i) power[i] = power[i - 1] * u;
  return power;
}

/// Photons in bins of time, and the light of diffusion in them, in parts of the ring.
struct BinnedLight {
  struct Part {
    double diffusion;
    std::array<double, PhotonCorrection::terms> powers;
  };
  std::vector<double> photons;           ///< [bin]
  std::vector<std::vector<Part>> parts;  ///< [bin][part]
  double unit = 1.0;                     ///< what one photon counts
};

/// The likeliest polynomial of photons that come at random, by Newton's steps.
PhotonCorrection fit_polynomial(const BinnedLight& light,
                                const std::array<double, PhotonCorrection::terms>& known) {
  constexpr std::size_t n = PhotonCorrection::terms;
  PhotonCorrection found;
  DenseMatrix curvature(n, n);
  for (int step = 0; step < 30; ++step) {
    DenseMatrix slope(n, 1);
    curvature = DenseMatrix(n, n);
    for (std::size_t a = 0; a < n; ++a) {
      slope(a, 0) = -found.power[a] / (known[a] * known[a]);
      curvature(a, a) = 1.0 / (known[a] * known[a]);
    }
    for (std::size_t i = 0; i < light.photons.size(); ++i) {
      double expected = 0.0;
      std::array<double, n> by{};
      for (const BinnedLight::Part& part : light.parts[i]) {
        double log_factor = 0.0;
        for (std::size_t a = 0; a < n; ++a) log_factor += found.power[a] * part.powers[a];
        const double value = part.diffusion * std::exp(std::min(log_factor, 3.0));
        expected += value;
        for (std::size_t a = 0; a < n; ++a) by[a] += value * part.powers[a];
      }
      if (!(expected > 0.0)) continue;
      for (std::size_t a = 0; a < n; ++a) {
        slope(a, 0) += (light.photons[i] / expected - 1.0) / light.unit * by[a];
        for (std::size_t b = 0; b < n; ++b)
          curvature(a, b) += by[a] * by[b] / (expected * light.unit);
      }
    }
    const DenseMatrix change = solve_linear(curvature, slope);
    double largest = 0.0;
    for (std::size_t a = 0; a < n; ++a) largest = std::max(largest, std::abs(change(a, 0)));
    const double damping = std::min(1.0, 1.0 / std::max(largest, 1e-300));
    for (std::size_t a = 0; a < n; ++a) found.power[a] += damping * change(a, 0);
    if (largest < 1e-9) break;
  }
  DenseMatrix one(n, n);
  for (std::size_t a = 0; a < n; ++a) one(a, a) = 1.0;
  const DenseMatrix covariance = solve_linear(curvature, one);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = covariance(i, j);
      for (std::size_t k = 0; k < j; ++k) sum -= found.noise[i][k] * found.noise[j][k];
      found.noise[i][j] = i == j ? std::sqrt(std::max(sum, 0.0))
                                 : (found.noise[j][j] > 0.0 ? sum / found.noise[j][j] : 0.0);
    }
  return found;
}

}  // namespace

double TimeCurve::end() const {
  return first_time * std::exp(log_step * static_cast<double>(log_light.size() - 1));
}

double TimeCurve::at(double t) const {
  if (!(t >= first_time)) return 0.0;
  const double x = std::log(t / first_time) / log_step;
  const auto last = static_cast<double>(log_light.size() - 3);
  const double middle = std::clamp(std::floor(x), 1.0, last);
  const auto i = static_cast<std::size_t>(middle);
  const double u = x - middle;  // between i and i + 1: a cubic through four points
  const double a = log_light[i - 1], b = log_light[i], c = log_light[i + 1], d = log_light[i + 2];
  return std::exp(-u * (u - 1.0) * (u - 2.0) / 6.0 * a + (u * u - 1.0) * (u - 2.0) / 2.0 * b -
                  u * (u + 1.0) * (u - 2.0) / 2.0 * c + u * (u * u - 1.0) / 6.0 * d);
}

double PhotonCorrection::log_factor(double u) const {
  const auto by = powers(u);
  double sum = 0.0;
  for (std::size_t a = 0; a < terms; ++a) sum += power[a] * by[a];
  return std::clamp(sum, -5.0, 3.0);
}

double RingCurves::at(double t, const PhotonCorrection* correction) const {
  double sum = 0.0;
  for (const Part& part : parts) {
    const double light = part.curve.at(t);
    if (light > 0.0)
      sum += part.weight * light *
             (correction ? std::exp(correction->log_factor(part.least_time / t)) : 1.0);
  }
  return sum;
}

std::vector<RingCurves> diffusion_curves(const LayerStack& stack, std::span<const double> r,
                                         double width, double last_time) {
  const double half = 0.5 * width;
  std::vector<RingCurves> rings(r.size());
  std::vector<double> radii;
  for (std::size_t d = 0; d < r.size(); ++d) {
    const Quadrature rule =
        half > 0.0 ? gauss_legendre(4, r[d] - half, r[d] + half) : Quadrature{{r[d]}, {1.0}};
    double area = 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) area += rule.weights[i] * rule.nodes[i];
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      radii.push_back(rule.nodes[i]);
      rings[d].parts.push_back(
          {rule.weights[i] * rule.nodes[i] / area, least_time(stack, rule.nodes[i]), {}});
    }
  }
  const double nearest = least_time(stack, *std::ranges::min_element(radii));
  const double first = std::min(0.31 * nearest, 0.5 * last_time);
  const double step = std::log(last_time / first) / static_cast<double>(curve_points - 1);
  std::vector<double> times;
  for (std::size_t i = 0; i < curve_points; ++i)
    times.push_back(first * std::exp(step * static_cast<double>(i)));
  const auto light = pulsed_diffusion(stack, radii, times);
  std::size_t node = 0;
  for (RingCurves& ring : rings)
    for (RingCurves::Part& part : ring.parts) {
      part.curve = {first, step, {}};
      for (const double value : light[node]) part.curve.log_light.push_back(std::log(value));
      ++node;
    }
  return rings;
}

std::vector<double> light_in_rings(const LayerStack& stack, std::span<const double> r, double width,
                                   double last_time) {
  std::vector<double> light;
  const auto rings = diffusion_curves(stack, r, 0.0, last_time);
  for (std::size_t d = 0; d < r.size(); ++d) {
    const TimeCurve& curve = rings[d].parts[0].curve;
    double sum = 0.0;
    for (std::size_t j = 0; j < curve_points; ++j) {
      const double t = curve.first_time * std::exp(curve.log_step * static_cast<double>(j));
      sum += std::exp(curve.log_light[j]) * t * curve.log_step;
    }
    light.push_back(sum * 2.0 * std::numbers::pi * r[d] * ring_width(r[d], width));
  }
  return light;
}

double longest_time(const LayerStack& stack, double r) {
  return 1000.0 * std::max(least_time(stack, r), 10.0);
}

double time_of_almost_all(const LayerStack& stack, double r) {
  const TimeCurve curve =
      diffusion_curves(stack, {&r, 1}, 0.0, longest_time(stack, r))[0].parts[0].curve;
  std::vector<double> sums = {0.0};
  for (std::size_t j = 0; j < curve_points; ++j)
    sums.push_back(sums.back() +
                   std::exp(curve.log_light[j] + curve.log_step * static_cast<double>(j)));
  std::size_t j = 0;
  while (sums[j + 1] < 0.995 * sums.back()) ++j;
  return curve.first_time * std::exp(curve.log_step * static_cast<double>(j));
}

std::vector<PhotonCorrection> correct_by_photons(const LayerStack& stack, std::span<const double> r,
                                                 double width, double last_time, double photons,
                                                 const Progress& progress) {
  double most_events = 1e4;
  for (const Layer& layer : stack.layers())
    most_events = std::max(most_events, 1e4 + 4.0 * sigma_t(layer.medium) * speed_of_light /
                                                  layer.medium.ior * last_time);
  const double dt = last_time / (photon_bins - 1);  // the last bin takes what is later
  double dr = std::numeric_limits<double>::infinity(), farthest = 0.0;
  for (const double radius : r) {
    dr = std::min(dr, 0.25 * ring_width(radius, width));
    farthest = std::max(farthest, radius + 0.5 * ring_width(radius, width));
  }
  dr = std::max(dr, farthest / most_rings);
  MonteCarloOptions options{.photons = static_cast<std::uint64_t>(photons), .seed = 1};
  options.max_events = static_cast<std::uint32_t>(std::min(most_events, 4e9));
  options.tallies = {.r = {static_cast<int>(farthest / dr) + 2, dr}, .time = {photon_bins, dt}};
  options.progress = progress;
  const MonteCarloResult found = trace_photons(stack, options);
  if (found.was_stopped) throw Interrupted();

  std::vector<PhotonCorrection> corrections;
  for (const double radius : r) {
    // Whole rings, the nearest to those that were asked for.
    const double half = 0.5 * ring_width(radius, width);
    const auto first_ring = static_cast<std::size_t>(std::lround((radius - half) / dr));
    const auto last_ring =
        std::max(first_ring, static_cast<std::size_t>(std::lround((radius + half) / dr)) - 1);
    const double inner = dr * static_cast<double>(first_ring),
                 outer = dr * static_cast<double>(last_ring + 1);
    const double middle = 0.5 * (inner + outer);
    const auto mean_of = [&](const auto& light_of_ring) {
      double sum = 0.0;
      for (std::size_t ring = first_ring; ring <= last_ring; ++ring)
        sum += (2.0 * static_cast<double>(ring) + 1.0) * dr * dr * light_of_ring(ring);
      return sum / (outer * outer - inner * inner);
    };
    const RingCurves curves = diffusion_curves(stack, {&middle, 1}, outer - inner, last_time)[0];
    BinnedLight light;
    for (std::size_t bin = 0; bin + 1 < photon_bins; ++bin) {
      const double begin = dt * static_cast<double>(bin), time = begin + 0.5 * dt;
      if (begin < least_time(stack, inner)) continue;
      light.photons.push_back(mean_of([&](std::size_t ring) {
        return found.radial_time.reflection[ring * photon_bins + bin].value;
      }));
      auto& parts = light.parts.emplace_back();
      for (const auto& [weight, earliest, curve] : curves.parts)
        parts.push_back(
            {weight * (curve.at(begin) + 4.0 * curve.at(time) + curve.at(begin + dt)) / 6.0,
             powers(earliest / time)});
    }
    // What one photon of the mean weight adds to a bin.
    const double area = std::numbers::pi * (outer * outer - inner * inner);
    const double all =
        mean_of([&](std::size_t ring) { return found.radial.reflection[ring].value; });
    double variance = 0.0;
    for (std::size_t ring = first_ring; ring <= last_ring; ++ring)
      variance += std::pow((2.0 * static_cast<double>(ring) + 1.0) * std::numbers::pi * dr * dr *
                               found.radial.reflection[ring].standard_error / area,
                           2.0);
    light.unit = (all > 0.0 ? variance / all : 1.0 / (photons * area)) / dt;
    corrections.push_back(fit_polynomial(light, known_before(stack, middle)));
  }
  return corrections;
}

}  // namespace lamina::fit_detail
