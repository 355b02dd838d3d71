// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/files/internal/gltf_data.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "lamina/base/core/error.h"
#include "lamina/scene/mesh/polygon_mesh.h"

namespace lamina {
namespace {

constexpr std::array<std::string_view, 4> types = {"SCALAR", "VEC2", "VEC3", "VEC4"};

enum ComponentType {
  byte = 5120,
  unsigned_byte = 5121,
  signed_short = 5122,
  unsigned_short = 5123,
  unsigned_int = 5125,
  float_32 = 5126,
};

std::size_t size_of(int type) {
  return type == byte || type == unsigned_byte            ? 1
         : type == signed_short || type == unsigned_short ? 2
                                                          : 4;
}

int component_type(const JsonInput& value) {
  const auto type = static_cast<int>(value.integer(byte, float_32));
  if (type == 5124) value.refuse("must be 5120, 5121, 5122, 5123, 5125 or 5126");
  return type;
}

/// What normalized integers of a type are divided by.
double largest(int type) {
  switch (type) {
    case byte:
      return 127.0;
    case unsigned_byte:
      return 255.0;
    case signed_short:
      return 32767.0;
    case unsigned_short:
      return 65535.0;
    default:
      return 1.0;
  }
}

double component(const char* bytes, int type) {
  static_assert(std::endian::native == std::endian::little, "glTF data are little-endian");
  const auto as = [&]<class T>(T value) {
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case byte:
      return as(std::int8_t{});
    case unsigned_byte:
      return as(std::uint8_t{});
    case signed_short:
      return as(std::int16_t{});
    case unsigned_short:
      return as(std::uint16_t{});
    case unsigned_int:
      return as(std::uint32_t{});
    default:
      return as(float{});
  }
}

JsonInput required(const JsonInput& object, std::string_view key) {
  if (auto value = object.peek(key)) return *value;
  object.fail("\"" + std::string(key) + "\" is required, but missing");
}

/// The bytes of a view in which `count` elements of `size` bytes lie, one after each `stride`.
std::string_view checked_bytes(const JsonInput& accessor, std::string_view bytes,
                               std::size_t offset, std::size_t count, std::size_t size,
                               std::size_t stride) {
  if (count > 0 && (offset > bytes.size() || size > bytes.size() - offset ||
                    count - 1 > (bytes.size() - offset - size) / stride))
    accessor.fail("its " + std::to_string(count) +
                  " elements reach beyond the end of their buffer view of " +
                  std::to_string(bytes.size()) + " bytes");
  return count > 0 ? bytes.substr(offset) : std::string_view();
}

}  // namespace

double GltfAccessor::Elements::operator()(std::size_t element, std::size_t component) const {
  if (bytes.empty()) return 0.0;
  return lamina::component(bytes.data() + element * stride + component * size_of(type), type);
}

double GltfAccessor::largest_color() const {
  const bool is_unsigned = elements_.type == unsigned_byte || elements_.type == unsigned_short;
  return is_unsigned || elements_.type == float_32 ? largest(elements_.type) : 0.0;
}

double GltfAccessor::operator()(std::size_t element, std::size_t component) const {
  const auto found = std::ranges::lower_bound(replaced_, element);
  const double value =
      found != replaced_.end() && *found == element
          ? replacements_(static_cast<std::size_t>(found - replaced_.begin()), component)
          : elements_(element, component);
  return is_normalized_ ? std::max(value / largest(elements_.type), -1.0) : value;
}

GltfData::GltfData(const JsonInput& root, std::string_view binary,
                   const std::filesystem::path& file)
    : buffers_(root, binary, file),
      view_inputs_(gltf_list(root, "bufferViews")),
      accessor_inputs_(gltf_list(root, "accessors")),
      views_(view_inputs_.size()),
      accessors_(accessor_inputs_.size()) {}

const GltfData::View& GltfData::view(const JsonInput& index) {
  const JsonInput& description = gltf_element(view_inputs_, index);
  std::optional<View>& view = views_[static_cast<std::size_t>(index.number())];
  if (view) return *view;
  if (const auto extensions = description.peek("extensions"))
    if (extensions->peek("EXT_meshopt_compression"))
      description.fail("is compressed (EXT_meshopt_compression), which lamina does not read");
  const std::string_view bytes = buffers_.bytes(required(description, "buffer"));
  const std::size_t offset = gltf_size(description, "byteOffset", 0);
  const std::size_t size = gltf_size(description, "byteLength", 0);
  if (offset > bytes.size() || size > bytes.size() - offset)
    description.fail("reaches beyond the end of its buffer of " + std::to_string(bytes.size()) +
                     " bytes");
  return *(view = View{.bytes = bytes.substr(offset, size),
                       .stride = gltf_size(description, "byteStride", 0)});
}

void GltfData::decode_sparse(const JsonInput& accessor, const JsonInput& sparse,
                             GltfAccessor& into) {
  const JsonInput indices = required(sparse, "indices"), values = required(sparse, "values");
  const std::size_t count = gltf_size(sparse, "count", 0);
  const auto elements = [&](const JsonInput& given, int type, std::size_t components) {
    const std::size_t size = components * size_of(type);
    const View& where = view(required(given, "bufferView"));
    return GltfAccessor::Elements{
        .bytes = checked_bytes(accessor, where.bytes, gltf_size(given, "byteOffset", 0), count,
                               size, size),
        .stride = size,
        .type = type};
  };
  const GltfAccessor::Elements places =
      elements(indices, component_type(required(indices, "componentType")), 1);
  into.replacements_ = elements(values, into.elements_.type, into.components_);
  take_memory(sparse.memory(), count, sizeof(std::uint32_t), sparse.where());
  into.replaced_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double place = places(i, 0);
    if (!(place >= 0.0 && place < static_cast<double>(into.count_)))
      sparse.fail("an index must be < " + std::to_string(into.count_));
    if (i > 0 && place <= into.replaced_.back())
      sparse.fail("its indices must rise, but index " + std::to_string(i) + " does not");
    into.replaced_.push_back(static_cast<std::uint32_t>(place));
  }
}

GltfAccessor GltfData::decode(const JsonInput& accessor) {
  GltfAccessor result;
  result.components_ = required(accessor, "type").choice(types) + 1;
  result.count_ = gltf_size(accessor, "count", 0);
  if (result.count_ >= no_index) accessor.fail("must have fewer than 4294967295 elements");
  const int type = component_type(required(accessor, "componentType"));
  const std::size_t size = result.components_ * size_of(type);
  result.elements_.type = type;
  if (const auto index = accessor.peek("bufferView")) {
    const View& where = view(*index);
    result.elements_.stride = where.stride == 0 ? size : where.stride;
    result.elements_.bytes =
        checked_bytes(accessor, where.bytes, gltf_size(accessor, "byteOffset", 0), result.count_,
                      size, result.elements_.stride);
  }
  if (const auto normalized = accessor.peek("normalized"))
    result.is_normalized_ = normalized->boolean();
  if (const auto sparse = accessor.peek("sparse")) decode_sparse(accessor, *sparse, result);
  return result;
}

const GltfAccessor& GltfData::accessor(const JsonInput& index, std::size_t components) {
  const JsonInput& input = gltf_element(accessor_inputs_, index);
  std::optional<GltfAccessor>& accessor = accessors_[static_cast<std::size_t>(index.number())];
  if (!accessor) accessor = decode(input);
  if (components > 0 && accessor->components() != components)
    required(input, "type").refuse("must be \"" + std::string(types[components - 1]) + "\"");
  return *accessor;
}

}  // namespace lamina
