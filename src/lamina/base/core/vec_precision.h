// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/vec.h"

namespace lamina {

[[nodiscard]] constexpr Vec3 to_double(const Vec3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
[[nodiscard]] constexpr Vec3f to_float(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
[[nodiscard]] constexpr Vec2f to_float(const Vec2& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y)};
}

}  // namespace lamina
