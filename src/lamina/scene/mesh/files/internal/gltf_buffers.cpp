// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/files/internal/gltf_buffers.h"

#include <algorithm>
#include <array>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"

namespace lamina {
namespace {

constexpr std::int64_t most_bytes = std::int64_t{1} << 40;

std::uint32_t little_endian_32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

std::string decode_base64(std::string_view text, const JsonInput& where) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<std::uint32_t, 256> digit_of{};
  digit_of.fill(64);
  for (std::uint32_t i = 0; i < digits.size(); ++i)
    digit_of[static_cast<unsigned char>(digits[i])] = i;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::uint32_t digit = digit_of[static_cast<unsigned char>(c)];
    if (digit == 64) where.fail("the data are not base64");
    bits = bits << 6 | digit;
    count += 6;
    if (count >= 8) {
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

std::filesystem::path gltf_path(const JsonInput& uri, const std::filesystem::path& folder) {
  const std::filesystem::path path = decode_percent(uri.string());
  const bool leads_out = path.is_absolute() || std::ranges::find(path, "..") != path.end();
  if (path.empty() || leads_out || path.native().find('\0') != std::string::npos)
    uri.refuse("must be data or the path of a file in the folder of the glTF file or below it");
  return folder / path;
}

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

std::size_t gltf_size(const JsonInput& object, std::string_view key, std::int64_t otherwise) {
  const auto value = object.peek(key);
  return static_cast<std::size_t>(value ? value->integer(0, most_bytes) : otherwise);
}

GltfBuffers::GltfBuffers(const JsonInput& root, std::string_view binary,
                         const std::filesystem::path& file)
    : folder_(file.parent_path()),
      binary_(binary),
      buffers_(gltf_list(root, "buffers")),
      loaded_(buffers_.size()),
      bytes_(buffers_.size()) {}

std::string load_gltf_uri(const JsonInput& uri, const std::filesystem::path& folder) {
  const std::string text = uri.string();
  if (!text.starts_with("data:")) return read_file_bytes(gltf_path(uri, folder), uri.memory());
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos || !text.substr(0, comma).ends_with(";base64"))
    uri.fail("data within the file must be base64");
  take_memory(uri.memory(), text.size(),
              uri.where() + ": its data");  // three fourths, and the copy above
  return decode_base64(std::string_view(text).substr(comma + 1), uri);
}

std::string_view GltfBuffers::bytes(const JsonInput& index) {
  const JsonInput& buffer = gltf_element(buffers_, index);
  const auto place = static_cast<std::size_t>(index.number());
  if (bytes_[place]) return *bytes_[place];
  const std::size_t size = gltf_size(buffer, "byteLength", 0);
  std::string_view bytes = binary_;
  if (const auto uri = buffer.peek("uri"))
    bytes = loaded_[place] = load_gltf_uri(*uri, folder_);
  else if (place != 0 || binary_.empty())
    buffer.fail("has no uri, nor is there a binary chunk");
  if (bytes.size() < size)
    throw FileError(buffer.where() + " is cut off: it must have " + std::to_string(size) +
                    " bytes, but has " + std::to_string(bytes.size()));
  return *(bytes_[place] = bytes.substr(0, size));
}

}  // namespace lamina
