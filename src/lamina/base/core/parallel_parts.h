// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "lamina/base/core/progress.h"

namespace lamina {

/// parallel_for of base/core/progress.h for few calls that take long: each is handed what it reports its
/// own finished fraction to, now and then and from any thread. `progress` is told their mean.
/// @throws Interrupted if asked to stop; calls of `body` that have not begun are left out
void parallel_parts(std::size_t count,
                    const std::function<void(std::size_t, const Progress& of_part)>& body,
                    const Progress& progress);

}  // namespace lamina
