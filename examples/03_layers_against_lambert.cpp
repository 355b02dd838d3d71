// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// Renders two scenes and their relative difference, red where the first is brighter and blue where
// the second is, full at a third: 03_layers_against_lambert SCENE SCENE DIFFERENCE.png [SAMPLES]
//
// The right column of Hanrahan & Krueger 1993, Plate 2, is that of scenes/hanrahan_krueger/
// plate2_layered_45.json and plate2_lambert_45.json.
#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/tone.h"
#include "lamina/render/render.h"

namespace {

lamina::Image render_file(const char* file, int samples) {
  lamina::Scene scene = lamina::load_scene(file);
  if (samples > 0) scene.render.samples_per_pixel = samples;
  return lamina::rgb_image(lamina::render(scene).image);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4)
    throw lamina::InvalidInput("usage: 03_layers_against_lambert SCENE SCENE IMAGE.png [SAMPLES]");
  const int samples = argc > 4 ? std::atoi(argv[4]) : 0;
  const lamina::Image a = render_file(argv[1], samples), b = render_file(argv[2], samples);
  if (a.width != b.width || a.height != b.height)
    throw lamina::InvalidInput("the pictures of both scenes must be of the same size");
  lamina::Image difference = lamina::make_image(a.width, a.height, {"R", "G", "B"});
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      float of_a = 0.0f, of_b = 0.0f;
      for (int c = 0; c < 3; ++c) {
        of_a += a.at(x, y)[c];
        of_b += b.at(x, y)[c];
      }
      if (!(of_a + of_b > 0.0f)) continue;
      const float d = std::clamp(3.0f * (of_a - of_b) / std::max(of_a, of_b), -1.0f, 1.0f);
      float* pixel = difference.at(x, y);
      pixel[0] = d > 0.0f ? 1.0f : 1.0f + d;
      pixel[1] = 1.0f - std::abs(d);
      pixel[2] = d < 0.0f ? 1.0f : 1.0f - d;
    }
  lamina::save_png(lamina::view_image(difference, lamina::View::standard, 0.0f), argv[3]);
} catch (const lamina::Error& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
