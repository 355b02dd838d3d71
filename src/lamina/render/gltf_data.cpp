// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/gltf_data.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "lamina/core/error.h"
#include "lamina/core/file_bytes.h"
#include "lamina/render/mesh_file.h"

namespace lamina {
namespace {

constexpr std::int64_t most_bytes = std::int64_t{1} << 40;

std::uint32_t little_endian_32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

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

std::size_t whole_number(const JsonInput& object, std::string_view key, std::int64_t otherwise) {
  const auto value = object.peek(key);
  return static_cast<std::size_t>(value ? value->integer(0, most_bytes) : otherwise);
}

JsonInput required(const JsonInput& object, std::string_view key) {
  if (auto value = object.peek(key)) return *value;
  object.fail("\"" + std::string(key) + "\" is required, but missing");
}

std::string decode_base64(std::string_view text, const JsonInput& where) {
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t digit = digits.find(c);
    if (digit == std::string_view::npos) where.fail("the data are not base64");
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    if ((count += 6) >= 8) {
      count -= 8;
      bytes.push_back(static_cast<char>(bits >> count & 0xff));
    }
  }
  return bytes;
}

/// A path as a URI spells it: %20 for a blank.
std::string decode_percent(std::string_view uri) {
  const auto digit = [](char c) {
    return '0' <= c && c <= '9'   ? c - '0'
           : 'a' <= c && c <= 'f' ? c - 'a' + 10
           : 'A' <= c && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool is_code =
        uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0;
    path.push_back(is_code ? static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2]))
                           : uri[i]);
    if (is_code) i += 2;
  }
  return path;
}

}  // namespace

GltfChunks split_gltf(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("glTF")) return {.json = bytes, .binary = {}};
  const auto refuse = [&](const std::string& why) { throw FileError(name + ": " + why); };
  if (bytes.size() < 20) refuse("is cut off within the header of GLB");
  if (little_endian_32(bytes, 4) != 2)
    refuse("must be GLB of version 2, but is of version " +
           std::to_string(little_endian_32(bytes, 4)));
  const std::size_t length = little_endian_32(bytes, 8);
  if (length > bytes.size())
    refuse("is cut off: the header promises " + std::to_string(length) + " bytes, but there are " +
           std::to_string(bytes.size()));
  GltfChunks chunks;
  for (std::size_t at = 12; at + 8 <= length;) {
    const std::size_t size = little_endian_32(bytes, at);
    if (size > length - at - 8) refuse("a chunk of GLB is longer than the file");
    const std::string_view chunk = bytes.substr(at + 8, size);
    const std::string_view type = bytes.substr(at + 4, 4);
    if (type == "JSON" && chunks.json.empty()) chunks.json = chunk;
    if (type == std::string_view("BIN\0", 4) && chunks.binary.empty()) chunks.binary = chunk;
    at += 8 + (size + 3) / 4 * 4;
  }
  if (chunks.json.empty()) refuse("the GLB has no JSON chunk");
  return chunks;
}

std::vector<JsonInput> gltf_list(const JsonInput& root, std::string_view key) {
  const auto list = root.peek(key);
  return list ? list->array() : std::vector<JsonInput>{};
}

const JsonInput& gltf_element(const std::vector<JsonInput>& list, const JsonInput& index) {
  if (list.empty()) index.fail("is an index into a list that is empty");
  return list[static_cast<std::size_t>(
      index.integer(0, static_cast<std::int64_t>(list.size()) - 1))];
}

GltfData::GltfData(const JsonInput& root, std::string_view binary,
                   const std::filesystem::path& file)
    : file_(file),
      binary_(binary),
      buffers_(gltf_list(root, "buffers")),
      views_(gltf_list(root, "bufferViews")),
      accessors_(gltf_list(root, "accessors")),
      loaded_(buffers_.size()) {}

std::string_view GltfData::buffer(const JsonInput& index) {
  const JsonInput& description = gltf_element(buffers_, index);
  const auto place = static_cast<std::size_t>(index.integer(0, most_bytes));
  const std::size_t size = whole_number(description, "byteLength", 0);
  const auto uri = description.peek("uri");
  std::string_view bytes;
  if (!uri) {
    if (place != 0 || binary_.empty()) description.fail("has no uri, nor is there a binary chunk");
    bytes = binary_;
  } else {
    if (!loaded_[place]) {
      const std::string text = uri->string();
      const std::size_t comma = text.find(',');
      if (!text.starts_with("data:")) {
        loaded_[place] = read_file_bytes(file_.parent_path() / decode_percent(text));
      } else if (comma != std::string::npos && text.substr(0, comma).ends_with(";base64")) {
        loaded_[place] = decode_base64(std::string_view(text).substr(comma + 1), *uri);
      } else {
        uri->fail("data within the file must be base64");
      }
    }
    bytes = *loaded_[place];
  }
  if (bytes.size() < size)
    throw FileError(description.where() + " is cut off: it must have " + std::to_string(size) +
                    " bytes, but has " + std::to_string(bytes.size()));
  return bytes.substr(0, size);
}

GltfData::View GltfData::view(const JsonInput& index) {
  const JsonInput& description = gltf_element(views_, index);
  if (const auto extensions = description.peek("extensions"))
    if (extensions->peek("EXT_meshopt_compression"))
      description.fail("is compressed (EXT_meshopt_compression), which lamina does not read");
  const std::string_view bytes = buffer(required(description, "buffer"));
  const std::size_t offset = whole_number(description, "byteOffset", 0);
  const std::size_t size = whole_number(description, "byteLength", 0);
  if (offset > bytes.size() || size > bytes.size() - offset)
    description.fail("reaches beyond the end of its buffer of " + std::to_string(bytes.size()) +
                     " bytes");
  return {.bytes = bytes.substr(offset, size),
          .stride = whole_number(description, "byteStride", 0)};
}

void GltfData::read_packed(const JsonInput& accessor, const View& view, std::size_t offset,
                           int type, GltfValues& into) const {
  const std::size_t element = into.components * size_of(type);
  const std::size_t stride = view.stride == 0 ? element : view.stride;
  const std::size_t size = view.bytes.size();
  if (into.count > 0 && (offset > size || element > size - offset ||
                         (into.count - 1) > (size - offset - element) / stride))
    accessor.fail("its " + std::to_string(into.count) +
                  " elements reach beyond the end of their buffer view of " + std::to_string(size) +
                  " bytes");
  into.values.resize(into.count * into.components);
  for (std::size_t i = 0; i < into.count; ++i)
    for (std::size_t c = 0; c < into.components; ++c)
      into.values[i * into.components + c] =
          component(view.bytes.data() + offset + i * stride + c * size_of(type), type);
}

void GltfData::read_sparse(const JsonInput& accessor, const JsonInput& sparse, int type,
                           GltfValues& into) {
  const JsonInput indices = required(sparse, "indices"), values = required(sparse, "values");
  GltfValues places{.count = whole_number(sparse, "count", 0), .components = 1, .values = {}};
  GltfValues changes{.count = places.count, .components = into.components, .values = {}};
  read_packed(accessor, view(required(indices, "bufferView")),
              whole_number(indices, "byteOffset", 0),
              component_type(required(indices, "componentType")), places);
  read_packed(accessor, view(required(values, "bufferView")), whole_number(values, "byteOffset", 0),
              type, changes);
  for (std::size_t i = 0; i < places.count; ++i) {
    if (!(places.values[i] >= 0.0 && places.values[i] < static_cast<double>(into.count)))
      sparse.fail("an index must be < " + std::to_string(into.count));
    const auto place = static_cast<std::size_t>(places.values[i]);
    std::copy_n(changes.values.begin() + static_cast<std::ptrdiff_t>(i * into.components),
                into.components,
                into.values.begin() + static_cast<std::ptrdiff_t>(place * into.components));
  }
}

GltfValues GltfData::read_accessor(const JsonInput& index, std::size_t components) {
  constexpr std::array<std::string_view, 4> types = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  const JsonInput& accessor = gltf_element(accessors_, index);
  if (required(accessor, "type").choice(types) + 1 != components)
    required(accessor, "type").refuse("must be \"" + std::string(types[components - 1]) + "\"");
  const int type = component_type(required(accessor, "componentType"));
  GltfValues result{
      .count = whole_number(accessor, "count", 0), .components = components, .values = {}};
  const auto sparse = accessor.peek("sparse");
  if (const auto view_index = accessor.peek("bufferView")) {
    read_packed(accessor, view(*view_index), whole_number(accessor, "byteOffset", 0), type, result);
  } else {  // zeros, which take no room in the file: limit what is promised
    if (result.count > 10'000'000) accessor.fail("has more than 10 million elements, but no data");
    result.values.resize(result.count * components);
  }
  if (sparse) read_sparse(accessor, *sparse, type, result);
  const auto normalized = accessor.peek("normalized");
  if (normalized && normalized->boolean())
    for (double& value : result.values) value = std::max(value / largest(type), -1.0);
  return result;
}

}  // namespace lamina
