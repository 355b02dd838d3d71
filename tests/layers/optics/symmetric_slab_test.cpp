// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/symmetric_slab.h"

#include <gtest/gtest.h>

namespace lamina {
namespace {

LayerStack coated() {
  return LayerStack({{.medium = {.sigma_s = 1.0, .ior = 1.5}, .thickness = 0.1, .top = {0.2}},
                     {.medium = {.sigma_s = 2.0, .ior = 1.4}, .thickness = 0.3, .top = {0.1}},
                     {.medium = {.sigma_s = 3.0, .ior = 1.3}, .top = {0.05}}},
                    1.0, 1.3);
}

TEST(SymmetricSlab, IsItsOwnMirrorImage) {
  const LayerStack slab = make_slab(coated(), 2.0), turned = flipped(slab);
  ASSERT_EQ(slab.layers().size(), 5u);
  double thickness = 0.0;
  for (std::size_t l = 0; l < 5; ++l) {
    const Layer &a = slab.layers()[l], &b = turned.layers()[l];
    EXPECT_EQ(a.medium.sigma_s, b.medium.sigma_s);
    EXPECT_EQ(a.thickness, b.thickness);
    EXPECT_EQ(a.top.roughness, b.top.roughness);
    thickness += a.thickness;
  }
  EXPECT_DOUBLE_EQ(thickness, 2.0);
  EXPECT_EQ(slab.ior_below(), 1.0);
}

TEST(SymmetricSlab, KeepsTheThicknessOfItsInnerLayer) {
  EXPECT_DOUBLE_EQ(thickness_of_upper_layers(coated()), 0.4);
  EXPECT_EQ(slab_with_inner_thickness(coated(), 0.7).layers()[2].thickness, 0.7);
  // Thinner than its coats: a tenth is left of the inner layer.
  EXPECT_DOUBLE_EQ(make_slab(coated(), 0.5).layers()[2].thickness, 0.05);
}

}  // namespace
}  // namespace lamina
