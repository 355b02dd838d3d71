// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/patch_photons.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/monte_carlo/internal/turned_direction.h"

namespace lamina {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double roulette_weight = 0.05;
constexpr double weightless = 1e-12;  // so little light is gone

void check_map(const std::vector<double>& map, const std::string& name, std::size_t texels,
               double largest) {
  if (map.empty()) return;
  if (map.size() != texels)
    throw InvalidInput(name + " must have " + std::to_string(texels) + " texels, but has " +
                       std::to_string(map.size()));
  for (const double value : map)
    if (!(value >= 0.0 && value <= largest && std::isfinite(value)))
      throw InvalidInput(name + " must lie in [0, " + (largest < infinity ? "1]" : "inf)") +
                         ", but is " + number_text(value));
}

void check(const Patch& patch, const PatchPhotonOptions& options) {
  if (patch.columns < 1 || patch.rows < 1 || !(patch.texel > 0.0) || !std::isfinite(patch.texel))
    throw InvalidInput("a patch must have columns, rows and a texel > 0 [mm]");
  if (!is_smooth(patch.stack) || patch.stack.ground().reflectance > 0.0)
    throw InvalidInput("a patch of photons must have smooth boundaries and a black ground");
  const std::size_t texels = std::size_t(patch.columns) * std::size_t(patch.rows);
  const std::size_t layers = patch.stack.layers().size();
  if (patch.sigma_a.size() > layers || patch.junction.size() > layers)
    throw InvalidInput("a patch must have no more maps than layers");
  for (const auto& map : patch.sigma_a) check_map(map, "sigma_a", texels, infinity);
  for (const auto& map : patch.junction) check_map(map, "junction", texels, 1.0);
  check_map(patch.irradiance, "irradiance", texels, infinity);
  if (!patch.irradiance.empty() &&
      std::ranges::all_of(patch.irradiance, [](double e) { return e == 0.0; }))
    throw InvalidInput("irradiance must not be 0 everywhere");
  if (options.photons < 1) throw InvalidInput("photons must be >= 1, but is 0");
}

/// Where photons start and what maps they meet.
class Tracer {
 public:
  Tracer(const Patch& patch, const Incidence& incidence) : patch_(patch), incidence_(incidence) {
    const std::size_t texels = std::size_t(patch.columns) * std::size_t(patch.rows);
    const std::vector<double> ones(patch.irradiance.empty() ? texels : 0, 1.0);
    const auto& irradiance = patch.irradiance.empty() ? ones : patch.irradiance;
    cumulative_.resize(texels);
    std::partial_sum(irradiance.begin(), irradiance.end(), cumulative_.begin());
    tops_ = {0.0};
    for (const Layer& layer : patch.stack.layers()) tops_.push_back(tops_.back() + layer.thickness);
  }

  /// Irradiance times area, in texels.
  [[nodiscard]] double flux() const { return cumulative_.back(); }

  struct Exit {
    std::size_t texel = 0;
    double weight = 0.0;  ///< 0: the photon did not leave
    bool is_below = false;
  };
  [[nodiscard]] Exit trace(Random random) const;

 private:
  struct Photon {
    double x, y, z;  ///< x and y in texels
    Vec3 w;          ///< towards where it goes; z downward
    double weight;
  };
  [[nodiscard]] Photon start(Random& random) const;
  [[nodiscard]] std::size_t texel(double x, double y) const;
  [[nodiscard]] double absorbance(const std::vector<double>& map, const Photon& p, double s) const;
  [[nodiscard]] double ior(int layer) const {
    const auto layers = patch_.stack.layers();
    return layer < 0                     ? patch_.stack.ior_above()
           : layer >= int(layers.size()) ? patch_.stack.ior_below()
                                         : layers[std::size_t(layer)].medium.ior;
  }

  const Patch& patch_;
  Incidence incidence_;
  std::vector<double> cumulative_;
  std::vector<double> tops_;
};

Tracer::Photon Tracer::start(Random& random) const {
  const auto found = std::ranges::upper_bound(cumulative_, random.uniform() * cumulative_.back());
  const std::size_t i = std::min(std::size_t(found - cumulative_.begin()), cumulative_.size() - 1);
  const std::size_t columns = std::size_t(patch_.columns);
  const double mu =
      incidence_.is_diffuse ? std::sqrt(1.0 - random.uniform()) : std::cos(incidence_.theta);
  const double phi = incidence_.is_diffuse ? 2.0 * std::numbers::pi * random.uniform() : 0.0;
  const double eta = ior(0) / ior(-1), sine = std::sqrt(1.0 - mu * mu) / eta;
  return {.x = double(i % columns) + random.uniform(),
          .y = double(i / columns) + random.uniform(),
          .z = 0.0,
          .w = {sine * std::cos(phi), sine * std::sin(phi), cos_refracted(mu, eta)},
          .weight = 1.0 - fresnel(mu, eta)};
}

std::size_t Tracer::texel(double x, double y) const {
  const double column = x - std::floor(x / patch_.columns) * patch_.columns;
  const double row = y - std::floor(y / patch_.rows) * patch_.rows;
  return std::size_t(std::min(int(row), patch_.rows - 1)) * std::size_t(patch_.columns) +
         std::size_t(std::min(int(column), patch_.columns - 1));
}

/// Absorption coefficient times path, over a path of s [texels]: texel by texel, until the light is
/// gone.
double Tracer::absorbance(const std::vector<double>& map, const Photon& p, double s) const {
  const auto step = [](double position, double slope) {  // to the first border, then from each on
    if (slope == 0.0) return std::pair{infinity, infinity};
    const double border = slope > 0.0 ? std::floor(position) + 1.0 : std::ceil(position) - 1.0;
    return std::pair{(border - position) / slope, 1.0 / std::abs(slope)};
  };
  auto [next_x, dx] = step(p.x, p.w.x);
  auto [next_y, dy] = step(p.y, p.w.y);
  double sum = 0.0, at = 0.0;
  while (at < s && sum * patch_.texel < 50.0) {
    const double end = std::min({s, next_x, next_y});
    const double middle = 0.5 * (at + end);
    sum += (end - at) * map[texel(p.x + middle * p.w.x, p.y + middle * p.w.y)];
    if (next_x <= end) next_x += dx;
    if (next_y <= end) next_y += dy;
    at = end;
  }
  return sum * patch_.texel;
}

Tracer::Exit Tracer::trace(Random random) const {
  const auto layers = patch_.stack.layers();
  Photon p = start(random);
  for (int layer = 0; p.weight > weightless;) {
    const Layer& now = layers[std::size_t(layer)];
    const double optical = -std::log(1.0 - random.uniform());
    const double free_path = now.medium.sigma_s > 0.0 ? optical / now.medium.sigma_s : infinity;
    const int next = p.w.z > 0.0 ? layer + 1 : layer - 1;
    const double boundary = tops_[std::size_t(std::max(layer, next))];
    const double to_boundary = p.w.z == 0.0 ? infinity : (boundary - p.z) / p.w.z;
    const double path = std::min(free_path, to_boundary);  // [mm]
    if (!(path < infinity)) return {};                     // nothing scatters it back
    const std::size_t l = std::size_t(layer);
    const bool varies = l < patch_.sigma_a.size() && !patch_.sigma_a[l].empty();
    const double absorbed =
        varies ? absorbance(patch_.sigma_a[l], p, path / patch_.texel) : now.medium.sigma_a * path;
    p.weight *= std::exp(-absorbed);
    p.x += p.w.x * path / patch_.texel;
    p.y += p.w.y * path / patch_.texel;
    if (free_path < to_boundary) {
      p.z += p.w.z * path;
      const double u = random.uniform(), v = random.uniform();
      p.w = detail::turned(p.w, sample_cos_theta(phase_function(now), u, v),
                           2.0 * std::numbers::pi * random.uniform());
    } else {
      p.z = boundary;
      const double eta = ior(next) / ior(layer), mu = std::min(std::abs(p.w.z), 1.0);
      if (random.uniform() < fresnel(mu, eta)) {
        p.w.z = -p.w.z;
      } else {
        p.w = {p.w.x / eta, p.w.y / eta, std::copysign(cos_refracted(mu, eta), p.w.z)};
        if (next < 0 || next >= int(layers.size()))
          return {.texel = texel(p.x, p.y), .weight = p.weight, .is_below = next >= 0};
        const std::size_t crossed = std::size_t(std::min(layer, next));
        if (crossed < patch_.junction.size() && !patch_.junction[crossed].empty())
          p.weight *= patch_.junction[crossed][texel(p.x, p.y)];
        layer = next;
      }
    }
    if (p.weight < roulette_weight)
      p.weight = random.uniform() * 2.0 * roulette_weight < p.weight ? 2.0 * roulette_weight : 0.0;
  }
  return {};
}

}  // namespace

PatchPhotons trace_patch_photons(const Patch& patch, const PatchPhotonOptions& options) {
  check(patch, options);
  const Tracer tracer(patch, options.incidence);
  const std::size_t texels = std::size_t(patch.columns) * std::size_t(patch.rows);
  struct Sums {
    std::vector<double> weights, squares;
  };
  constexpr std::uint64_t parts = 16,
                          in_part = 8192;  // a fixed order of sums, whatever the threads
  // Texels of the top, then those below.
  std::vector<Sums> sums(parts, Sums{std::vector(2 * texels, 0.0), std::vector(2 * texels, 0.0)});
  PatchPhotons result;
  while (result.photons < options.photons) {
    const std::uint64_t first = result.photons;
    const std::uint64_t end = std::min(first + parts * in_part, options.photons);
    parallel_for(parts, [&](std::size_t part) {
      const std::uint64_t part_end = std::min(first + (part + 1) * in_part, end);
      for (std::uint64_t i = first + part * in_part; i < part_end; ++i) {
        const Tracer::Exit exit = tracer.trace(make_random(options.seed, i));
        const std::size_t at = exit.texel + (exit.is_below ? texels : 0);
        sums[part].weights[at] += exit.weight;
        sums[part].squares[at] += exit.weight * exit.weight;
      }
    });
    result.photons = end;
    if (!report_progress(options.progress, double(end) / double(options.photons))) break;
  }
  const double n = double(result.photons);
  for (std::size_t t = 0; t < 2 * texels; ++t) {
    double weight = 0.0, square = 0.0;
    for (const Sums& part : sums) weight += part.weights[t], square += part.squares[t];
    const Estimate mean = sample_mean(n, weight, square);
    auto& leaving = t < texels ? result.exitance : result.transmitted;
    leaving.push_back({.value = mean.value * tracer.flux(),
                       .standard_error = mean.standard_error * tracer.flux()});
  }
  return result;
}

}  // namespace lamina
