// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Recipes of maps, flat and over meshes.
#include "fuzz_input.h"
#include "lamina/scene/skin_surface/surface_skin_maps.h"
#include "lamina/skin/maps/files/skin_features_file.h"
#include "lamina/skin/maps/skin_features.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lamina;
  return fuzz::read_or_refuse([&] {
    const JsonFile file(fuzz::corpus_file("maps"), std::string(fuzz::text_of(data, size)));
    if (!load_surface_map_recipe(file, {fuzz::most_memory}))
      static_cast<void>(load_skin_map_recipe(file, {fuzz::most_memory}));
  });
}
