// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints docs/radiative_transfer_profiles.md's table of random stacks: profiles by radiative
// transfer, and the errors that they state, against photons in rings of equal width in log r.
//
//   profile_suite [COUNT [FIRST [EVENTS]]]    stacks FIRST .. FIRST + COUNT - 1, 0 and 200 if not
//                                             given; photons meet some EVENTS each, 3e8
//
// A stack has 1 to 4 layers, each with an index of 1 to 1.6, g of -.3 to .99, albedo of .01 to 1
// and an optical thickness of .05 to 1000, one in three a white ground; light falls on as a normal
// beam, at an angle, or from all sides, from above or from below. Stacks that reflect less than
// 1e-5 are drawn again, and of every other stack those that let less than that through. A ring
// counts where photons know it to 5 %; it is missed where the difference exceeds the error stated
// and 3.5 standard errors of the photons. The mean error weighs each ring by its flux. Where less
// than 1e-5 comes through, T is left out.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "lamina/solve/scattering/transport_profile/oblique_profile.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace {

using namespace lamina;
using std::numbers::pi;

constexpr int rings_per_decade = 20;
constexpr double least_light = 1e-5, best_known = 0.05, standard_errors = 3.5;

enum class Light { normal, oblique, diffuse };

struct Case {
  LayerStack stack;
  Light light = Light::normal;
  bool is_from_below = false;
  double theta = 0.0;
  double scale = 1.0;  ///< shortest mean free path or thickness [mm]
  double reflectance = 0.0, transmittance = 0.0;
};

Incidence incidence_of(const Case& of) {
  return {.is_diffuse = of.light == Light::diffuse, .theta = of.theta};
}

/// The stack as the light meets it.
LayerStack lit_stack(const Case& of) {
  return of.is_from_below ? lit_from_below(std::vector{of.stack})[0] : of.stack;
}

Case draw_case(Random& random) {
  const auto between = [&](double a, double b) { return a + (b - a) * random.uniform(); };
  const auto in_log = [&](double a, double b) { return a * std::pow(b / a, random.uniform()); };
  const int count = 1 + static_cast<int>(4.0 * random.uniform());
  std::vector<Layer> layers;
  double scale = 1e9;
  for (int l = 0; l < count; ++l) {
    const double thickness = in_log(0.03, 3.0), tau = in_log(0.05, 1000.0);
    const double albedo = random.uniform() < 0.5 ? 1.0 - in_log(1e-4, 0.99) : between(0.01, 1.0);
    const double sigma_t = tau / thickness;
    layers.push_back(
        {.medium = {.sigma_a = (1.0 - albedo) * sigma_t,
                    .sigma_s = albedo * sigma_t,
                    .g = random.uniform() < 0.5 ? between(-0.3, 0.7) : between(0.7, 0.99),
                    .ior = between(1.0, 1.6)},
         .thickness = thickness});
    scale = std::min({scale, thickness, 1.0 / sigma_t});
  }
  Case made{.stack = LayerStack(std::move(layers))};
  made.scale = scale;
  const double u = random.uniform();
  made.light = u < 0.6 ? Light::normal : (u < 0.8 ? Light::diffuse : Light::oblique);
  made.is_from_below = random.uniform() < 0.25;
  if (made.light == Light::oblique) made.theta = between(5.0, 75.0) * pi / 180.0;
  if (!made.is_from_below && random.uniform() < 1.0 / 3.0)
    made.stack = LayerStack({made.stack.layers().begin(), made.stack.layers().end()}, 1.0, 1.0,
                            {.reflectance = between(0.2, 1.0)});
  return made;
}

Case stack_of_suite(std::uint64_t index) {
  Random random = make_random(19, index);
  while (true) {
    Case made = draw_case(random);
    const AddingDoublingTotals totals =
        adding_doubling(std::vector{lit_stack(made)}, incidence_of(made), {.accuracy = 1e-3})[0];
    made.reflectance = totals.totals.diffuse_reflectance;
    made.transmittance = totals.totals.transmittance - totals.unscattered_transmittance;
    const bool is_for_transmittance = index % 2 == 1;
    if (made.reflectance >= least_light &&
        (!is_for_transmittance || made.transmittance >= least_light))
      return made;
  }
}

/// A profile of one side, over radii, and its error, relative.
struct Curve {
  std::vector<double> r, density, error;
};

/// Flux and largest error stated in a ring.
struct RingOf {
  double flux = 0.0, stated = 0.0;
};

/// The ring that begins at `begin`: two radii of the curve, each in the middle of its half, for
/// which it stands; in a steep tail the curve goes on as a power of r between radii.
RingOf ring_of(const Curve& curve, double begin, double end) {
  constexpr int parts = 4;
  constexpr double steep = 0.2, bent = 0.1;  // of log density from radius to radius
  RingOf ring;
  const double half = 0.5 * std::log(end / begin);
  const auto first = static_cast<std::size_t>(
      std::lround(std::log(begin * std::exp(0.5 * half) / curve.r[0]) / half));
  for (std::size_t i = first; i < first + 2 && i < curve.r.size(); ++i) {
    const double low = curve.r[i] * std::exp(-0.5 * half), here = curve.density[i];
    const double before = i > 0 ? curve.density[i - 1] : here;
    const double after = i + 1 < curve.r.size() ? curve.density[i + 1] : here;
    const double fall = std::log(before / here), next_fall = std::log(here / after);
    const bool is_tail = here > 0.0 && before > 0.0 && after > 0.0 &&
                         std::min(fall, next_fall) > steep && std::abs(fall - next_fall) < bent;
    double flux = 0.0;
    for (int q = 0; q < parts; ++q) {
      const double place = (q + 0.5) / parts, r = low * std::exp(place * half);
      const double ratio = !is_tail      ? 1.0
                           : place < 0.5 ? std::pow(before / here, 0.5 - place)
                                         : std::pow(after / here, place - 0.5);
      flux += r * r * ratio;
    }
    const double area = pi * low * low * std::expm1(2.0 * half);
    const double of_cell = is_tail ? 2.0 * pi * half / parts * flux * here : area * here;
    ring.flux += of_cell;
    ring.stated += std::abs(of_cell) * curve.error[i];
  }
  return ring;
}

struct Judgement {
  int bins = 0, missed = 0;
  double mean = 0.0, largest = 0.0;  ///< error, relative; the largest beyond the photons' noise
  double noise = 0.0;                ///< of the photons in the mean
  double worst_r = 0.0;
};

Judgement judge(const Curve& curve, const PhotonTallies& tallies,
                const std::vector<Estimate>& seen) {
  Judgement judgement;
  double all = 0.0;
  const double width =
      std::log(tallies.log_r.high / tallies.log_r.low) / static_cast<double>(tallies.log_r.count);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!(seen[i].standard_error <= best_known * seen[i].value)) continue;
    const double begin = tallies.log_r.low * std::exp(width * static_cast<double>(i));
    const double end = begin * std::exp(width);
    const double area = pi * begin * begin * std::expm1(2.0 * width);
    const double flux = area * seen[i].value, noise = area * seen[i].standard_error;
    const RingOf ring = ring_of(curve, begin, end);
    const double wrong = std::abs(ring.flux - flux);
    ++judgement.bins;
    judgement.missed += wrong > ring.stated + standard_errors * noise ? 1 : 0;
    judgement.mean += wrong;
    judgement.noise += 0.8 * noise;
    all += flux;
    const double beyond = std::max(0.0, wrong - 2.0 * noise) / flux;
    if (beyond > judgement.largest) {
      judgement.largest = beyond;
      judgement.worst_r = begin;
    }
  }
  if (all > 0.0) {
    judgement.mean /= all;
    judgement.noise /= all;
  }
  return judgement;
}

struct Solved {
  Curve above, below;
  std::uint64_t photons = 0;
  double stated = 0.0, seconds = 0.0;
};

double cpu_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

/// The rings that photons are counted in.
LogBins rings_of(const Case& of) {
  const double low = 0.01 * of.scale, high = 100.0;
  return {.count = static_cast<int>(std::ceil(rings_per_decade * std::log10(high / low))),
          .low = low,
          .high = high};
}

/// Two radii for each ring, and some nearer.
RadialGrid radii_of(const Case& of) {
  const LogBins rings = rings_of(of);
  const double half = 0.5 * std::log(rings.high / rings.low) / rings.count;
  constexpr int nearer = 12;
  return {.first = rings.low * std::exp((0.5 - nearer) * half),
          .last = rings.high * std::exp(-0.5 * half),
          .size = static_cast<std::size_t>(2 * rings.count + nearer)};
}

Solved solve(const Case& of) {
  const RadialGrid radii = radii_of(of);
  Solved solved;
  const double start = cpu_seconds();
  if (of.light == Light::oblique) {
    const ObliqueProfile profile = oblique_profile(std::vector{lit_stack(of)}, of.theta, radii, 1);
    solved.above = {profile.r, profile.reflectance_moments, profile.estimated_error};
    solved.below = {profile.r, profile.transmittance_moments, profile.transmittance_error};
    solved.stated = profile.largest_error[0];
  } else {
    const TransferProfile found =
        transfer_profile(std::vector{of.stack}, radii,
                         {.illumination = of.light == Light::diffuse ? Illumination::diffuse
                                                                     : Illumination::normal_beam,
                          .is_from_below = of.is_from_below});
    solved.above = {found.profile.r, found.profile.reflectance_profile, found.relative_error};
    solved.below = {found.profile.r, found.profile.transmittance_profile,
                    found.transmittance_error};
    solved.photons = found.photons[0];
    solved.stated = found.estimated_error[0];
  }
  solved.seconds = cpu_seconds() - start;
  return solved;
}

MonteCarloResult count(const Case& of, double events, PhotonTallies& tallies) {
  MonteCarloOptions options{.photons = 10'000, .seed = 77, .incidence = incidence_of(of)};
  tallies.log_r = rings_of(of);
  // What never scattered is in profiles of diffuse light alone.
  if (of.light != Light::diffuse)
    tallies.known_above = tallies.known_below = {.unscattered = KnownLight::all};
  options.tallies = tallies;
  const LayerStack stack = lit_stack(of);
  const PhotonCounts few = count_photons(stack, options);
  const double each = std::max(1.0, static_cast<double>(few.events) / 1e4);
  options.photons = static_cast<std::uint64_t>(std::clamp(events / each, 1e4, 1e8));
  options.seed = 78;
  return trace_photons(stack, options);
}

std::string describe(const Case& of) {
  std::string text;
  char part[96];
  for (const Layer& layer : of.stack.layers()) {
    const double t = sigma_t(layer.medium);
    std::snprintf(part, sizeof part, " [n %.2f tau %.3g g %.2f a %.3g d %.3g]", layer.medium.ior,
                  t * layer.thickness, layer.medium.g, albedo(layer.medium), layer.thickness);
    text += part;
  }
  if (of.stack.ground().reflectance > 0.0) {
    std::snprintf(part, sizeof part, " ground %.2f", of.stack.ground().reflectance);
    text += part;
  }
  return text;
}

const char* light_name(const Case& of) {
  switch (of.light) {
    case Light::normal:
      return of.is_from_below ? "normal, below" : "normal";
    case Light::oblique:
      return of.is_from_below ? "oblique, below" : "oblique";
    case Light::diffuse:
      return of.is_from_below ? "diffuse, below" : "diffuse";
  }
  return "";
}

}  // namespace

int main(int argc, char** argv) {
  const int stacks = argc > 1 ? std::atoi(argv[1]) : 200, first = argc > 2 ? std::atoi(argv[2]) : 0;
  const double events = argc > 3 ? std::atof(argv[3]) : 3e8;
  std::printf(
      "stack light | stated | CPU-s | photons | R: bins missed mean noise largest at | T: the "
      "same\n");
  for (int index = first; index < first + stacks; ++index) {
    const Case of = stack_of_suite(static_cast<std::uint64_t>(index));
    PhotonTallies tallies;
    try {
      const Solved solved = solve(of);
      const MonteCarloResult seen = count(of, events, tallies);
      const Judgement r = judge(solved.above, tallies, seen.log_radial.reflection);
      const Judgement t = of.transmittance >= least_light
                              ? judge(solved.below, tallies, seen.log_radial.transmission)
                              : Judgement{};
      std::printf("%d %s | %.3g | %.2f | %.1e", index, light_name(of), solved.stated,
                  solved.seconds, static_cast<double>(solved.photons));
      for (const Judgement& side : {r, t})
        std::printf(" | %d %d %.4f %.4f %.3f %.3g", side.bins, side.missed, side.mean, side.noise,
                    side.largest, side.worst_r);
    } catch (const Error& error) {
      std::printf("%d %s | refused: %s", index, light_name(of), error.what());
    }
    std::printf(" |%s\n", describe(of).c_str());
    std::fflush(stdout);
  }
  return 0;
}
