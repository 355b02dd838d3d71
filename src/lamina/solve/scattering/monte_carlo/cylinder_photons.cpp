// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/cylinder_photons.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/phase_function.h"
#include "lamina/solve/scattering/monte_carlo/internal/turned_direction.h"

namespace lamina {
namespace {

constexpr double infinite_path = std::numeric_limits<double>::infinity();
constexpr double roulette_below = 0.05;
constexpr int no_cylinder = -1;

/// What is tallied, in this order.
enum Tally : std::size_t { reflected, transmitted, sides, first_column };

/// The layers' upper boundaries and the last one's lower one [mm].
std::vector<double> boundaries_of(const LayerStack& stack) {
  std::vector<double> tops = {0.0};
  for (const Layer& layer : stack.layers()) tops.push_back(tops.back() + layer.thickness);
  return tops;
}

/// The layer that holds a cylinder.
std::size_t layer_around(const CylinderLayers& scene, const std::vector<double>& tops,
                         std::size_t c) {
  const Cylinder& at = scene.cylinders[c];
  const auto require = [&](bool holds, const std::string& rule, double given) {
    if (!holds)
      throw InvalidInput("cylinder " + std::to_string(c) + ": " + rule + ", but is " +
                         number_text(given));
  };
  require(at.radius > 0.0 && std::isfinite(at.radius), "radius must be > 0 [mm]", at.radius);
  require(at.sigma_a >= 0.0 && std::isfinite(at.sigma_a), "sigma_a must be >= 0 [1/mm]",
          at.sigma_a);
  require(at.sigma_s >= 0.0 && std::isfinite(at.sigma_s), "sigma_s must be >= 0 [1/mm]",
          at.sigma_s);
  require(-1.0 < at.g && at.g < 1.0, "g must lie in (-1, 1)", at.g);
  if (scene.sides == BoxSides::repeat)
    require(at.x - at.radius >= 0.0 && at.x + at.radius <= scene.width,
            "x must keep it within the box that repeats", at.x);
  for (std::size_t other = 0; other < c; ++other)
    require(std::hypot(at.x - scene.cylinders[other].x, at.depth - scene.cylinders[other].depth) >=
                at.radius + scene.cylinders[other].radius,
            "it must lie apart from cylinder " + std::to_string(other) + "; its x", at.x);
  for (std::size_t l = 0; l + 1 < tops.size(); ++l)
    if (tops[l] <= at.depth - at.radius && at.depth + at.radius <= tops[l + 1]) return l;
  require(false, "depth must keep it within one layer", at.depth);
  return 0;
}

class CylinderTracer {
 public:
  explicit CylinderTracer(const CylinderLayers& scene)
      : scene_(scene), tops_(boundaries_of(scene.stack)), in_layer_(scene.stack.layers().size()) {
    for (std::size_t c = 0; c < scene.cylinders.size(); ++c)
      in_layer_[layer_around(scene, tops_, c)].push_back(static_cast<int>(c));
    if (!is_smooth(scene.stack) || scene.stack.ground().reflectance > 0.0)
      throw InvalidInput("layers with cylinders must have smooth boundaries and a black ground");
    if (!(scene.width >= 1e-3 && scene.length >= 1e-3) ||
        !std::isfinite(scene.width * scene.length) || scene.columns < 1)
      throw InvalidInput(
          "a box must have width and length >= 0.001 mm, and columns >= 1, but has " +
          number_text(scene.width) + ", " + number_text(scene.length) + " and " +
          std::to_string(scene.columns));
  }

  [[nodiscard]] std::size_t layers() const { return in_layer_.size(); }
  [[nodiscard]] std::size_t first_layer() const {
    return first_column + static_cast<std::size_t>(scene_.columns);
  }
  [[nodiscard]] std::size_t tallies() const {
    return first_layer() + layers() + scene_.cylinders.size();
  }
  [[nodiscard]] double entering() const { return 1.0 - fresnel(1.0, ior(0) / ior(-1)); }
  void trace(Random random, std::vector<double>& tally) const;

 private:
  struct Photon {
    Vec3 at;  ///< [mm], z downward
    Vec3 w;
    double weight;
  };
  enum class Event { scatters, boundary, cylinder, side_x, side_y };
  /// The nearest of: a scattering, a boundary of the layer, a cylinder, a side of the box.
  struct Next {
    double path;  ///< [mm]
    Event event;
    int met;  ///< the cylinder whose surface is crossed
  };
  [[nodiscard]] Photon start(Random& random) const;
  /// @param inside  the cylinder that the photon is in
  [[nodiscard]] Next next_event(const Photon& p, int layer, int inside, double sigma_s,
                                Random& random) const;
  [[nodiscard]] double border(int layer, int next) const {
    return tops_[static_cast<std::size_t>(std::max(layer, next))];
  }
  [[nodiscard]] double ior(int layer) const {
    const auto all = scene_.stack.layers();
    return layer < 0                  ? scene_.stack.ior_above()
           : layer >= int(all.size()) ? scene_.stack.ior_below()
                                      : all[std::size_t(layer)].medium.ior;
  }
  [[nodiscard]] double path_to(const Cylinder& cylinder, const Photon& p, bool is_inside) const;
  [[nodiscard]] std::size_t column(double x) const {
    const double place = x / scene_.width * scene_.columns;
    return static_cast<std::size_t>(std::clamp(place, 0.0, scene_.columns - 1.0));
  }

  const CylinderLayers& scene_;
  std::vector<double> tops_;
  std::vector<std::vector<int>> in_layer_;  ///< [layer] cylinders
};

CylinderTracer::Photon CylinderTracer::start(Random& random) const {
  Photon p{.at = {random.uniform() * scene_.width, random.uniform() * scene_.length, 0.0},
           .w = {0.0, 0.0, 1.0},
           .weight = entering()};
  if (scene_.beam_radius) {
    const double r = *scene_.beam_radius * std::sqrt(random.uniform());
    const double phi = 2.0 * std::numbers::pi * random.uniform();
    p.at = {0.5 * scene_.width + r * std::cos(phi), 0.5 * scene_.length + r * std::sin(phi), 0.0};
  }
  return p;
}

/// Path to the surface of a cylinder: out of it, or into it; infinite where it is missed.
double CylinderTracer::path_to(const Cylinder& cylinder, const Photon& p, bool is_inside) const {
  const double x = p.at.x - cylinder.x, z = p.at.z - cylinder.depth;
  const double a = p.w.x * p.w.x + p.w.z * p.w.z;
  const double b = x * p.w.x + z * p.w.z;
  const double c = x * x + z * z - cylinder.radius * cylinder.radius;
  if (a == 0.0) return infinite_path;
  const double discriminant = b * b - a * c;
  if (is_inside) return std::max(0.0, (-b + std::sqrt(std::max(0.0, discriminant))) / a);
  if (b >= 0.0 || discriminant <= 0.0) return infinite_path;  // it goes away, or past
  return std::max(0.0, (-b - std::sqrt(discriminant)) / a);
}

CylinderTracer::Next CylinderTracer::next_event(const Photon& p, int layer, int inside,
                                                double sigma_s, Random& random) const {
  const double optical = -std::log(1.0 - random.uniform());
  Next result{sigma_s > 0.0 ? optical / sigma_s : infinite_path, Event::scatters, inside};
  const auto nearer = [&](double distance, Event what) {
    if (!(distance < result.path)) return false;
    result.path = distance;
    result.event = what;
    return true;
  };
  const int next = p.w.z > 0.0 ? layer + 1 : layer - 1;
  if (inside != no_cylinder) {
    nearer(path_to(scene_.cylinders[static_cast<std::size_t>(inside)], p, true), Event::cylinder);
  } else {
    if (p.w.z != 0.0)
      nearer(std::max(0.0, (border(layer, next) - p.at.z) / p.w.z), Event::boundary);
    for (const int c : in_layer_[static_cast<std::size_t>(layer)])
      if (nearer(path_to(scene_.cylinders[static_cast<std::size_t>(c)], p, false), Event::cylinder))
        result.met = c;
  }
  const auto to_side = [](double at, double w, double size) {
    return w > 0.0 ? (size - at) / w : w < 0.0 ? -at / w : infinite_path;
  };
  nearer(std::max(0.0, to_side(p.at.x, p.w.x, scene_.width)), Event::side_x);
  nearer(std::max(0.0, to_side(p.at.y, p.w.y, scene_.length)), Event::side_y);
  return result;
}

void CylinderTracer::trace(Random random, std::vector<double>& tally) const {
  const auto all = scene_.stack.layers();
  Photon p = start(random);
  int inside = no_cylinder;
  for (int layer = 0; p.weight > 0.0;) {
    const auto l = static_cast<std::size_t>(layer);
    const Medium medium = [&] {
      if (inside == no_cylinder) return all[l].medium;
      const Cylinder& c = scene_.cylinders[static_cast<std::size_t>(inside)];
      return Medium{c.sigma_a, c.sigma_s, c.g, all[l].medium.ior};
    }();
    const auto [path, event, met] = next_event(p, layer, inside, medium.sigma_s, random);
    const int next = p.w.z > 0.0 ? layer + 1 : layer - 1;
    if (!(path < infinite_path)) {  // nothing scatters it back
      tally[medium.sigma_a > 0.0 ? first_layer() + l : std::size_t{transmitted}] += p.weight;
      return;
    }
    const double kept = p.weight * std::exp(-medium.sigma_a * path);
    tally[first_layer() + (inside == no_cylinder ? l : layers() + std::size_t(inside))] +=
        p.weight - kept;
    p.weight = kept;
    p.at = p.at + path * p.w;
    switch (event) {
      case Event::scatters: {
        const double u = random.uniform(), v = random.uniform();
        const PhaseFunction phase =
            inside == no_cylinder ? phase_function(all[l]) : HenyeyGreenstein{medium.g};
        p.w = detail::turned(p.w, sample_cos_theta(phase, u, v),
                             2.0 * std::numbers::pi * random.uniform());
        break;
      }
      case Event::cylinder:
        inside = inside == no_cylinder ? met : no_cylinder;
        break;
      case Event::side_x:
      case Event::side_y: {
        if (scene_.sides == BoxSides::open) {
          tally[sides] += p.weight;
          return;
        }
        double& at = event == Event::side_x ? p.at.x : p.at.y;
        const double size = event == Event::side_x ? scene_.width : scene_.length;
        at = (event == Event::side_x ? p.w.x : p.w.y) > 0.0 ? 0.0 : size;
        break;
      }
      case Event::boundary: {
        p.at.z = border(layer, next);
        const double eta = ior(next) / ior(layer), mu = std::min(std::abs(p.w.z), 1.0);
        if (random.uniform() < fresnel(mu, eta)) {
          p.w.z = -p.w.z;
          break;
        }
        p.w = {p.w.x / eta, p.w.y / eta, std::copysign(cos_refracted(mu, eta), p.w.z)};
        if (next < 0) {
          tally[reflected] += p.weight;
          tally[first_column + column(p.at.x)] += p.weight;
          return;
        }
        if (next >= int(all.size())) {
          tally[transmitted] += p.weight;
          return;
        }
        layer = next;
      }
    }
    if (p.weight < roulette_below)
      p.weight = random.uniform() * 2.0 * roulette_below < p.weight ? 2.0 * roulette_below : 0.0;
  }
}

}  // namespace

CylinderPhotons trace_cylinder_photons(const CylinderLayers& scene,
                                       const CylinderPhotonOptions& options) {
  if (options.photons < 1) throw InvalidInput("photons must be >= 1, but is 0");
  const CylinderTracer tracer(scene);
  struct Sums {
    std::vector<double> weights, squares;
  };
  constexpr std::uint64_t parts = 16, in_part = 4096;  // a fixed order of sums
  std::vector<Sums> sums(
      parts, Sums{std::vector(tracer.tallies(), 0.0), std::vector(tracer.tallies(), 0.0)});
  CylinderPhotons result{.specular = 1.0 - tracer.entering()};
  while (result.photons < options.photons) {
    const std::uint64_t first = result.photons;
    const std::uint64_t end = std::min(first + parts * in_part, options.photons);
    parallel_for(parts, [&](std::size_t part) {
      std::vector<double> tally(tracer.tallies());
      const std::uint64_t part_end = std::min(first + (part + 1) * in_part, end);
      for (std::uint64_t i = first + part * in_part; i < part_end; ++i) {
        std::ranges::fill(tally, 0.0);
        tracer.trace(make_random(options.seed, i), tally);
        for (std::size_t t = 0; t < tally.size(); ++t) {
          sums[part].weights[t] += tally[t];
          sums[part].squares[t] += tally[t] * tally[t];
        }
      }
    });
    result.photons = end;
    if (!report_progress(options.progress, double(end) / double(options.photons))) break;
  }
  const auto estimate = [&](std::size_t t) {
    double weight = 0.0, square = 0.0;
    for (const Sums& part : sums) weight += part.weights[t], square += part.squares[t];
    return sample_mean(double(result.photons), weight, square);
  };
  result.reflected = estimate(reflected);
  result.transmitted = estimate(transmitted);
  result.through_sides = estimate(sides);
  for (std::size_t t = first_column; t < tracer.first_layer(); ++t)
    result.reflected_by_column.push_back(estimate(t));
  for (std::size_t l = 0; l < tracer.layers(); ++l)
    result.absorbed_by_layers.push_back(estimate(tracer.first_layer() + l));
  for (std::size_t c = 0; c < scene.cylinders.size(); ++c)
    result.absorbed_by_cylinders.push_back(estimate(tracer.first_layer() + tracer.layers() + c));
  return result;
}

}  // namespace lamina
