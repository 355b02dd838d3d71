// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/layered_bsdf/internal/rough_top.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/quadrature.h"

namespace lamina::detail {
namespace {

using std::numbers::pi;

// A Korobov lattice in four dimensions, two for each direction of a pair.
constexpr int facets = 1069, generator = 71;

Vec3 mirrored(const Vec3& direction) { return {-direction.x, -direction.y, direction.z}; }

/// Radiance above per radiance inside, and the way back: all of reciprocity that is not symmetry.
double squared_index(const RoughTop& top) {
  const double ratio = top.ior_outside / top.ior_inside;
  return ratio * ratio;
}

/// All light that goes to and fro between what lies below and the top counts at its angle.
double returns(const RoughTop& top, const StackBeam<double>& beam) {
  return 1.0 / (1.0 - reflectance(top.inside, beam.mu) * beam.reflected);
}

void scale(StackBeam<double>& beam, double factor) {
  for (std::size_t k = 0; k < beam.layers.size(); ++k) {
    beam.layers[k].down *= factor;
    beam.layers[k].up *= factor;
  }
  beam.ground *= factor;
  beam.reflected *= factor;
}

/// A beam of the light inside that leaves upward, or comes in, along `toward`.
StackBeam<double> beam_inside(const RoughTop& top, const Vec3& toward) {
  StackBeam<double> beam = make_beam(top.below, toward);
  scale(beam, returns(top, beam));
  return beam;
}

/// Radiance inside along -toward per irradiance from a direction outside.
double entering(const RoughTop& top, const FacetBeams& in, const Vec3& toward) {
  return in.by_one_facet > 0.0
             ? btdf(top.boundary, in.toward, -toward) * in.transmitted / in.by_one_facet
             : 0.0;
}

/// What light has that meets several facets and is reflected.
double by_several_facets(const RoughTop& top, const Vec3& toward) {
  return std::max(reflectance(top.outside, toward.z) - reflectance(top.one_facet, toward.z), 0.0);
}

/// Mean of value(k) over the facets of two directions.
template <class Value>
double mean_over_pairs(const FacetBeams& in, const FacetBeams& out, const Value& value) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t k = 0; k < in.beams.size(); ++k) {
    const double weight = in.weights[k] * out.weights[k];
    weights += weight;
    if (weight > 0.0) sum += weight * value(k);
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

template <class Value>
double mean_over_facets(const FacetBeams& in, const Value& value) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t k = 0; k < in.beams.size(); ++k) {
    weights += in.weights[k];
    if (in.weights[k] > 0.0) sum += in.weights[k] * value(in.beams[k]);
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

}  // namespace

bool has_rough_top(const LayerStack& stack) {
  const Layer& first = stack.layers().front();
  return !is_specular(make_rough_interface<double>(first.top, stack.ior_above(), first.medium.ior));
}

RoughTop make_rough_top(const LayerStack& stack) {
  std::vector<Layer> layers(stack.layers().begin(), stack.layers().end());
  const Interface boundary = layers.front().top;
  layers.front().top = {};
  const double outside = stack.ior_above(), inside = layers.front().medium.ior;
  const auto from_above = make_rough_interface<double>(boundary, outside, inside);
  const auto from_within = make_rough_interface<double>(boundary, inside, outside);
  return {.boundary = from_above,
          .one_facet = make_interface_reflectance(from_above, FacetMasking::smith),
          .outside = make_interface_reflectance(from_above, FacetMasking::smith_multiple),
          .inside = make_interface_reflectance(from_within, FacetMasking::smith_multiple),
          .below = make_first_order(
              LayerStack(std::move(layers), inside, stack.ior_below(), stack.ground())),
          .ior_outside = outside,
          .ior_inside = inside};
}

FacetBeams cross_facets(const RoughTop& top, const Vec3& toward, OfPair which) {
  const Microfacets<double>& shape = top.boundary.facets;
  FacetBeams light{.toward = toward,
                   .beams = std::vector<StackBeam<double>>(facets),
                   .weights = std::vector<double>(facets)};
  const auto coordinate = [](int k, int power) {
    long long multiplier = 1;
    for (int p = 0; p < power; ++p) multiplier = multiplier * generator % facets;
    return (static_cast<double>(k * multiplier % facets) + 0.5) / facets;
  };
  const int first = which == OfPair::first ? 0 : 2;
  double lattice = 0.0, passed = 0.0;
  for (int k = 0; k < facets; ++k) {
    // t^2 (3 - 2t) makes the integrand periodic, as in for_each_visible_facet.
    const double t1 = coordinate(k, first), t2 = coordinate(k, first + 1);
    const double of_lattice = t1 * (1.0 - t1) * t2 * (1.0 - t2);
    lattice += of_lattice;
    const Vec3 h = sample_visible_normal(shape, toward, t1 * t1 * (3.0 - 2.0 * t1),
                                         t2 * t2 * (3.0 - 2.0 * t2));
    const auto refracted = refract(toward, h, top.boundary.eta);
    if (!refracted || !(refracted->z < 0.0)) continue;
    const auto i = static_cast<std::size_t>(k);
    const double crossing = 1.0 - fresnel(std::clamp(dot(toward, h), 0.0, 1.0), top.boundary.eta);
    light.weights[i] = of_lattice * crossing * masking_shadowing_through(shape, toward, *refracted);
    passed += light.weights[i];
    light.beams[i] = beam_inside(top, -*refracted);
  }
  light.by_one_facet = passed / lattice / masking(shape, toward);
  light.transmitted =
      light.by_one_facet +
      std::max(transmittance(top.outside, toward.z) - transmittance(top.one_facet, toward.z), 0.0);
  light.reflected = 1.0 - light.transmitted;
  return light;
}

void turn(FacetBeams& light, double phi) {
  const double c = std::cos(phi), s = std::sin(phi);
  const auto turned = [&](const Vec3& v) {
    return Vec3{c * v.x - s * v.y, s * v.x + c * v.y, v.z};
  };
  light.toward = turned(light.toward);
  for (StackBeam<double>& beam : light.beams) beam.toward = turned(beam.toward);
}

StackBeam<double> beam_from_below(const RoughTop& top, const Vec3& toward) {
  StackBeam<double> beam = make_beam(top.below, toward);
  if (!(beam.ground > 0.0)) return beam;
  // What arrives under the top goes down again in part, and so on.
  const double mu = beam.layers[0].mu, sine = std::sqrt(std::max(1.0 - mu * mu, 0.0));
  const StackBeam<double> again = beam_inside(top, {sine, 0.0, mu});
  const double sent_down = beam.ground * reflectance(top.inside, mu);
  for (std::size_t k = 0; k < beam.layers.size(); ++k) {
    beam.layers[k].down += sent_down * again.layers[k].down;
    beam.layers[k].up += sent_down * again.layers[k].up;
  }
  beam.ground += sent_down * again.reflected;
  return beam;
}

double surface_brdf(const RoughTop& top, const FacetBeams& in, const FacetBeams& out) {
  const double mean = top.outside.diffuse_reflectance - top.one_facet.diffuse_reflectance;
  const double several = mean > 0.0 ? by_several_facets(top, in.toward) *
                                          by_several_facets(top, out.toward) / (pi * mean)
                                    : 0.0;
  return brdf(top.boundary, in.toward, out.toward) + several;
}

double volume_bsdf(const RoughTop& top, const FacetBeams& in, const FacetBeams& out) {
  const double once = mean_over_pairs(in, out, [&](std::size_t k) {
    return first_order_bsdf(top.below, in.beams[k], out.beams[k]);
  });
  // Down by a facet, mirrored below, and out by another.
  const double mirrored_below = mean_over_facets(in, [&](const StackBeam<double>& beam) {
    return beam.reflected > 0.0 ? beam.reflected * entering(top, out, mirrored(beam.toward)) : 0.0;
  });
  return squared_index(top) * in.transmitted * (out.transmitted * once + mirrored_below);
}

double volume_bsdf(const RoughTop& top, const FacetBeams& in, const StackBeam<double>& out) {
  const double once = mean_over_facets(
      in, [&](const StackBeam<double>& beam) { return first_order_bsdf(top.below, beam, out); });
  if (!(out.ground > 0.0)) return in.transmitted * once;
  // Straight on to the eye: the direction inside that leaves along `out`.
  const double mu = out.layers[0].mu, ratio = out.ior / top.ior_inside;
  const Vec3 from{-ratio * out.toward.x, -ratio * out.toward.y, mu};
  return in.transmitted * once + entering(top, in, from) * out.ground * ratio * ratio;
}

Hemispheres make_hemispheres(const RoughTop& top) {
  const Quadrature rule = gauss_legendre(24, 0.0, 1.0);
  Hemispheres directions;
  for (std::size_t q = 0; q < rule.nodes.size(); ++q) {
    const double mu = rule.nodes[q], sine = std::sqrt(1.0 - mu * mu);
    directions.weights.push_back(2.0 * pi * mu * rule.weights[q]);
    directions.above.push_back(cross_facets(top, {sine, 0.0, mu}, OfPair::second));
    if (top.below.is_transmissive())
      directions.below.push_back(beam_from_below(top, {sine, 0.0, -mu}));
  }
  return directions;
}

VolumeFlux volume_flux(const RoughTop& top, const FacetBeams& in, const Hemispheres& directions) {
  VolumeFlux flux;
  flux.back = mean_over_facets(in, [&](const StackBeam<double>& beam) {
    return beam.reflected * transmittance(top.inside, beam.mu);
  });
  if (top.below.is_transmissive())
    flux.through = mean_over_facets(in, [](const StackBeam<double>& beam) { return beam.ground; });
  for (std::size_t q = 0; q < directions.weights.size(); ++q) {
    const FacetBeams& above = directions.above[q];
    flux.back += directions.weights[q] * squared_index(top) * above.transmitted *
                 mean_over_pairs(in, above, [&](std::size_t k) {
                   return mean_first_order_bsdf(top.below, in.beams[k], above.beams[k]);
                 });
    if (top.below.is_transmissive())
      flux.through +=
          directions.weights[q] * mean_over_facets(in, [&](const StackBeam<double>& beam) {
            return mean_first_order_bsdf(top.below, beam, directions.below[q]);
          });
  }
  return {in.transmitted * flux.back, in.transmitted * flux.through};
}

}  // namespace lamina::detail
