// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "lamina/render/layered_material.h"

namespace lamina {
namespace {

Vec3 to_double(const Vec3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// What crosses the boundary at a cosine, over what the smooth top of the layers lets through.
template <int N>
BandValues<N> entering(const SurfaceBoundary& boundary, float mu, const BandValues<N>& surface) {
  const BandValues<N> smooth = BandValues<N>::filled(1.0f) - surface;
  return (1.0f - reflectance(boundary, mu)) *
         (BandValues<N>::filled(1.0f) / max(smooth, BandValues<N>::filled(1e-6f)));
}

}  // namespace

template <int N>
LayeredPoint<N>::LayeredPoint(Layers layers, const SurfaceBoundary& boundary, const Vec3f& wo)
    : layers_(std::move(layers)),
      boundary_(boundary),
      scattering_(layers_.stack,
                  !layers_.has_higher ? nullptr
                  : layers_.own       ? &*layers_.own
                                      : layers_.higher,
                  to_double(wo)) {
  const Bands& surface = scattering_.beam().surface;
  entering_ = layers_.is_bare ? Bands::filled(1.0f) : entering(boundary, wo.z, surface);
  const auto& rows = layers_.own ? layers_.own->reflected : layers_.higher->reflected;
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
typename LayeredPoint<N>::Value LayeredPoint<N>::evaluate(const Vec3f& wi) const {
  if (!(wi.z > 0.0f)) return {};
  return seen(scattering_.evaluate(to_double(wi)), wi.z);
}

template <int N>
typename LayeredPoint<N>::Sample LayeredPoint<N>::sample(float u, Vec2f u2) const {
  const auto drawn = scattering_.sample(u, u2.x, u2.y);
  if (!(drawn.value.pdf > 0.0f) || !(drawn.wi.z > 0.0)) return {};
  const Vec3f wi{static_cast<float>(drawn.wi.x), static_cast<float>(drawn.wi.y),
                 static_cast<float>(drawn.wi.z)};
  return {.wi = wi, .value = seen(drawn.value, wi.z)};
}

template <int N>
BandValues<N> LayeredPoint<N>::mirrored_inside() const {
  return layers_.is_bare ? layers_.color * scattering_.mirrored_inside() : Bands{};
}

template class LayeredPoint<4>;
template class LayeredPoint<8>;
template class LayeredPoint<16>;

}  // namespace lamina
