// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/vec.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace lamina {
namespace {

TEST(Frame, IsOrthonormalAndRightHandedForEveryNormal) {
  for (const Vec3& v : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{1e-9, -1e-9, -1},
                        Vec3{0.3, -0.5, 0.1}}) {
    const Frame frame = make_frame(normalize(v));
    EXPECT_NEAR(dot(frame.x, frame.y), 0.0, 1e-15);
    EXPECT_NEAR(length(cross(frame.x, frame.y) - frame.z), 0.0, 1e-14);
    const Vec3 w{0.1, 0.2, 0.3};
    EXPECT_NEAR(length(frame.to_world(frame.to_local(w)) - w), 0.0, 1e-15);
  }
}

TEST(Reflect, KeepsTheAngleToTheNormal) {
  const Vec3 n = normalize(Vec3{1, 2, 3}), w = normalize(Vec3{-1, 0.5, 2});
  EXPECT_NEAR(dot(reflect(w, n), n), dot(w, n), 1e-15);
  EXPECT_NEAR(length(reflect(w, n)), 1.0, 1e-15);
}

}  // namespace
}  // namespace lamina
