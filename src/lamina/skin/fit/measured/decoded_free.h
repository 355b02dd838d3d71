// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lamina/base/io/json_input.h"
#include "lamina/skin/fit/measured/measurement.h"

namespace lamina::fit_detail {

/// A population by its name or file. @throws InvalidInput if the material is not of the recipe.
[[nodiscard]] SkinPopulation decode_population(const JsonInput& value,
                                               const MeasuredMaterial& material);

/// An entry of "free".
/// @param stated  what the material states, where the fit starts unless told otherwise
[[nodiscard]] FreeNumber decode_free(const JsonInput& value, std::span<const StatedNumber> stated,
                                     const Measurement& measurement);

}  // namespace lamina::fit_detail
