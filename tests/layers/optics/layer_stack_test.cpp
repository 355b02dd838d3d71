// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/layer_stack.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(LayerStack, NamesTheLayerTheRuleAndTheValueOfWrongInput) {
  const auto stack_with = [](const Layer& layer) {
    return [layer] { LayerStack({{.medium = {.sigma_s = 1.0}, .thickness = 1.0}, layer}); };
  };
  EXPECT_EQ(message_of(stack_with({.medium = {.sigma_a = std::nan("")}})),
            "layer 1: sigma_a must be >= 0 [1/mm], but is nan");
  EXPECT_EQ(message_of(stack_with({.medium = {.g = 1.0}})),
            "layer 1: g must lie in (-1, 1), but is 1");
  EXPECT_EQ(message_of(stack_with({.thickness = 0.0})),
            "layer 1: thickness must be > 0 [mm], but is 0");
  EXPECT_EQ(message_of(stack_with({.medium = {.g = 0.5}, .phase = Rayleigh{}})),
            "layer 1: g must be the mean cosine of the phase function, 0, but is 0.5");
  EXPECT_EQ(message_of([] {
              LayerStack({Layer{}, Layer{}});
            }),
            "layer 0: thickness must be finite above the bottom layer [mm], but is inf");
  EXPECT_NE(message_of([] { LayerStack({}); }), "");
}

TEST(LayerStack, BelowAHalfSpaceContinuesItsMedium) {
  EXPECT_EQ(LayerStack({{.medium = {.ior = 1.4}}}, 1.0, 1.0).ior_below(), 1.4);
}

TEST(LayerStack, FlippedTwiceIsItself) {
  const LayerStack stack({{.medium = {.ior = 1.4}, .thickness = 1.0, .top = {.roughness = 0.1}},
                          {.medium = {.ior = 1.5}, .thickness = 2.0, .top = {.roughness = 0.2}}},
                         1.0, 1.33, {.top = {.roughness = 0.3}});
  const LayerStack once = flipped(stack);
  EXPECT_EQ(once.layers()[0].thickness, 2.0);
  EXPECT_EQ(once.layers()[0].top.roughness, 0.3);
  EXPECT_EQ(once.layers()[1].top.roughness, 0.2);
  EXPECT_EQ(once.ground().top.roughness, 0.1);
  EXPECT_EQ(once.ior_above(), 1.33);
  EXPECT_EQ(flipped(once).layers()[0].top.roughness, 0.1);
}

}  // namespace
}  // namespace lamina
