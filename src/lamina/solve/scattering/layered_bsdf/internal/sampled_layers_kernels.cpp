// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/layered_bsdf/internal/sampled_layers_kernels.h"

// Each takes seconds to compile. SSE4 gains little over what all processors have, AVX-512 over AVX2
// with less than 16 bands.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lamina/solve/scattering/layered_bsdf/internal/sampled_layers_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>
//
#include "lamina/solve/scattering/layered_bsdf/internal/sampled_layers-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::sampled_layers::HWY_NAMESPACE {

/// HWY_FLATTEN makes all calls inside inline: twice as fast.
template <int N>
struct Kernels {
  static void look(const FirstOrderStack<BandValues<N>>& stack, const HigherOrderBands<N>* higher,
                   const Vec3& wo, LayersSeen<N>& seen) {
    HWY_NAMESPACE::look(stack, higher, wo, seen);
  }
  HWY_FLATTEN static void evaluate(const LayersSeen<N>& seen, const Vec3& wi,
                                   LayersValue<N>& value) {
    HWY_NAMESPACE::evaluate(seen, wi, value);
  }
  HWY_FLATTEN static void sample(const LayersSeen<N>& seen, float u, float u1, float u2,
                                 LayersSample<N>& drawn) {
    HWY_NAMESPACE::sample(seen, u, u1, u2, drawn);
  }
  static constexpr SampledLayersKernels<N> all{look, evaluate, sample};
};

const SampledLayersKernels<4>& kernels_of_4() { return Kernels<4>::all; }
const SampledLayersKernels<8>& kernels_of_8() { return Kernels<8>::all; }
const SampledLayersKernels<16>& kernels_of_16() { return Kernels<16>::all; }

}  // namespace lamina::sampled_layers::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina {
namespace sampled_layers {

HWY_EXPORT(kernels_of_4);
HWY_EXPORT(kernels_of_8);
HWY_EXPORT(kernels_of_16);

}  // namespace sampled_layers

template <int N>
const SampledLayersKernels<N>& sampled_layers_kernels() {
  using namespace sampled_layers;
  if constexpr (N == 4)
    return HWY_DYNAMIC_DISPATCH(kernels_of_4)();
  else if constexpr (N == 8)
    return HWY_DYNAMIC_DISPATCH(kernels_of_8)();
  else
    return HWY_DYNAMIC_DISPATCH(kernels_of_16)();
}

template const SampledLayersKernels<4>& sampled_layers_kernels();
template const SampledLayersKernels<8>& sampled_layers_kernels();
template const SampledLayersKernels<16>& sampled_layers_kernels();

}  // namespace lamina
#endif
