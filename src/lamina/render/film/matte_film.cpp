// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/film/matte_film.h"

#include <algorithm>
#include <filesystem>
#include <string>

namespace lamina {

void MatteFilm::add(int x, int y, const CameraSample& sample) {
  Pixel& pixel = pixels_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)];
  ++pixel.samples;
  if (!sample.is_hit) return;
  const auto same = std::ranges::find_if(pixel.met, [&](const Count& count) {
    return count.mesh == sample.mesh && count.material == sample.material;
  });
  if (same != pixel.met.end())
    ++same->samples;
  else
    pixel.met.push_back({sample.mesh, sample.material, 1});
}

std::vector<ImageNote> MatteFilm::add_to(Image& image, const Scene& scene) const {
  std::vector<std::string> meshes, materials;
  for (const Mesh& mesh : scene.meshes)  // of a file that has no other name
    meshes.push_back(std::filesystem::path(mesh.name).filename().string());
  for (const SurfaceMaterial& material : scene.materials) materials.push_back(material.name);
  std::vector<ImageNote> notes;
  const auto add_layer = [&](std::string_view layer, const std::vector<std::string>& names,
                             std::uint32_t Count::*thing) {
    std::vector<std::vector<MatteShare>> shares(pixels_.size());
    for (std::size_t i = 0; i < pixels_.size(); ++i)
      for (const Count& count : pixels_[i].met)
        shares[i].push_back({count.*thing, static_cast<float>(count.samples) /
                                               static_cast<float>(pixels_[i].samples)});
    std::ranges::move(add_cryptomatte(image, layer, names, shares), std::back_inserter(notes));
  };
  add_layer("CryptoObject", meshes, &Count::mesh);
  add_layer("CryptoMaterial", materials, &Count::material);
  return notes;
}

}  // namespace lamina
