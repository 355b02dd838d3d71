// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// Renders a scene file to a PNG: 01_render_head SCENE IMAGE.png [SAMPLES]
#include <cstdlib>
#include <iostream>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/tone.h"
#include "lamina/render/render.h"

int main(int argc, char** argv) try {
  if (argc < 3) throw lamina::InvalidInput("usage: 01_render_head SCENE IMAGE.png [SAMPLES]");
  lamina::Scene scene = lamina::load_scene(argv[1]);
  if (argc > 3) scene.render.samples_per_pixel = std::atoi(argv[3]);
  const lamina::RenderResult result = lamina::render(scene);
  lamina::save_png(lamina::view_image(lamina::rgb_image(result.image), lamina::View::filmic,
                                      scene.film.exposure),
                   argv[2]);
  std::cout << result.statistics.cpu_seconds << " s CPU\n";
} catch (const lamina::Error& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
