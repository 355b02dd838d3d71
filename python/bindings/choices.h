// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/error.h"

namespace lamina::python {

/// The value of an enum by its name. Modules in Python have checked what users gave.
template <NamedEnum E>
[[nodiscard]] E choice(std::string_view name) {
  if (const auto found = find_enum_value<E>(name)) return *found;
  throw InvalidInput("there is no \"" + std::string(name) + "\" here");
}

}  // namespace lamina::python
