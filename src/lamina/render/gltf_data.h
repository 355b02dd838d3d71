// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/core/json_input.h"

namespace lamina {

/// The two parts of a glTF file; `binary` is empty unless it is a GLB that has such a part.
struct GltfChunks {
  std::string_view json, binary;
};

/// @throws FileError if the bytes are a GLB that is cut off or malformed.
[[nodiscard]] GltfChunks split_gltf(std::string_view bytes, const std::string& name);

/// Numbers of an accessor.
struct GltfValues {
  std::size_t count = 0;       ///< of elements
  std::size_t components = 0;  ///< 1 for SCALAR, 3 for VEC3, ...
  std::vector<double> values;  ///< [element][component]; normalized integers are within [-1, 1]
};

/// Buffers, buffer views and accessors of a glTF file. Source: [glTF2] §3.6.
class GltfData {
 public:
  /// @param root    must outlive this.
  /// @param binary  the binary chunk of a GLB; must outlive this.
  GltfData(const JsonInput& root, std::string_view binary, const std::filesystem::path& file);

  /// The values of an accessor: sparse or not, interleaved or not, of any component type.
  /// @param accessor    index of the accessor, the value of an attribute.
  /// @param components  that the accessor must have.
  /// @throws FileError if the file that holds them is cut off; InvalidInput if they are described
  ///         wrongly.
  [[nodiscard]] GltfValues read_accessor(const JsonInput& accessor, std::size_t components);

 private:
  struct View {
    std::string_view bytes;
    std::size_t stride = 0;  ///< 0: tightly packed
  };
  [[nodiscard]] std::string_view buffer(const JsonInput& index);
  [[nodiscard]] View view(const JsonInput& index);
  void read_packed(const JsonInput& accessor, const View& view, std::size_t offset, int type,
                   GltfValues& into) const;
  void read_sparse(const JsonInput& accessor, const JsonInput& sparse, int type, GltfValues& into);

  std::filesystem::path file_;
  std::string_view binary_;
  std::vector<JsonInput> buffers_, views_, accessors_;
  std::vector<std::optional<std::string>> loaded_;  ///< [buffer]
};

/// The array under a key of the outermost object; empty if there is none.
[[nodiscard]] std::vector<JsonInput> gltf_list(const JsonInput& root, std::string_view key);

/// The element of a list that a value of the file is the index of.
[[nodiscard]] const JsonInput& gltf_element(const std::vector<JsonInput>& list,
                                            const JsonInput& index);

}  // namespace lamina
