// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/lights/sky_irradiance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/scene/description/scene.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;

// A sky that is brighter towards its pole, 1 + 0.8 cos, over surfaces of any slope: its irradiance
// is pi (1 + 2/3 0.8 n_y), as the two first spherical harmonics have it; beside it an even one.
TEST(SkyIrradiance, IsThatOfALinearSky) {
  constexpr int width = 64, height = 64;
  Scene scene;
  Image map = make_image(width, height, {"R", "G", "B"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        map.at(x, y)[c] =
            static_cast<float>((c + 1) * (1.0 + 0.8 * std::cos(pi * (y + 0.5) / height)));
  scene.images = {std::move(map)};
  scene.lights = {EnvironmentLight{.image = 0}, EnvironmentLight{.scale = {0.5f, 0.5f, 0.5f}}};
  const Lights lights(scene, {-1, -1, -1}, {1, 1, 1});
  EXPECT_TRUE(has_uneven_sky(lights));
  const SkyIrradiance sky(lights, {});
  EXPECT_NEAR(sky.entering(0.3f), 0.3f, 1e-6f);
  for (int i = 0; i < 40; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / 40.0, phi = 2.4 * i, r = std::sqrt(1.0 - z * z);
    const Vec3f normal{static_cast<float>(r * std::cos(phi)), static_cast<float>(z),
                       static_cast<float>(r * std::sin(phi))};
    for (int c = 0; c < 3; ++c) {
      const double wanted = pi * ((c + 1) * (1.0 + 2.0 / 3.0 * 0.8 * z) + 0.5);
      EXPECT_NEAR(sky.at(normal)[c], wanted, 0.004 * wanted) << z << ' ' << c;
    }
  }
}

}  // namespace
}  // namespace lamina
