// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"

namespace lamina::surface_detail {

/// Places as rows of x, y, z of their positions, then of their normals.
using PlaceRows = std::array<std::vector<float>, 6>;

/// Numbers that each row has besides its places, of any value: they are read, but not used.
inline constexpr std::size_t padding_of_rows = 8;

struct PlaceRange {
  std::uint32_t first, end;
};

/// Places of some ranges nearer to a position than `reach` [mm], whose normals make a cosine above
/// `least_facing` with a normal.
/// @param found  takes the numbers of the first of them, as many as it has room for
/// @return       how many were taken
[[nodiscard]] std::size_t find_near_places(const PlaceRows& places,
                                           std::span<const PlaceRange> ranges,
                                           const Vec3f& position, const Vec3f& normal, float reach,
                                           float least_facing, std::span<std::uint32_t> found);

}  // namespace lamina::surface_detail
