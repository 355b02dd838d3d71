// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lamina/base/image/image.h"

// ID mattes with coverage, as compositing programs read them: [Friedman2015].
namespace lamina {

/// MurmurHash3 of 32 bits for seed 0: the ID of a name.
/// Source: A. Appleby, MurmurHash3_x86_32, in the public domain
[[nodiscard]] std::uint32_t cryptomatte_hash(std::string_view name);

/// An ID as a channel holds it: its bits as those of a float, of whose exponent the lowest bit is
/// flipped where they would be no normal number.
[[nodiscard]] float cryptomatte_value(std::uint32_t hash);

/// How much of a pixel a thing covers.
struct MatteShare {
  std::uint32_t thing = 0;  ///< index into the names
  float cover = 0.0f;       ///< in [0, 1]
};

/// Channels LAYER00.R to LAYER02.A of an image: ID and coverage of the six things that cover most
/// of a pixel, in falling order. Things of one name are one.
///
/// @param layer   such as "CryptoObject"
/// @param shares  [y][x], of an image that has at least as many pixels
/// @return        attributes that the EXR file must have: hash, conversion and manifest
std::vector<ImageNote> add_cryptomatte(Image& image, std::string_view layer,
                                       std::span<const std::string> names,
                                       std::span<const std::vector<MatteShare>> shares);

/// Whether a channel holds bits that half precision would destroy.
[[nodiscard]] bool is_cryptomatte(std::string_view channel);

}  // namespace lamina
