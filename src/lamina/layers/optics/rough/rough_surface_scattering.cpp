// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/rough_surface_scattering.h"

#include <atomic>
#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/rough/gaussian_height_field.h"
#include "lamina/layers/optics/rough/internal/facet_walk.h"
#include "lamina/layers/optics/rough/internal/scattering_tally.h"

namespace lamina {
namespace {

using detail::ScatteringTally;

using std::numbers::pi;
constexpr int most_facets_of_photon = 10'000;

void check(const GaussianSurface& surface, double theta_i, ExitCells cells) {
  const auto require = [](bool holds, const std::string& rule, double given) {
    if (!holds) throw InvalidInput(rule + ", but is " + number_text(given));
  };
  require(0.01 <= surface.smoothness && surface.smoothness <= 1e4,
          "smoothness must lie in [0.01, 10000]", surface.smoothness);
  require(surface.eta > 0.0 && std::isfinite(surface.eta), "eta must be > 0 and finite",
          surface.eta);
  require(surface.eta != 1.0, "eta must differ from 1, where there is no surface to see",
          surface.eta);
  require(0.0 <= theta_i && theta_i < 0.5 * pi, "theta_i must lie in [0, pi/2) [rad]", theta_i);
  require(cells.thetas > 0 && cells.phis > 0, "the numbers of exit cells must be > 0",
          std::min(cells.thetas, cells.phis));
}

double lambda_of_ray(const GaussianSurface& surface, FacetVisibility visibility, const Vec3& ray) {
  const RoughInterface<double> interface = make_rough_interface(surface);
  if (visibility == FacetVisibility::smith)
    return detail::smith_lambda_of_ray(interface.facets, ray);
  // V(height) = (share of lower facets)^Lambda; at mean height 2^-Lambda, which is [XuSun2008] Eq.
  // 24 with k0 = ln 2 = .693 for .7.
  const double tan_theta = std::hypot(ray.x, ray.y) / std::max(std::abs(ray.z), 1e-12);
  if (tan_theta == 0.0) return 0.0;
  const double a = 0.5 * surface.smoothness / tan_theta;
  return tan_theta / surface.smoothness * std::exp(-a * a);
}

/// One ray of the paper's simulation.
void simulate_ray(const GaussianSurface& surface, const Vec3& wi, FacetVisibility visibility,
                  Random& random, ScatteringTally& tally) {
  const RoughInterface<double> interface = make_rough_interface(surface);
  const Microfacets<double>& facets = interface.facets;
  // The normal by the density of slopes, [XuSun2008] Eq. 8.
  const double slope = facets.alpha * std::sqrt(-std::log(1.0 - random.uniform()));
  const double phi = 2.0 * pi * random.uniform();
  Vec3 normal = normalize(Vec3{slope * std::cos(phi), slope * std::sin(phi), 1.0});

  detail::FacetWalk walk = {
      .direction = -wi, .u = std::max(random.uniform(), 1e-15), .eta = surface.eta};
  const double seen = std::pow(walk.u, lambda_of_ray(surface, visibility, walk.direction));
  const double weight = seen * std::max(0.0, dot(wi, normal)) / (normal.z * wi.z);  // Eq. 26
  tally.start(weight);
  if (weight == 0.0) return;

  scatter(walk, normal, random);
  int order = 1;
  while (meets_facet(walk, lambda_of_ray(surface, visibility, walk.direction), random)) {
    if (order == most_facets_of_photon) return tally.leave(walk.direction, 0, weight);
    const double u1 = random.uniform(), u2 = random.uniform();
    normal = sample_visible_normal(facets, -walk.direction, u1, u2);
    scatter(walk, normal, random);
    ++order;
  }
  tally.leave(detail::direction_outside(walk), order, weight);
}

std::int64_t share_of(std::int64_t rays, std::size_t parts, std::size_t i) {
  const auto n = static_cast<std::int64_t>(parts), k = static_cast<std::int64_t>(i);
  return rays / n + (k < rays % n ? 1 : 0);
}

/// Traces all rays in parts of their own random streams, and adds up; stops early if asked to.
///
/// @param make_tracer  called once per part with its random stream: what traces one ray of it.
template <class MakeTracer>
RoughSurfaceScattering run_parts(std::size_t parts, std::int64_t rays, std::uint64_t seed,
                                 ExitCells cells, const Progress& progress,
                                 const MakeTracer& make_tracer) {
  std::vector<ScatteringTally> tallies(parts, ScatteringTally(cells));
  std::atomic<std::int64_t> traced = 0;
  std::atomic<bool> is_stopped = false;
  parallel_for(parts, [&](std::size_t i) {
    if (is_stopped) return;
    Random random = make_random(seed, i);
    const auto trace_ray = make_tracer(random);
    constexpr std::int64_t chunk = 4096;
    for (std::int64_t left = share_of(rays, parts, i); left > 0 && !is_stopped; left -= chunk) {
      const std::int64_t now = std::min(left, chunk);
      for (std::int64_t k = 0; k < now; ++k) trace_ray(random, tallies[i]);
      traced += now;
      if (!report_progress(progress, static_cast<double>(traced) / static_cast<double>(rays)))
        is_stopped = true;
    }
  });
  std::erase_if(tallies, [](const ScatteringTally& tally) { return tally.rays() == 0; });
  return detail::scattering_of(tallies);
}

}  // namespace

RoughSurfaceScattering analytic_scattering(const GaussianSurface& surface, double theta_i,
                                           ExitCells cells) {
  check(surface, theta_i, cells);
  const Vec3 wi = {std::sin(theta_i), 0.0, std::cos(theta_i)};
  RoughSurfaceScattering result{.cells = cells};
  const Quadrature theta_rule = gauss_legendre(5, 0.0, 0.5 * pi / cells.thetas);
  const Quadrature phi_rule = gauss_legendre(5, 0.0, pi / cells.phis);
  for (int i = 0; i < cells.thetas; ++i)
    for (int j = 0; j < cells.phis; ++j) {
      double reflected = 0.0, transmitted = 0.0;
      for (std::size_t a = 0; a < theta_rule.nodes.size(); ++a)
        for (std::size_t b = 0; b < phi_rule.nodes.size(); ++b) {
          const double theta = i * 0.5 * pi / cells.thetas + theta_rule.nodes[a];
          const double phi = j * pi / cells.phis + phi_rule.nodes[b];
          const double s = std::sin(theta), c = std::cos(theta);
          const Vec3 up = {-s * std::cos(phi), s * std::sin(phi), c};  // 0 is away from wi
          // Twice, for the other half of the cell.
          const double weight = 2.0 * theta_rule.weights[a] * phi_rule.weights[b] * s * c;
          reflected += weight * single_scattering_brdf(surface, wi, up);
          transmitted += weight * single_scattering_btdf(surface, wi, {up.x, up.y, -c});
        }
      result.brdf.push_back(reflected / detail::projected_solid_angle(cells, i));
      result.btdf.push_back(transmitted / detail::projected_solid_angle(cells, i));
    }
  result.single_brdf = result.brdf;
  result.single_btdf = result.btdf;
  result.brdf_error = result.btdf_error = std::vector<double>(result.brdf.size(), 0.0);
  const SingleScatteringFractions total = single_scattering_fractions(surface, wi.z);
  result.reflectance = result.single_reflectance = {total.reflectance, 0.0};
  result.transmittance = result.single_transmittance = {total.transmittance, 0.0};
  // All that leaves: what is blocked on its way out or in is not followed.
  result.start_weight = {visibility(surface, wi) *
                             projected_facet_area(make_rough_interface(surface).facets, wi) / wi.z,
                         0.0};
  return result;
}

RoughSurfaceScattering simulate_scattering(const GaussianSurface& surface, double theta_i,
                                           const WalkOptions& options) {
  check(surface, theta_i, options.cells);
  if (options.rays < 1)
    throw InvalidInput("rays must be >= 1, but is " + std::to_string(options.rays));
  const Vec3 wi = {std::sin(theta_i), 0.0, std::cos(theta_i)};
  constexpr std::size_t parts = 64;
  return run_parts(parts, options.rays, options.seed, options.cells, options.progress,
                   [&](Random&) {
                     return [&](Random& random, ScatteringTally& tally) {
                       simulate_ray(surface, wi, options.visibility, random, tally);
                     };
                   });
}

RoughSurfaceScattering trace_height_fields(const GaussianSurface& surface, double theta_i,
                                           const HeightFieldOptions& options) {
  check(surface, theta_i, options.cells);
  if (options.rays < 1)
    throw InvalidInput("rays must be >= 1, but is " + std::to_string(options.rays));
  if (options.realizations < 2)
    throw InvalidInput("realizations must be >= 2, but is " + std::to_string(options.realizations));
  // The way to the surface grows as the tangent: 20 CPU-s for 1e6 rays at 89 degrees, no end at 90.
  if (theta_i > widest_in_height_fields)
    throw InvalidInput("theta_i of height fields must be at most 89 degrees, but is " +
                       std::to_string(theta_i * 180.0 / pi) + "; the walk takes all below 90");
  const Vec3 wi = {std::sin(theta_i), 0.0, std::cos(theta_i)};
  const auto parts = static_cast<std::size_t>(options.realizations);
  return run_parts(
      parts, options.rays, options.seed, options.cells, options.progress, [&](Random& first) {
        return [&, field = GaussianHeightField({.smoothness = surface.smoothness}, first)](
                   Random& random, ScatteringTally& tally) {
          tally.start(1.0);
          const HeightFieldPath path = trace_path(field, surface.eta, wi, random);
          tally.leave(path.wo, path.order, 1.0);
        };
      });
}

double misplaced_transmission(const RoughSurfaceScattering& one,
                              const RoughSurfaceScattering& other) {
  constexpr int thetas = 15, phis = 6;
  const ExitCells cells = one.cells;
  assert(cells.thetas == other.cells.thetas && cells.phis == other.cells.phis);
  assert(cells.thetas % thetas == 0 && cells.phis % phis == 0);
  std::vector<double> difference(static_cast<std::size_t>(thetas * phis), 0.0);
  for (int i = 0; i < cells.thetas; ++i)
    for (int j = 0; j < cells.phis; ++j) {
      const auto cell = static_cast<std::size_t>(i * cells.phis + j);
      const int coarse = i * thetas / cells.thetas * phis + j * phis / cells.phis;
      difference[static_cast<std::size_t>(coarse)] +=
          (one.btdf[cell] - other.btdf[cell]) * detail::projected_solid_angle(cells, i);
    }
  double sum = 0.0;
  for (const double d : difference) sum += 0.5 * std::abs(d);
  return sum;
}

}  // namespace lamina
