// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lamina/base/core/vec.h"
#include "lamina/render/subsurface/layered_bsdf/layered_material.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"
#include "lamina/solve/scattering/layered_bsdf/layered_walk.h"

namespace lamina {
namespace {

/// What crosses the boundary at a cosine, over what the smooth top of the layers lets through.
template <int N>
BandValues<N> entering(const SurfaceBoundary& boundary, float mu, const BandValues<N>& surface) {
  const BandValues<N> smooth = BandValues<N>::filled(1.0f) - surface;
  return (1.0f - reflectance(boundary, mu)) *
         (BandValues<N>::filled(1.0f) / max(smooth, BandValues<N>::filled(1e-6f)));
}

/// Factors have no cosine, so their directions are drawn evenly.
constexpr float uniform_hemisphere_pdf = 0.5f * std::numbers::inv_pi_v<float>;

Vec3f sample_uniform_hemisphere(Vec2f u) {
  const float sin_theta = std::sqrt(std::max(1.0f - u.x * u.x, 0.0f));
  const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
  return {sin_theta * std::cos(phi), sin_theta * std::sin(phi), u.x};
}

}  // namespace

template <int N>
LayeredPoint<N>::LayeredPoint(Layers layers, const SurfaceBoundary& boundary, const Vec3f& wo)
    : layers_(std::move(layers)),
      boundary_(boundary),
      scattering_(layers_.stack,
                  layers_.orders != LayeredOrders::all ? nullptr
                  : layers_.own                        ? &*layers_.own
                                                       : layers_.higher,
                  to_double(wo)) {
  const Bands& surface = scattering_.beam().surface;
  entering_ = layers_.is_bare ? Bands::filled(1.0f) : entering(boundary, wo.z, surface);
  const auto& rows = layers_.own ? layers_.own->reflected : layers_.higher->reflected;
  // A color over its mean may ask for more than all light.
  for (const Bands& row : rows)
    layers_.color = min(layers_.color, Bands::filled(1.0f) / max(row, Bands::filled(1e-6f)));
  reflectance_ = layers_.color * entering_ * (Bands::filled(1.0f) - surface) * value_at(rows, wo.z);
}

template <int N>
typename LayeredPoint<N>::Value LayeredPoint<N>::seen(const typename SampledLayers<N>::Value& value,
                                                      float mu) const {
  Bands bsdf = layers_.color * value.bsdf;
  if (!layers_.is_bare) bsdf *= entering_ * entering(boundary_, mu, value.surface);
  return {.bsdf = bsdf, .pdf = value.pdf};
}

template <int N>
typename LayeredPoint<N>::Value LayeredPoint<N>::factors(const Vec3f& wi) const {
  const StackBeam<Bands> in = make_beam(layers_.stack, to_double(wi));
  const StackBeam<Bands>& out = scattering_.beam();
  const FirstOrderLayer<Bands>& layer = layers_.stack.layers[0];
  const LayerBeam<Bands>&a = in.layers[0], &b = out.layers[0];
  const Bands one = Bands::filled(1.0f);
  Bands product = Bands::filled(1.0f / wi.z);  // takes the cosine of shading away
  if (layers_.factors.fresnel) product *= (one - in.surface) * (one - out.surface);
  if (layers_.factors.seeliger) product *= a.mu / (a.mu + b.mu);
  if (layers_.factors.depth) product *= one - a.pass * b.pass;
  if (layers_.factors.phase) {
    const auto across = static_cast<float>(in.toward.x * out.toward.x + in.toward.y * out.toward.y);
    const Bands one_minus_cos =
        one + (across * in.ior[0] * out.ior[0]) * layer.inverse_ior2 + a.mu * b.mu;
    product *= 4.0f * std::numbers::pi_v<float> *
               layer_phase(layers_.stack, layer, min(one_minus_cos, Bands::filled(2.0f)));
  }
  return {.bsdf = product, .pdf = uniform_hemisphere_pdf};
}

template <int N>
typename LayeredPoint<N>::Value LayeredPoint<N>::evaluate(const Vec3f& wi,
                                                          PixelSamples& samples) const {
  if (!(wi.z > 0.0f)) return {};
  if (layers_.factors.any()) return factors(wi);
  if (!is_random()) return seen(scattering_.evaluate(to_double(wi)), wi.z);
  const StackBeam<Bands> in = make_beam(layers_.stack, to_double(wi));
  Random random = make_stream(samples);
  const LayeredWalk<N> walk(layers_.stack, scattering_.beam());
  return seen({.bsdf = walk.evaluate(in, random),
               .pdf = wi.z * std::numbers::inv_pi_v<float>,
               .surface = in.surface},
              wi.z);
}

template <int N>
typename LayeredPoint<N>::Sample LayeredPoint<N>::sample(float u, Vec2f u2,
                                                         PixelSamples& samples) const {
  if (layers_.factors.any()) {
    const Vec3f wi = sample_uniform_hemisphere(u2);
    return wi.z > 0.0f ? Sample{.wi = wi, .value = factors(wi)} : Sample{};
  }
  typename SampledLayers<N>::Sample drawn;
  if (is_random()) {
    Random random = make_stream(samples);
    const auto exit = LayeredWalk<N>(layers_.stack, scattering_.beam()).trace(random);
    if (!(largest(exit.weight) > 0.0f)) return {};
    drawn = {.wi = exit.wi,
             .value = {.bsdf = std::numbers::inv_pi_v<float> * exit.weight,
                       .pdf = static_cast<float>(exit.wi.z) * std::numbers::inv_pi_v<float>}};
    if (!layers_.is_bare) drawn.value.surface = make_beam(layers_.stack, exit.wi).surface;
  } else {
    drawn = scattering_.sample(u, u2.x, u2.y);
  }
  if (!(drawn.value.pdf > 0.0f) || !(drawn.wi.z > 0.0)) return {};
  const Vec3f wi{static_cast<float>(drawn.wi.x), static_cast<float>(drawn.wi.y),
                 static_cast<float>(drawn.wi.z)};
  return {.wi = wi, .value = seen(drawn.value, wi.z)};
}

template <int N>
BandValues<N> LayeredPoint<N>::mirrored_inside() const {
  return layers_.is_bare && !layers_.factors.any() ? layers_.color * scattering_.mirrored_inside()
                                                   : Bands{};
}

template class LayeredPoint<4>;
template class LayeredPoint<8>;
template class LayeredPoint<16>;

}  // namespace lamina
