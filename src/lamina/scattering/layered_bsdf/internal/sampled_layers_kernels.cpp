// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/layered_bsdf/internal/sampled_layers_kernels.h"

#include "lamina/scattering/layered_bsdf/internal/sampled_layers-inl.h"

#if !defined(LAMINA_KERNELS)
#define LAMINA_KERNELS sampled_layers_baseline
#endif

// With all calls inside made inline: twice as fast.
#define LAMINA_FLATTEN __attribute__((flatten))

namespace {

using namespace lamina;

template <int N>
constexpr SampledLayersKernels kernels_for() {
  return {.look =
              [](const void* stack, const void* higher, const void* wo, void* seen) {
                sampled_layers::look(*static_cast<const FirstOrderStack<BandValues<N>>*>(stack),
                                     static_cast<const HigherOrderBands<N>*>(higher),
                                     *static_cast<const Vec3*>(wo),
                                     *static_cast<LayersSeen<N>*>(seen));
              },
          .evaluate =
              [](const void* seen, const void* wi, void* value) LAMINA_FLATTEN {
                sampled_layers::evaluate(*static_cast<const LayersSeen<N>*>(seen),
                                         *static_cast<const Vec3*>(wi),
                                         *static_cast<LayersValue<N>*>(value));
              },
          .sample =
              [](const void* seen, float u, float u1, float u2, void* drawn) LAMINA_FLATTEN {
                sampled_layers::sample(*static_cast<const LayersSeen<N>*>(seen), u, u1, u2,
                                       *static_cast<LayersSample<N>*>(drawn));
              }};
}

}  // namespace

const SampledLayersKernels LAMINA_KERNELS[3] = {kernels_for<4>(), kernels_for<8>(),
                                                kernels_for<16>()};
