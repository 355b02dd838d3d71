// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/oblique_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/low_orders/oblique_single_scattering.h"
#include "lamina/solve/scattering/low_orders/straight_ray.h"
#include "lamina/solve/scattering/profile/bessel.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_spectrum.h"
#include "lamina/solve/scattering/transport_profile/internal/transfer_profile_cost.h"
#include "lamina/solve/scattering/transport_profile/internal/transfer_profile_photons.h"

namespace lamina {
namespace {

using std::numbers::pi;

// test ObliqueProfile.AgreesWithMonteCarloRingByRing
constexpr int nodes = 8, fewer_nodes = 6, frequencies = 28;
constexpr double accuracy = 0.005;      ///< of moment 0; where waves do not reach it, photons help
constexpr double events_of_mean = 1.5;  ///< of photons: waves know less here than of normal beams
constexpr double most_change = 3.0;     ///< by photons, with which higher moments go along
constexpr int coarse_modes = 5, fine_modes = 7;
/// Where spectra are ended for a look at what their tails are worth. All of the change counts as
/// error, twice what it does in transfer_profile_band.cpp, as there are fewer frequencies:
/// test TransferProfileError.ThatOfAnObliqueBeamIsSmallToo.
constexpr double earlier_end = 0.7;
constexpr double step_to_come = 0.4, error_per_step = 0.4;  ///< as in transfer_profile.cpp
constexpr int azimuths = 20;      ///< over half a circle, at least, for light scattered once
constexpr double group = 3.0;     ///< ratio of radii that share frequencies
constexpr double last_kr = 80.0;  ///< at the least radius of a group, where the taper ends

/// One moment on one side as a function of k: odd ones fall with k, and become even without that.
struct MomentSpectrum {
  detail::Spectrum even;
  double corner = 0.0;  ///< [1/mm], 0 for even moments
  [[nodiscard]] double at(double k) const {
    return detail::evaluate(even, k) * (corner > 0.0 ? k / std::hypot(k, corner) : 1.0);
  }
};

MomentSpectrum moment_spectrum(const detail::FrequencyGrid& grid, std::vector<double> values,
                               bool is_odd) {
  const double corner = is_odd ? grid.scale : 0.0;
  if (is_odd)
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] *= std::hypot(grid.k[i], corner) / grid.k[i];
  return {detail::make_spectrum(grid, values), corner};
}

/// Inverse Hankel transforms of orders m = 0, 1, ... at all radii, [i][m]. Panels of a geometric
/// series up to the period of the Bessel functions, of that period from there on.
std::vector<double> transforms(const std::vector<MomentSpectrum>& spectra,
                               std::span<const double> r, double lowest_k) {
  static const Quadrature rule = gauss_legendre(8, 0.0, 1.0);
  const std::size_t count = spectra.size();
  std::vector<double> result(r.size() * count), bessel(count);
  for (std::size_t first = 0, last = 0; first < r.size(); first = last) {
    while (last < r.size() && r[last] <= group * r[first]) ++last;
    const double end = last_kr / r[first], period = 2.0 * pi / r[last - 1];
    std::vector<double> edges{0.0, std::min(0.1 * lowest_k, 0.1 * period)};
    while (edges.back() < end) edges.push_back(edges.back() + std::min(0.6 * edges.back(), period));
    for (std::size_t e = 0; e + 1 < edges.size(); ++e)
      for (std::size_t q = 0; q < rule.nodes.size(); ++q) {
        const double k = edges[e] + (edges[e + 1] - edges[e]) * rule.nodes[q];
        const double weight = rule.weights[q] * (edges[e + 1] - edges[e]) * k / (2.0 * pi) *
                              std::exp(-std::pow(k / (0.5 * end), 6.0));
        std::vector<double> values;
        for (const MomentSpectrum& spectrum : spectra) values.push_back(weight * spectrum.at(k));
        for (std::size_t i = first; i < last; ++i) {
          detail::bessel_functions(k * r[i], bessel);
          for (std::size_t m = 0; m < count; ++m) result[i * count + m] += values[m] * bessel[m];
        }
      }
  }
  return result;
}

struct HigherOrders {
  std::array<std::vector<double>, 2> moments;  ///< [side][i][m]
  /// [side][i] what changes of moment 0 where the tail of the spectrum begins earlier.
  std::array<std::vector<double>, 2> change_by_tail;
  double highest = 0.0;  ///< frequency [1/mm]
};

/// What is not scattered once and straight, m up to the modes.
HigherOrders higher_orders(const LayerStack& stack, const GridDirection& beam, int node_count,
                           int modes, std::span<const double> r, const Progress& progress) {
  const auto solver = detail::make_frequency_solver(stack, node_count, modes, std::array{beam});
  const auto grid = detail::make_frequency_grid(solver.stack, frequencies);
  const auto count = static_cast<std::size_t>(modes) + 1;
  std::vector<std::vector<double>> values(2 * count, std::vector<double>(grid.k.size()));
  // Neighbours share the lanes of the processor.
  const auto lanes = detail::slabs_at_once();
  const auto respond = [&](std::size_t batch) {
    const std::size_t first = batch * lanes, here = std::min(lanes, grid.k.size() - first);
    const auto every = detail::oblique_responses(solver, std::span(grid.k).subspan(first, here));
    for (std::size_t i = first; i < first + here; ++i) {
      const auto& all = every[i - first];
      const auto once = detail::oblique_single_on_grid(solver, grid.k[i]);
      for (std::size_t m = 0; m < count; ++m) {
        const double factor = (m == 0 ? 1.0 : std::numbers::sqrt2) * (m % 2 == 0 ? 1.0 : -1.0);
        values[m][i] = factor * (all[m].reflectance - once[m].reflectance);
        values[count + m][i] = factor * (all[m].transmittance - once[m].transmittance);
      }
    }
  };
  parallel_for((grid.k.size() + lanes - 1) / lanes, respond, progress);
  HigherOrders result{.moments = {}, .change_by_tail = {}, .highest = grid.highest};
  for (auto& side : result.moments) side.resize(r.size() * count);
  for (auto& side : result.change_by_tail) side.resize(r.size());
  for (std::size_t side = 0; side < (is_semi_infinite(stack) ? 1u : 2u); ++side) {
    std::vector<MomentSpectrum> spectra;
    for (std::size_t m = 0; m < count; ++m)
      spectra.push_back(moment_spectrum(grid, values[side * count + m], m % 2 == 1));
    result.moments[side] = transforms(spectra, r, grid.scale);
    const auto earlier =
        transforms({{detail::ended_at(spectra[0].even, earlier_end)}}, r, grid.scale);
    for (std::size_t i = 0; i < r.size(); ++i)
      result.change_by_tail[side][i] = result.moments[side][i * count] - earlier[i];
  }
  return result;
}

/// Which extinction weakens light that is scattered once.
enum class Extinction { on_grid, by_medium };

/// Light scattered once and straight, [side][i][m].
std::array<std::vector<double>, 2> single_moments(const LayerStack& stack,
                                                  const GridDirection& beam, Extinction extinction,
                                                  std::span<const double> r, std::size_t count,
                                                  const Progress& progress) {
  auto on_grid = detail::make_frequency_solver(stack, nodes, 1, std::array{beam}).stack;
  if (extinction == Extinction::by_medium)
    for (detail::GridLayer& layer : on_grid.layers) layer.sigma_t = layer.extinction;
  const double p = beam.ior * beam.sin;
  // Where the beam meets the bottom the light grows without bound: on the way there azimuths crowd.
  const Quadrature rule = gauss_legendre(std::max(azimuths, 5 * static_cast<int>(count)), 0.0, 1.0);
  std::array<std::vector<double>, 2> sides;
  for (auto& side : sides) side.resize(r.size() * count);
  // In the ring of the grid that holds that place, the mean over the ring.
  const detail::Leg whole{&on_grid, on_grid.layers.size() - 1, true,
                          on_grid.layers.back().thickness};
  const double place = p < whole.widest() && !on_grid.is_semi_infinite ? whole.aside(p) : 0.0;
  const double half_step = r.size() > 1 ? std::sqrt(r[1] / r[0]) : 1.0;
  static const Quadrature part = gauss_legendre(6, 0.0, 1.0);
  const auto average = [&](std::size_t i) {
    const auto add_ring = [&](double radius, double share_of_ring) {
      for (std::size_t q = 0; q < rule.nodes.size(); ++q) {
        const double t = rule.nodes[q], phi = pi * t * t, share = 2.0 * t * rule.weights[q];
        const auto once = detail::oblique_single_profile(stack, on_grid, p, radius * std::cos(phi),
                                                         radius * std::sin(phi));
        for (std::size_t m = 0; m < count; ++m) {
          const double weight =
              (m == 0 ? 1.0 : 2.0) * share * share_of_ring * std::cos(static_cast<double>(m) * phi);
          sides[0][i * count + m] += weight * once.reflectance;
          sides[1][i * count + m] += weight * once.transmittance;
        }
      }
    };
    const double begin = r[i] / half_step, end = r[i] * half_step;
    if (!(begin < place && place < end)) return add_ring(r[i], 1.0);
    const double area = 0.5 * (end - begin) * (end + begin);
    for (const auto& [from, to] : {std::pair{begin, place}, std::pair{place, end}})
      for (std::size_t q = 0; q < part.nodes.size(); ++q) {
        const double radius = from + (to - from) * part.nodes[q];
        add_ring(radius, (to - from) * part.weights[q] * radius / area);
      }
  };
  parallel_for(r.size(), average, progress);
  return sides;
}

/// Relative errors of moment 0 from absolute ones. Changes ring: the largest nearby counts.
void add_estimates(ObliqueProfile& profile, std::size_t side, std::size_t band,
                   const std::vector<double>& left, const std::vector<double>& mean) {
  constexpr double nearby = 1.2, least_ring = 1e-4, r_lowest = 0.01, r_highest = 6.0;
  if (std::ranges::all_of(mean, [](double value) { return value == 0.0; })) return;  // no light
  const std::vector<double>& r = profile.r;
  std::vector<double>& error = side == 0 ? profile.estimated_error : profile.transmittance_error;
  double fullest = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) fullest = std::max(fullest, r[i] * r[i] * mean[i]);
  for (std::size_t i = 0; i < r.size(); ++i) {
    double most = 0.0;
    for (std::size_t j = 0; j < r.size() && r[j] <= nearby * r[i]; ++j) {
      if (r[j] * nearby < r[i]) continue;
      const double value = std::max(mean[i], mean[j]);
      const bool is_known = value > 0.0 && mean[j] >= 0.0 && std::isfinite(left[j]);
      most = std::max(most, is_known ? left[j] / value : std::numeric_limits<double>::infinity());
    }
    error[i * profile.bands + band] = std::min(1.0, most);
    const bool counts = r_lowest <= r[i] && r[i] <= r_highest &&
                        !(r[i] * r[i] * std::abs(mean[i]) <= least_ring * fullest);
    if (counts) profile.largest_error[band] = std::max(profile.largest_error[band], most);
  }
}

std::vector<double>& moments_of(ObliqueProfile& profile, std::size_t side) {
  return side == 0 ? profile.reflectance_moments : profile.transmittance_moments;
}

std::vector<double> detail::ProfileCurves::*curve_of(std::size_t side) {
  return side == 0 ? &detail::ProfileCurves::reflectance : &detail::ProfileCurves::transmittance;
}

void set_estimates(ObliqueProfile& profile, std::size_t band, const detail::ProfileCurves& mean,
                   const detail::ProfileCurves& left) {
  profile.largest_error[band] = profile.mean_error[band] = 0.0;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto curve = curve_of(side);
    add_estimates(profile, side, band, left.*curve, mean.*curve);
    double wrong = 0.0, all = 0.0;
    for (std::size_t i = 0; i < profile.r.size(); ++i) {
      const double area = profile.r[i] * profile.r[i], value = (mean.*curve)[i];
      wrong += area * ((left.*curve)[i] + std::max(0.0, -value));
      all += area * std::max(0.0, value);
    }
    if (wrong > 0.0)
      profile.mean_error[band] =
          std::max(profile.mean_error[band],
                   all > 0.0 ? wrong / all : std::numeric_limits<double>::infinity());
  }
}

/// Nearer to the surface the sine keeps no digits of the cosine. The way below hardly changes any
/// more there, but what enters does: test ObliqueProfile.GrazingLightGoesWithWhatEnters.
constexpr double least_cos = 1e-4;

/// What enters of a beam over what enters of one that is not nearer to the surface than that.
double share_of_entering(const LayerStack& stack, double theta, double nearest) {
  const double eta = stack.layers()[0].medium.ior / stack.ior_above();
  const double entering = 1.0 - fresnel(std::cos(nearest), eta);
  return entering > 0.0 ? (1.0 - fresnel(std::cos(theta), eta)) / entering : 1.0;
}

void check(std::span<const LayerStack> stacks, double theta, int moments) {
  if (!(theta >= 0.0 && theta < 0.5 * pi))
    throw InvalidInput("incidence: must lie in [0, 90) degrees, but is " +
                       number_text(theta * 180.0 / pi));
  if (moments < 1 || moments > 32)
    throw InvalidInput("moments: must lie in [1, 32], but are " + std::to_string(moments));
  for (std::size_t b = 0; b < stacks.size(); ++b) {
    const std::string band = "band " + std::to_string(b);
    detail::require_smooth(stacks[b], "the profile by radiative transfer of " + band);
    if (std::ranges::none_of(stacks[b].layers(),
                             [](const Layer& l) { return l.medium.sigma_s > 0.0; }))
      throw InvalidInput(band + ": at least one layer must scatter, but none does");
  }
  detail::require_affordable(detail::solution_cost(stacks, nodes, fine_modes, frequencies));
}

}  // namespace

ObliqueProfile oblique_profile(std::span<const LayerStack> stacks, double theta,
                               const RadialGrid& grid, int moments, const Progress& progress) {
  check(stacks, theta, moments);
  const std::size_t bands = stacks.size(), count = static_cast<std::size_t>(moments);
  ObliqueProfile profile{.bands = bands, .moments = count, .r = radii(grid)};
  const std::size_t size = profile.r.size();
  const HankelPlan plan = make_hankel_plan(grid);
  profile.reflectance_moments.resize(size * count * bands);
  profile.transmittance_moments.resize(size * count * bands);
  profile.estimated_error.resize(size * bands);
  profile.transmittance_error.resize(size * bands);
  profile.largest_error.resize(bands);
  profile.mean_error.resize(bands);
  for (const auto& totals :
       adding_doubling(stacks, {.theta = theta}, {.accuracy = 1e-6, .progress = progress})) {
    profile.total_reflectance.push_back(totals.totals.diffuse_reflectance);
    profile.total_transmittance.push_back(totals.totals.transmittance);
  }
  const double traced = std::min(theta, std::acos(least_cos));
  const auto scale_to_beam = [&](std::size_t b) {
    const double share = share_of_entering(stacks[b], theta, traced);
    for (std::size_t side = 0; side < 2 && traced < theta; ++side)
      for (std::size_t i = b; i < size * count * bands; i += bands)
        moments_of(profile, side)[i] *= share;
  };
  for (std::size_t b = 0; b < bands; ++b) {
    const GridDirection beam = direction_in(stacks[b].ior_above(), traced);
    const auto part = [&](double begin, double end) {  // of this band
      return part_of(progress, (static_cast<double>(b) + begin) / static_cast<double>(bands),
                     (static_cast<double>(b) + end) / static_cast<double>(bands));
    };
    const auto once =
        single_moments(stacks[b], beam, Extinction::on_grid, profile.r, count, part(0.0, 0.2));
    const auto by_fewer =
        higher_orders(stacks[b], beam, fewer_nodes, coarse_modes, profile.r, part(0.2, 0.3));
    const auto coarse =
        higher_orders(stacks[b], beam, nodes, coarse_modes, profile.r, part(0.3, 0.5));
    const auto fine = higher_orders(stacks[b], beam, nodes, fine_modes, profile.r, part(0.5, 1.0));
    constexpr std::size_t few = coarse_modes + 1, many = fine_modes + 1;
    const std::vector<double> none(size, 0.0);
    detail::WaveProfile mean{
        {none, none}, {none, none}, {3, {none, none}}, fine.highest};  // moment 0
    for (std::size_t side = 0; side < 2; ++side) {
      std::vector<double>& values = moments_of(profile, side);
      const auto curve = curve_of(side);
      for (std::size_t i = 0; i < size; ++i) {
        const auto step = [&](std::size_t m) {
          return fine.moments[side][i * many + m] - coarse.moments[side][i * few + m];
        };
        for (std::size_t m = 0; m < count; ++m) {
          double value = once[side][i * count + m];
          if (m < many) value += fine.moments[side][i * many + m];
          if (m < few) value += step_to_come * step(m);
          values[(i * count + m) * bands + b] = value;
        }
        (mean.profile.*curve)[i] = values[i * count * bands + b];
        const double changes[] = {error_per_step * step(0),
                                  coarse.moments[side][i * few] - by_fewer.moments[side][i * few],
                                  fine.change_by_tail[side][i]};
        for (std::size_t c = 0; c < 3; ++c) {
          (mean.changes[c].*curve)[i] = changes[c];
          (mean.error.*curve)[i] += std::abs(changes[c]);
        }
      }
    }
    set_estimates(profile, b, mean.profile, mean.error);
    if (profile.largest_error[b] <= accuracy) {
      scale_to_beam(b);
      continue;
    }
    const auto of_medium =
        single_moments(stacks[b], beam, Extinction::by_medium, profile.r, count, part(1.0, 1.0));
    const bool is_black = stacks[b].ground().reflectance == 0.0;
    detail::LowestOrders known{
        .curves = {none, none},
        .above = {.unscattered = KnownLight::all, .once = 0},
        .below = {.unscattered = KnownLight::all, .once = is_black ? 0 : KnownLight::none}};
    for (std::size_t side = 0; side < 2; ++side)
      for (std::size_t i = 0; i < size; ++i)
        (known.curves.*curve_of(side))[i] = of_medium[side][i * count];
    const auto refined = detail::refine_by_photons(
        stacks[b], {.theta = traced}, plan, mean, known,
        events_of_mean * detail::events_for(stacks[b], accuracy), part(1.0, 1.0));
    // What of higher moments is not scattered once keeps its ratio to the mean.
    for (std::size_t side = 0; side < 2; ++side)
      for (std::size_t i = 0; i < size; ++i) {
        const double* const was = &once[side][i * count];
        const double* const is = &of_medium[side][i * count];
        const double before = (mean.profile.*curve_of(side))[i] - was[0];
        const double after = (refined.profile.*curve_of(side))[i] - is[0];
        double* const of_radius = &moments_of(profile, side)[i * count * bands + b];
        of_radius[0] = after + is[0];
        const bool is_alike = before > 0.0 && after > 0.0 && after < most_change * before;
        for (std::size_t m = 1; m < count; ++m)
          of_radius[m * bands] =
              is[m] + (of_radius[m * bands] - was[m]) * (is_alike ? after / before : 1.0);
      }
    set_estimates(profile, b, refined.profile, refined.error);
    scale_to_beam(b);
  }
  return profile;
}

double reflectance_at(const ObliqueProfile& profile, std::size_t i, double phi, std::size_t band) {
  double sum = 0.0;
  for (std::size_t m = 0; m < profile.moments; ++m)
    sum += profile.reflectance_moments[(i * profile.moments + m) * profile.bands + band] *
           std::cos(static_cast<double>(m) * phi);
  return sum;
}

}  // namespace lamina
