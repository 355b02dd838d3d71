// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/layered_bsdf/layered_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"

namespace lamina {
namespace {

using std::numbers::pi;
constexpr int long_walk = 1000;  // events; roulette ends those that nothing else does

/// What a path is worth, by bands: throughput and density, both over the density of the band that
/// draws it.
template <int N>
struct Worth {
  using Bands = BandValues<N>;
  Bands throughput = Bands::filled(1.0f), density = Bands::filled(1.0f);

  [[nodiscard]] Bands weight() const { return (static_cast<float>(N) / sum(density)) * throughput; }
};

/// A direction at an angle of cosine c from `w`.
Vec3 turned(const Vec3& w, double c, double phi) {
  const double sine = std::sqrt(std::max(0.0, 1.0 - c * c));
  return make_frame(w).to_world({sine * std::cos(phi), sine * std::sin(phi), c});
}

template <int N>
double draw_cosine(const FirstOrderStack<BandValues<N>>& stack,
                   const FirstOrderLayer<BandValues<N>>& layer, int band, Random& random) {
  std::size_t l = layer.first_lobe;
  auto u = static_cast<float>(random.uniform());
  while (l + 1 < layer.first_lobe + layer.lobes && u >= stack.lobes[l].weight[band])
    u -= stack.lobes[l++].weight[band];
  const PhaseLobe<BandValues<N>>& lobe = stack.lobes[l];
  if (lobe.is_rayleigh) return sample_cos_theta(Rayleigh{}, random.uniform(), random.uniform());
  return sample_cos_theta(HenyeyGreenstein{static_cast<double>(lobe.g[band])}, random.uniform(),
                          random.uniform());
}

/// Refracts a ray at a smooth boundary, or not, by chance.
/// @return its direction beyond; none: it is reflected
std::optional<Vec3> refracted_by_chance(const Vec3& w, double eta, Random& random) {
  const double cosine = std::min(std::abs(w.z), 1.0);
  if (random.uniform() < fresnel(cosine, eta)) return std::nullopt;
  const double transmitted2 = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
  if (transmitted2 <= 0.0) return std::nullopt;
  return normalize(Vec3{w.x / eta, w.y / eta, std::copysign(std::sqrt(transmitted2), w.z)});
}

/// Roulette: a dim path, or one that has little chance at most, goes on seldom.
template <int N>
bool survives(Worth<N>& worth, float most, Random& random) {
  const float survival = std::min({1.0f, 4.0f * largest(worth.weight()), most});
  if (!(random.uniform_float() < survival)) return false;
  worth.throughput *= 1.0f / survival;
  return true;
}

/// Direction of light from a Lambertian ground just under a boundary, once it gets through that.
/// @param eta       index inside over that below
/// @param at_event  called wherever it falls on the ground
template <int N, class AtEvent>
std::optional<Vec3> from_ground(Worth<N>& worth, const BandValues<N>& reflectance, double eta,
                                Random& random, const AtEvent& at_event) {
  while (true) {
    worth.throughput *= reflectance;
    at_event();
    if (!survives(worth, 1.0f, random)) return std::nullopt;
    const double u = random.uniform(), phi = 2.0 * pi * random.uniform();
    const Vec3 up{std::sqrt(u) * std::cos(phi), std::sqrt(u) * std::sin(phi), std::sqrt(1.0 - u)};
    if (const std::optional<Vec3> w = refracted_by_chance(up, eta, random)) return w;
  }
}

}  // namespace

template <int N>
template <class AtEvent>
typename LayeredWalk<N>::Exit LayeredWalk<N>::walk(Random& random, const AtEvent& at_event) const {
  const std::size_t count = stack_.layers.size();
  const auto band = static_cast<int>(random.uniform() * N);
  const auto index = [](const Bands& ior) { return static_cast<double>(ior[0]); };
  const double ior_above = index(stack_.ior_above), ior_below = index(stack_.ior_below);

  // In through the top, which takes its share; z points up, depth in the layer down.
  Worth<N> worth;
  worth.throughput = Bands::filled(1.0f) - wo_.surface;
  std::size_t k = 0;
  double ior = index(stack_.layers[0].ior), depth = 0.0;
  const double entry = ior_above / ior;
  Vec3 w{-entry * wo_.toward.x, -entry * wo_.toward.y, 0.0};
  const double sine2 = w.x * w.x + w.y * w.y;
  if (sine2 >= 1.0) return {};
  w.z = -std::sqrt(1.0 - sine2);

  int events = 0;
  while (true) {
    const FirstOrderLayer<Bands>& layer = stack_.layers[k];
    const auto thickness = static_cast<double>(layer.thickness[band]);
    const double to_boundary = w.z < 0.0   ? (thickness - depth) / -w.z
                               : w.z > 0.0 ? depth / w.z
                                           : std::numeric_limits<double>::infinity();
    const auto extinction = static_cast<double>(layer.sigma_t[band]);
    const double free_path = extinction > 0.0 ? -std::log1p(-random.uniform()) / extinction
                                              : std::numeric_limits<double>::infinity();
    if (std::isinf(free_path) && std::isinf(to_boundary)) return {};
    const bool is_event = free_path < to_boundary;
    const double path = is_event ? free_path : to_boundary;
    const Bands passed = exp_minus(static_cast<float>(std::min(path, 1e12)) * layer.sigma_t);
    const float own = std::max(passed[band], 1e-37f);
    if (is_event) {
      const float drawn = 1.0f / (own * layer.sigma_t[band]);
      worth.throughput *= drawn * (passed * layer.sigma_s);
      worth.density *= drawn * (passed * layer.sigma_t);
      depth = std::clamp(depth - w.z * path, 0.0, thickness);
      ++events;
      at_event(k, depth, w, worth.weight(), events);
      if (!survives(worth, events > long_walk ? 0.99f : 1.0f, random)) return {};
      const double c = draw_cosine(stack_, layer, band, random);
      const Bands phase = layer_phase(stack_, layer, Bands::filled(static_cast<float>(1.0 - c)));
      worth.throughput *= (1.0f / phase[band]) * phase;
      worth.density *= (1.0f / phase[band]) * phase;
      w = turned(w, c, 2.0 * pi * random.uniform());
      continue;
    }
    worth.throughput *= (1.0f / own) * passed;
    worth.density *= (1.0f / own) * passed;
    const bool is_down = w.z < 0.0;
    depth = is_down ? thickness : 0.0;
    const bool is_last = is_down && k + 1 == count, is_first = !is_down && k == 0;
    const double next = is_last    ? ior_below
                        : is_first ? ior_above
                                   : index(stack_.layers[is_down ? k + 1 : k - 1].ior);
    const std::optional<Vec3> beyond = refracted_by_chance(w, next / ior, random);
    if (!beyond) {
      w.z = -w.z;
      continue;
    }
    w = *beyond;
    if (is_first) {
      if (events == 0) return {};
      return {.wi = w, .weight = worth.weight()};
    }
    if (!is_last) {
      k = is_down ? k + 1 : k - 1;
      ior = next;
      depth = is_down ? 0.0 : static_cast<double>(stack_.layers[k].thickness[band]);
      continue;
    }
    if (!stack_.has_ground) return {};
    const std::optional<Vec3> back =
        from_ground(worth, stack_.ground_reflectance, ior / ior_below, random, [&] {
          ++events;
          at_event(count, 0.0, w, worth.weight(), events);
        });
    if (!back) return {};
    w = *back;
  }
}

template <int N>
BandValues<N> LayeredWalk<N>::evaluate(const StackBeam<Bands>& in, Random& random) const {
  Bands total = first_order_bsdf(stack_, in, wo_);
  const float from = wo_.ior[0] * wo_.ior[0];
  (void)walk(
      random, [&](std::size_t k, double depth, const Vec3& w, const Bands& weight, int events) {
        if (events == 1) return;  // in closed form above
        if (k == stack_.layers.size()) {
          total += (from / static_cast<float>(pi)) * weight * in.ground /
                   (stack_.ior_below * stack_.ior_below);
          return;
        }
        // Towards the light: up at once, or down first and mirrored, by the two fluxes of its beam.
        const FirstOrderLayer<Bands>& layer = stack_.layers[k];
        const LayerBeam<Bands>& beam = in.layers[k];
        const auto mu = static_cast<double>(beam.mu[0]);
        const auto ratio = static_cast<double>(in.ior[0] / layer.ior[0]);
        const double across = ratio * (w.x * in.toward.x + w.y * in.toward.y);
        const auto phase = [&](double c) {
          return layer_phase(stack_, layer,
                             Bands::filled(static_cast<float>(std::clamp(1.0 - c, 0.0, 2.0))));
        };
        const auto z = static_cast<float>(depth);
        const Bands rest = layer.thickness - Bands::filled(z);
        const Bands rising = beam.down * exp_minus(z * beam.decay) * phase(across + mu * w.z);
        Bands falling;
        if (largest(beam.up) > 0.0f)
          falling = beam.up * exp_minus(beam.decay * max(rest, Bands{})) * phase(across - mu * w.z);
        total += from * weight * layer.inverse_ior2 * beam.inverse_mu * (rising + falling);
      });
  return total;
}

template <int N>
typename LayeredWalk<N>::Exit LayeredWalk<N>::trace(Random& random) const {
  return walk(random, [](std::size_t, double, const Vec3&, const Bands&, int) {});
}

template class LayeredWalk<4>;
template class LayeredWalk<8>;
template class LayeredWalk<16>;

}  // namespace lamina
