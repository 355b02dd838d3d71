// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/optics/fresnel.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lamina {
namespace {

TEST(Fresnel, LightRetracesItsPathWithTheSameReflectance) {
  for (const double eta : {1.01, 1.33, 1.5, 2.4})
    for (const double cos_i : {0.05, 0.3, 0.7, 1.0}) {
      const double cos_t = std::sqrt(1.0 - (1.0 - cos_i * cos_i) / (eta * eta));
      EXPECT_NEAR(fresnel(cos_t, 1.0 / eta), fresnel(cos_i, eta), 1e-14) << "eta " << eta;
    }
}

TEST(Fresnel, AtNormalIncidenceIsTheSquareOfTheIndexContrast) {
  EXPECT_NEAR(fresnel(1.0, 1.5), 0.04, 1e-15);
  EXPECT_NEAR(fresnel(1.0, 1.4), std::pow(0.4 / 2.4, 2), 1e-15);
}

TEST(Fresnel, ReflectsEverythingBeyondTheCriticalAngleAndAtGrazing) {
  EXPECT_EQ(fresnel(0.5, 1.0 / 1.5), 1.0);
  EXPECT_NEAR(fresnel(0.0, 1.5), 1.0, 1e-15);
  EXPECT_EQ(fresnel(0.3, 1.0), 0.0);
}

}  // namespace
}  // namespace lamina
