// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/color_encoding.h"

namespace lamina {

std::optional<RgbEncoding> stated_encoding(ColorEncoding encoding) {
  for (const auto& [name, value] : enum_names<ColorEncoding>)
    if (value == encoding) return rgb_encoding_named(name);
  return std::nullopt;
}

}  // namespace lamina
