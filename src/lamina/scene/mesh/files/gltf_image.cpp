// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/files/gltf_image.h"

#include <charconv>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_input.h"
#include "lamina/scene/mesh/files/internal/gltf_data.h"

namespace lamina {

std::optional<GltfImageName> gltf_image_name(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::size_t at = name.rfind('#');
  if (at == std::string::npos) return std::nullopt;
  const std::filesystem::path file = name.substr(0, at);
  if (file.extension() != ".glb" && file.extension() != ".gltf") return std::nullopt;
  std::size_t index = 0;
  const char* const end = name.data() + name.size();
  const auto [last, code] = std::from_chars(name.data() + at + 1, end, index);
  if (code != std::errc() || last != end) return std::nullopt;
  return GltfImageName{file, index};
}

std::string load_gltf_image(const GltfImageName& name, MemoryBudget& memory) {
  const std::string bytes = read_file_bytes(name.file, memory);
  const GltfChunks chunks = split_gltf(bytes, name.file.string());
  std::string_view text = chunks.json;
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.remove_suffix(1);
  const JsonDocument document = parse_json(text, name.file.string(), memory);
  const JsonInput root = document.root();
  const std::vector<JsonInput> images = gltf_list(root, "images");
  if (name.index >= images.size())
    throw FileError(name.file.string() + ": has no image " + std::to_string(name.index) + ", but " +
                    std::to_string(images.size()) + " of them");
  const JsonInput& image = images[name.index];
  GltfData data(root, chunks.binary, name.file);
  if (const auto view = image.peek("bufferView")) {
    const std::string_view found = data.view_bytes(*view);
    take_memory(memory, found.size(), image.where());
    return std::string(found);
  }
  const auto uri = image.peek("uri");
  if (!uri) image.fail("\"uri\" or \"bufferView\" is required, but missing");
  return load_gltf_uri(*uri, name.file.parent_path());
}

}  // namespace lamina
