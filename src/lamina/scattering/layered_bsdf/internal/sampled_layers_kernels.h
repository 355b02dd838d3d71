// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// sampled_layers_kernels.cpp is compiled once for the oldest processors and once more for newer
// ones, there with another name for namespace lamina, so that the linker cannot mix up functions of
// both. The layout of all types is the same; their names are not, so they pass as untyped pointers.

struct SampledLayersKernels {
  /// stack, higher (or null), wo -> seen
  void (*look)(const void* stack, const void* higher, const void* wo, void* seen);
  /// seen, wi -> value
  void (*evaluate)(const void* seen, const void* wi, void* value);
  /// seen, three numbers in [0, 1) -> drawn
  void (*sample)(const void* seen, float u, float u1, float u2, void* drawn);
};

/// For 4, 8 and 16 bands.
extern const SampledLayersKernels sampled_layers_baseline[3];
#if defined(LAMINA_X86_KERNELS)
extern const SampledLayersKernels sampled_layers_v3[3];  // AVX2 and FMA
#endif
