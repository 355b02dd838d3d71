// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/io/json_input.h"
#include "lamina/scene/mesh/files/mesh_file.h"

namespace lamina {

/// @throws FileError if the bytes are a GLB that is cut off or malformed.
[[nodiscard]] GltfChunks split_gltf(std::string_view bytes, const std::string& name);

/// The array under a key of the outermost object; empty if there is none.
[[nodiscard]] std::vector<JsonInput> gltf_list(const JsonInput& root, std::string_view key);

/// The element of a list that a value of the file is the index of.
[[nodiscard]] const JsonInput& gltf_element(const std::vector<JsonInput>& list,
                                            const JsonInput& index);

/// A member of an object that is a whole number >= 0, such as a length in bytes.
[[nodiscard]] std::size_t gltf_size(const JsonInput& object, std::string_view key,
                                    std::int64_t otherwise);

/// Where a URI of the file points. A glTF file comes from strangers: what it names must lie beside
/// it.
[[nodiscard]] std::filesystem::path gltf_path(const JsonInput& uri,
                                              const std::filesystem::path& folder);

/// The bytes that a URI says or points to.
[[nodiscard]] std::string load_gltf_uri(const JsonInput& uri, const std::filesystem::path& folder);

/// The buffers of a glTF file, each read once: the binary chunk, data within the text, or a file in
/// the folder of the glTF file or below it. Source: [glTF2] §3.6.1.
class GltfBuffers {
 public:
  /// @param root    must outlive this.
  /// @param binary  the binary chunk of a GLB; must outlive this.
  GltfBuffers(const JsonInput& root, std::string_view binary, const std::filesystem::path& file);

  /// The bytes of a buffer, as many as it says; good as long as this lives.
  /// @throws FileError if there are fewer, or the file that holds them cannot be read or lies
  ///         elsewhere; InvalidInput if the buffer is described wrongly.
  [[nodiscard]] std::string_view bytes(const JsonInput& index);

 private:
  std::filesystem::path folder_;
  std::string_view binary_;
  std::vector<JsonInput> buffers_;
  std::vector<std::string> loaded_;                     ///< [buffer], unless it is the chunk
  std::vector<std::optional<std::string_view>> bytes_;  ///< [buffer], of those asked for
};

}  // namespace lamina
