// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lamina/base/io/json_output.h"
#include "lamina/skin/maps/skin_maps.h"

namespace lamina {

/// The recipe "skin" as files have it that lie beside their maps: each map is the image NAME.exr,
/// all else numbers.
///
/// @param base  gives the numbers, and which inks there are
/// @param maps  by name; images are not looked at
[[nodiscard]] JsonOutput mapped_skin_json(const SkinMaps& base, std::span<const SkinMap> maps);

}  // namespace lamina
