// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "lamina/base/io/json_input.h"
#include "lamina/scene/mesh/files/internal/gltf_buffers.h"

namespace lamina {

/// The numbers of an accessor, which are read out of their buffer one by one: an accessor takes no
/// memory, however many elements it claims. Source: [glTF2] §3.6.2.
class GltfAccessor {
 public:
  [[nodiscard]] std::size_t count() const { return count_; }            ///< of elements
  [[nodiscard]] std::size_t components() const { return components_; }  ///< 1 for SCALAR, ...

  /// Divisor of integers that stand for [0, 1]: 255 or 65535; 1 of floats, 0 of other types.
  [[nodiscard]] double largest_color() const;
  [[nodiscard]] bool is_normalized() const { return is_normalized_; }

  /// One number; a normalized integer is within [-1, 1].
  /// @param element    < count().
  /// @param component  < components().
  [[nodiscard]] double operator()(std::size_t element, std::size_t component) const;

 private:
  friend class GltfData;
  /// Elements of one type, one behind the other; zeros if there are no bytes.
  struct Elements {
    std::string_view bytes;
    std::size_t stride = 0;
    int type = 0;
    [[nodiscard]] double operator()(std::size_t element, std::size_t component) const;
  };
  std::size_t count_ = 0, components_ = 0;
  bool is_normalized_ = false;
  Elements elements_;
  std::vector<std::uint32_t> replaced_;  ///< elements that differ, in rising order
  Elements replacements_;                ///< what they are
};

/// Buffer views and accessors of a glTF file, each decoded once however often it is used.
class GltfData {
 public:
  /// @param root    must outlive this.
  /// @param binary  the binary chunk of a GLB; must outlive this.
  GltfData(const JsonInput& root, std::string_view binary, const std::filesystem::path& file);

  /// An accessor: sparse or not, interleaved or not, of any component type; good as long as this.
  /// @param index       of the accessor, the value of an attribute.
  /// @param components  that the accessor must have; 0: any.
  /// @throws FileError if the file that holds its numbers is cut off; InvalidInput if they are
  ///         described wrongly.
  [[nodiscard]] const GltfAccessor& accessor(const JsonInput& index, std::size_t components);

  /// The bytes of a buffer view; good as long as this.
  [[nodiscard]] std::string_view view_bytes(const JsonInput& index) { return view(index).bytes; }

 private:
  struct View {
    std::string_view bytes;
    std::size_t stride = 0;  ///< 0: tightly packed
  };
  [[nodiscard]] const View& view(const JsonInput& index);
  [[nodiscard]] GltfAccessor decode(const JsonInput& accessor);
  void decode_sparse(const JsonInput& accessor, const JsonInput& sparse, GltfAccessor& into);

  GltfBuffers buffers_;
  std::vector<JsonInput> view_inputs_, accessor_inputs_;
  std::vector<std::optional<View>> views_;              ///< [view], of those asked for
  std::vector<std::optional<GltfAccessor>> accessors_;  ///< [accessor], of those asked for
};

}  // namespace lamina
