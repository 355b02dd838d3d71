// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lamina/exchange/export_format.h"

// What formats of photon Monte Carlo have in common: layers as they are, but for what no such
// program knows.

namespace lamina::detail {

/// Notes on features of the material that `program` does not know.
[[nodiscard]] std::vector<std::string> notes_of_photons(const std::string& program,
                                                        const ExportInput& input);

/// Totals of a normal beam on the layers that were written, by adding-doubling, beside those of the
/// material.
[[nodiscard]] std::vector<ChannelMisfit> beam_misfits(const ExportInput& input,
                                                      std::span<const LayerStack> written);

}  // namespace lamina::detail
