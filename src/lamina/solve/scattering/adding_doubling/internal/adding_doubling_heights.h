// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace lamina::detail {

/// Heights of light between facets, as Gauss nodes in u, the fraction of facets that are lower.
inline constexpr std::size_t heights = 10;
using HeightShares = std::array<double, heights>;

[[nodiscard]] const HeightShares& facet_heights();

/// Shares of light from height u that meets its next facet at each height. Rising light is blocked
/// below u' with probability 1 - (u / u')^Lambda, falling light above it with 1 - (u' / u)^(1 +
/// Lambda). Source: [Heitz2016].
[[nodiscard]] HeightShares next_heights(double u, double lambda, bool is_rising);

}  // namespace lamina::detail
