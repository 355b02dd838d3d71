// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lamina/base/io/json_output.h"
#include "lamina/exchange/medium_fit/homogeneous_fit.h"

namespace lamina {

/// Misfits as every file and result has them: an array with an object per channel.
[[nodiscard]] JsonOutput misfit_json(std::span<const ChannelMisfit> misfits);

}  // namespace lamina
