// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "all_headers.h"  // every public header of lamina, see CMakeLists.txt

int main() {
  const lamina::Material skin = lamina::find_material("donner_jensen_skin");
  const lamina::LayerStack red = lamina::layer_stack(skin, 0);
  std::printf("%s: %zu layers, %.3f mm between scattering events on top\n", skin.name.c_str(),
              red.layers().size(), 1.0 / red.layers()[0].medium.sigma_s);
  return red.layers().size() == 3 ? 0 : 1;
}
