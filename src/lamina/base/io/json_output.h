// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <ranges>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "lamina/base/io/json_input.h"

// Writes JSON: values are put together, then turned to text as a whole.
//
//   JsonOutput json = {{"lamina", "patch"}, {"version", 1}};
//   json["skin"]["melanin"] = 0.15;
//   for (const double wavelength : wavelengths) json["bands"].push_back(wavelength);
//   write_file(file, json.text(1) + "\n");

namespace lamina {

/// A value that is to be written as JSON. Objects keep the order in which keys are added. A value
/// that is null becomes an object or an array with the first key or element that it is given.
class JsonOutput {
 public:
  struct Entry;

  JsonOutput() = default;  ///< null
  JsonOutput(std::nullptr_t);
  JsonOutput(std::initializer_list<Entry> entries);  ///< an object
  JsonOutput(std::string text);
  JsonOutput(std::string_view text);
  JsonOutput(const char* text);
  JsonOutput(std::same_as<bool> auto value) : value_(value) {}
  template <std::floating_point T>
  JsonOutput(T value);
  template <std::integral T>
  requires(!std::same_as<T, bool>) JsonOutput(T value)
      : value_(static_cast<std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>>(
            value)) {}
  /// An array of what a container holds.
  template <std::ranges::input_range Values>
  requires(!std::convertible_to<const Values&, std::string_view>) JsonOutput(const Values& values);
  /// A copy of what was read; a whole number stays one.
  explicit JsonOutput(const JsonInput& input);

  [[nodiscard]] static JsonOutput array(std::initializer_list<JsonOutput> elements = {});
  [[nodiscard]] static JsonOutput object();

  /// The value of a key of an object, null if it is new.
  JsonOutput& operator[](std::string_view key);
  /// Takes over all keys of another object; those that are there keep their place.
  void update(const JsonOutput& other);
  void erase(std::string_view key);

  JsonOutput& push_back(JsonOutput element);
  template <class... Arguments>
  JsonOutput& emplace_back(Arguments&&... arguments) {
    return push_back(JsonOutput(std::forward<Arguments>(arguments)...));
  }
  [[nodiscard]] JsonOutput& back() { return std::get<Array>(value_).back(); }
  [[nodiscard]] const JsonOutput& front() const { return std::get<Array>(value_).front(); }

  /// Elements or keys.
  [[nodiscard]] std::size_t size() const;

  /// Text: numbers with the fewest digits that read back to the same double, all others null.
  /// @param indent  spaces per level, with an element a line; in one line without spaces if
  /// negative
  [[nodiscard]] std::string text(int indent = -1) const;

  /// @throws WriteError naming the first number that is infinite or none, and its place, such as
  ///         `rows[2].diffusion`
  void require_numbers(const std::string& place = "") const;

 private:
  using Array = std::vector<JsonOutput>;
  using Object = std::vector<Entry>;
  explicit JsonOutput(Object entries);
  void write(std::string& text, int indent, std::size_t column) const;

  /// Not trivial to copy: of a variant of none but trivial types, strings and vectors, the library
  /// of GCC 12 takes for granted that it has a value, and destroys one that it has not when copying
  /// it finds no memory.
  struct Null {
    Null() = default;
    Null(const Null&) noexcept {}  // NOLINT: see above
    Null& operator=(const Null&) noexcept { return *this; }
  };
  std::variant<Null, bool, std::int64_t, std::uint64_t, double, std::string, Array, Object> value_;
};

struct JsonOutput::Entry {
  std::string key;
  JsonOutput value;
};

// Below an Entry is whole.
template <std::floating_point T>
JsonOutput::JsonOutput(T value) : value_(static_cast<double>(value)) {}

template <std::ranges::input_range Values>
requires(!std::convertible_to<const Values&, std::string_view>)
    JsonOutput::JsonOutput(const Values& values)
    : value_(Array()) {
  for (const auto& value : values) push_back(JsonOutput(value));
}

/// A string as JSON has it, in quotes. Bytes that are no UTF-8 become U+FFFD.
[[nodiscard]] std::string json_quoted(std::string_view text);

[[nodiscard]] bool is_utf8(std::string_view text);

}  // namespace lamina
