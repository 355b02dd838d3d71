// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/solve/scattering/layered_bsdf/sampled_layers.h"

namespace lamina {

/// Kernels of SampledLayers for one instruction set.
template <int N>
struct SampledLayersKernels {
  void (*look)(const FirstOrderStack<BandValues<N>>& stack, const HigherOrderBands<N>* higher,
               const Vec3& wo, LayersSeen<N>& seen);
  void (*evaluate)(const LayersSeen<N>& seen, const Vec3& wi, LayersValue<N>& value);
  void (*sample)(const LayersSeen<N>& seen, float u, float u1, float u2, LayersSample<N>& drawn);
};

/// The best that this processor can run. N is 4, 8 or 16.
template <int N>
[[nodiscard]] const SampledLayersKernels<N>& sampled_layers_kernels();

}  // namespace lamina
