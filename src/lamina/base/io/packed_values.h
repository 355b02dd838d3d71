// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace lamina {

/// Puts values one after the other, as this machine has them; for files of its own.
class PackedWriter {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put(values.size());
    for (const T& value : values) put(value);
  }
  void put_text(std::string_view text) {
    put(text.size());
    bytes_ += text;
  }
  [[nodiscard]] std::string bytes() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Takes them out again, in the same order. What is not there leaves values as they are.
class PackedReader {
 public:
  explicit PackedReader(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  void get(T& value) {
    is_good_ = is_good_ && rest_.size() >= sizeof value;
    if (!is_good_) return;
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
  }
  template <class T>
  void get(std::vector<T>& values) {
    std::size_t size = 0;
    get(size);
    is_good_ = is_good_ && size <= rest_.size() / sizeof(T);
    if (!is_good_) return;
    values.resize(size);
    for (T& value : values) get(value);
  }
  void get_text(std::string& text) {
    std::size_t size = 0;
    get(size);
    is_good_ = is_good_ && size <= rest_.size();
    if (!is_good_) return;
    text = rest_.substr(0, size);
    rest_.remove_prefix(size);
  }
  /// Whether all was there and nothing is left.
  [[nodiscard]] bool is_done() const { return is_good_ && rest_.empty(); }

 private:
  std::string_view rest_;
  bool is_good_ = true;
};

}  // namespace lamina
