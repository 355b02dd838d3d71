// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// Thickness of all layers but the last [mm].
[[nodiscard]] double thickness_of_upper_layers(const LayerStack& stack);

/// Layers of which the last is infinite as a thin object: a slab with the same layers on both sides
/// and what is left of the thickness [mm] of the last one between them.
[[nodiscard]] LayerStack make_slab(const LayerStack& stack, double thickness);

/// The slab whose last layer, between the upper ones on both sides, has a thickness [mm].
[[nodiscard]] LayerStack slab_with_inner_thickness(const LayerStack& stack, double inner);

}  // namespace lamina
