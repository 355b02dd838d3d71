// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/light_window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "lamina/base/core/error.h"
#include "lamina/skin/acquire/calibration/pixel_mask.h"
#include "skin/acquire/calibration/synthetic_images.h"

namespace lamina {
namespace {

const std::array<Vec2, 4> tape = {Vec2{41.3, 30.7}, {152.6, 38.2}, {147.4, 131.9}, {35.2, 120.4}};

/// Skin in the window of a tape that reflects 3 %, in noise.
Image taped_skin(double noise, std::uint64_t seed) {
  const Image window = polygon_image(tape, 192, 160);
  Image image = image_of(192, 160, {"540nm", "640nm"}, [&](double x, double y, std::size_t c) {
    const double skin = (c == 0 ? 0.25 : 0.4) * skin_texture(x, y, 0.1) * (1.2 - 0.002 * x);
    const double light =
        static_cast<double>(window.at(static_cast<int>(x), static_cast<int>(y))[0]);
    return 0.03 + light * skin;
  });
  add_noise(image, noise * noise, 0.0, seed);
  return image;
}

double largest_error(const std::array<Vec2, 4>& found, const std::array<Vec2, 4>& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < 4; ++i)
    largest = std::max(largest, std::hypot(found[i].x - truth[i].x, found[i].y - truth[i].y));
  return largest;
}

TEST(LightWindow, IsFoundToATenthOfAPixel) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Image image = taped_skin(0.004, seed);
    image.at(60, 70)[0] = std::numeric_limits<float>::quiet_NaN();  // a dead pixel
    image.at(10, 10)[0] = image.at(11, 10)[0] = 2.0f;               // something bright on the tape
    const LightWindow window = find_light_window(image, "a.tif");
    EXPECT_LT(largest_error(window.corners, tape), 0.1);
    EXPECT_LT(window.error, 0.1);
    EXPECT_LT(window.roughness, 0.3);
  }
}

TEST(LightWindow, IsNotFoundWhereThereIsNone) {
  const auto refuses = [](const Image& image) {
    EXPECT_THROW((void)find_light_window(image, "a.tif"), InvalidInput);
  };
  refuses(make_image(64, 64, {"Y"}));
  refuses(image_of(160, 120, {"Y"},
                   [](double x, double y, std::size_t) { return 0.4 * skin_texture(x, y, 0.2); }));
  refuses(image_of(160, 120, {"Y"}, [](double x, double y, std::size_t) {  // a round hole
    return std::hypot(x - 80.0, y - 60.0) < 40.0 ? 0.4 : 0.03;
  }));
  refuses(image_of(160, 120, {"Y"}, [](double x, double y, std::size_t) {  // three corners
    return x > 20.0 && y > 20.0 && x + y < 130.0 ? 0.4 : 0.03;
  }));
  refuses(image_of(160, 120, {"Y"}, [](double x, double, std::size_t) {  // cut by the image
    return x > 20.0 ? 0.4 : 0.03;
  }));
}

// The area of a polygon, whole and of each pixel: against many points in it.
TEST(PolygonImage, CoversPixelsExactly) {
  const std::vector<Vec2> star = {{3.2, 1.1},   {7.5, 4.4}, {12.9, 2.3}, {9.4, 7.2},
                                  {11.3, 12.8}, {6.6, 8.9}, {1.2, 11.4}, {4.1, 6.3}};
  for (const bool is_turned : {false, true}) {
    std::vector<Vec2> corners = star;
    if (is_turned) std::ranges::reverse(corners);
    const Image image = polygon_image(corners, 14, 14);
    double twice = 0.0;
    for (std::size_t i = 0; i < star.size(); ++i) {
      const Vec2 a = star[i], b = star[(i + 1) % star.size()];
      twice += a.x * b.y - a.y * b.x;
    }
    const double sum = std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0);
    EXPECT_NEAR(sum, std::abs(0.5 * twice), 1e-5);
    const auto is_inside = [&](double x, double y) {
      bool inside = false;
      for (std::size_t i = 0; i < star.size(); ++i) {
        const Vec2 a = star[i], b = star[(i + 1) % star.size()];
        if ((a.y > y) != (b.y > y) && x < a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x))
          inside = !inside;
      }
      return inside;
    };
    constexpr int n = 40;
    for (int y = 0; y < 14; ++y)
      for (int x = 0; x < 14; ++x) {
        int count = 0;
        for (int k = 0; k < n * n; ++k)
          count += is_inside(x + (k % n + 0.5) / n, y + (k / n + 0.5) / n) ? 1 : 0;
        ASSERT_NEAR(image.at(x, y)[0], count / double(n * n), 0.03) << x << " " << y;
      }
  }
}

TEST(PolygonImage, MayReachBeyondTheImage) {
  const Image image = polygon_image(
      std::vector<Vec2>{{-10.0, -20.0}, {4.5, -20.0}, {4.5, 50.0}, {-10.0, 50.0}}, 9, 7);
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 9; ++x)
      EXPECT_NEAR(image.at(x, y)[0], x < 4 ? 1.0 : x == 4 ? 0.5 : 0.0, 1e-6);
  EXPECT_EQ(count_pixels(mask_from_image(image)).used, 35u);
  const Image outside =
      polygon_image(std::vector<Vec2>{{20.0, 1.0}, {30.0, 1.0}, {25.0, 5.0}}, 9, 7);
  EXPECT_EQ(count_pixels(mask_from_image(outside)).used, 0u);

  const auto refuses = [](const std::vector<Vec2>& corners) {
    EXPECT_THROW((void)polygon_image(corners, 9, 7), InvalidInput);
  };
  refuses({{0, 0}, {1, 1}});
  refuses({{0, 0}, {1, 1}, {2, 2}});
  refuses({{0, 0}, {4, 4}, {4, 0}, {0, 4}});  // a bow tie
  refuses({{0, 0}, {4, std::nan("")}, {4, 0}});
}

}  // namespace
}  // namespace lamina
