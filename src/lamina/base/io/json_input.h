// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/memory_budget.h"
#include "lamina/base/io/json_file.h"

// Reads lamina's files: JSON with // and /* */ comments. Every value knows where it stands, so that
// what is wrong with it is said in one line:
//
//   head.json:12: layers[1].sigma_a must be >= 0 [1/mm], but is -3
//   head.json:4: unknown key "sigmaa"; did you mean "sigma_a"?
//
// A decoder opens each object with the list of all its keys, then asks for the values by type:
//
//   const JsonDocument document = load_json("head.json");
//   const JsonObject camera = document.root().object({"position", "fov", "lens", "film"});
//   const std::vector<double> position = camera.required("position").numbers(3);
//   double fov = 40.0;
//   if (const auto value = camera.optional("fov")) fov = value->number(open_interval(0.0, 180.0,
//   "deg"));

namespace lamina {

/// The numbers that a value may have, and their unit as messages show it.
struct NumberRange {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool includes_low = true;
  bool includes_high = true;
  std::string_view unit;  ///< such as "1/mm"; empty without one
};

/// [low, infinity), (low, infinity), [low, high], (low, high).
[[nodiscard]] constexpr NumberRange at_least(double low, std::string_view unit = {}) {
  return {.low = low, .unit = unit};
}
[[nodiscard]] constexpr NumberRange greater_than(double low, std::string_view unit = {}) {
  return {.low = low, .includes_low = false, .unit = unit};
}
[[nodiscard]] constexpr NumberRange closed_interval(double low, double high,
                                                    std::string_view unit = {}) {
  return {.low = low, .high = high, .unit = unit};
}
[[nodiscard]] constexpr NumberRange open_interval(double low, double high,
                                                  std::string_view unit = {}) {
  return {.low = low, .high = high, .includes_low = false, .includes_high = false, .unit = unit};
}

class JsonDocument;
class JsonObject;

namespace json_detail {
struct Tree;
}

/// One value of a JSON file: a cheap view that is good as long as its JsonDocument lives.
/// The getters throw InvalidInput if the value is of another type or out of range.
class JsonInput {
 public:
  [[nodiscard]] bool is_null() const;
  [[nodiscard]] bool is_boolean() const;
  [[nodiscard]] bool is_number() const;
  [[nodiscard]] bool is_whole_number() const;  ///< written without point and exponent
  [[nodiscard]] bool is_string() const;
  [[nodiscard]] bool is_array() const;
  [[nodiscard]] bool is_object() const;

  /// A finite number.
  [[nodiscard]] double number(const NumberRange& range = {}) const;

  /// A whole number, written as 3 or 3.0. The limits lie within ±2^53.
  [[nodiscard]] std::int64_t integer(std::int64_t low, std::int64_t high) const;

  [[nodiscard]] bool boolean() const;

  /// Valid UTF-8; may be empty.
  [[nodiscard]] std::string string() const;

  /// A string as the path of a file, which is relative to the folder of the file that it stands in.
  /// Pipes and devices are refused.
  [[nodiscard]] std::filesystem::path file_path() const;

  /// The memory that is left to read what this file names.
  [[nodiscard]] MemoryBudget& memory() const;

  /// The elements, at least `fewest` and at most `most` of them.
  [[nodiscard]] std::vector<JsonInput> array(
      std::size_t fewest = 0, std::size_t most = std::numeric_limits<std::size_t>::max()) const;

  /// An array of exactly `size` numbers.
  [[nodiscard]] std::vector<double> numbers(std::size_t size, const NumberRange& range = {}) const;

  /// Numbers of a list of that size, or a single number that stands for all of them.
  [[nodiscard]] std::vector<double> number_or_numbers(std::size_t size,
                                                      const NumberRange& range = {}) const;

  /// A string that is one of `names`: its index among them.
  [[nodiscard]] std::size_t choice(std::span<const std::string_view> names) const;

  /// The name of a value of an enum: `choice<View>()`.
  template <NamedEnum E>
  [[nodiscard]] E choice() const {
    return enum_names<E>[choice(names_of<E>())].value;
  }

  /// Chooses a value by name, for what is no enum:
  /// `choice<double>({{"mm", 1.0}, {"cm", 10.0}})`.
  template <class T>
  [[nodiscard]] T choice(std::initializer_list<std::pair<std::string_view, T>> options) const {
    std::vector<std::string_view> names;
    for (const auto& option : options) names.push_back(option.first);
    return (options.begin() + choice(std::span<const std::string_view>(names)))->second;
  }

  /// An object with these keys. @throws InvalidInput for any other key, suggesting the nearest one.
  [[nodiscard]] JsonObject object(std::initializer_list<std::string_view> keys) const;
  [[nodiscard]] JsonObject object(std::span<const std::string_view> keys) const;

  /// The object that a file of lamina's is: its keys "lamina" and "version" are checked before the
  /// other keys, which are given here; so a file of another kind is called that. The key "$schema",
  /// which tells an editor where the JSON schema is, is allowed and ignored.
  [[nodiscard]] JsonObject file_object(std::string_view kind, int version,
                                       std::initializer_list<std::string_view> keys) const;

  /// The entries of an object whose keys the user chooses, in the order of the file.
  [[nodiscard]] std::vector<std::pair<std::string, JsonInput>> entries() const;

  /// The value of a key of an object, whatever other keys it has; for choosing how to decode it.
  [[nodiscard]] std::optional<JsonInput> peek(std::string_view key) const;

  /// Counted from 1: the line in which the value ends (an array or object: starts).
  [[nodiscard]] int line() const;

  /// Path within the document, as in `layers[1].sigma_a`; empty for the outermost value.
  [[nodiscard]] std::string path() const;

  /// `head.json:12: layers[1].sigma_a`, or for the outermost value `head.json:1`; of a value that
  /// an option gives, `--set layers[1].sigma_a`.
  [[nodiscard]] std::string where() const;

  /// Throws InvalidInput: `WHERE RULE, but is VALUE`; a rule reads "must be a power of two".
  [[noreturn]] void refuse(std::string_view rule) const;

  /// Throws InvalidInput: `WHERE: MESSAGE`.
  [[noreturn]] void fail(std::string_view message) const;

 private:
  friend class JsonDocument;
  friend class JsonObject;
  friend JsonDocument laid_over(std::string_view text, std::string name, const JsonInput& object);
  JsonInput(const json_detail::Tree& tree, std::uint32_t node) : tree_(&tree), node_(node) {}
  [[nodiscard]] std::string described() const;
  [[noreturn]] void say(const std::string& text) const;

  const json_detail::Tree* tree_;
  std::uint32_t node_;
};

/// An object whose keys are all known.
class JsonObject {
 public:
  /// The value of a key. @throws InvalidInput naming the key if it is missing.
  [[nodiscard]] JsonInput required(std::string_view key) const;

  /// The value of a key that may be missing.
  [[nodiscard]] std::optional<JsonInput> optional(std::string_view key) const;

  [[nodiscard]] bool has(std::string_view key) const { return optional(key).has_value(); }

  /// The object as a value, for messages about it as a whole.
  [[nodiscard]] const JsonInput& value() const { return value_; }

 private:
  friend class JsonInput;
  explicit JsonObject(JsonInput value) : value_(value) {}
  JsonInput value_;
};

/// Document of a JSON file. It owns what the JsonInput values look at.
class JsonDocument {
 public:
  JsonDocument(JsonDocument&&) noexcept;
  JsonDocument& operator=(JsonDocument&&) noexcept;
  ~JsonDocument();

  /// The outermost value.
  [[nodiscard]] JsonInput root() const;

 private:
  friend JsonDocument parse_json(std::string_view text, std::string name);
  friend JsonDocument parse_json(std::string_view text, std::string name, MemoryBudget& memory,
                                 std::span<const std::string> settings);
  friend JsonDocument laid_over(std::string_view text, std::string name, const JsonInput& object);
  JsonDocument(std::unique_ptr<MemoryBudget> own_memory,
               std::unique_ptr<const json_detail::Tree> tree);
  std::unique_ptr<MemoryBudget> own_memory_;  ///< unless it is someone else's
  std::unique_ptr<const json_detail::Tree> tree_;
};

/// Text that is longer, nested deeper or holds more values than these is refused.
inline constexpr std::size_t json_max_bytes = std::size_t{256} << 20;
inline constexpr std::size_t json_max_depth = 64;
inline constexpr std::size_t json_max_values = 2'000'000;

/// How often a base may stand on another one.
inline constexpr std::size_t json_max_bases = 8;

/// Reads JSON with comments; a byte order mark is skipped.
///
/// An object that has "lamina" may have "base": a file of the same kind, over which it is laid.
/// Objects are merged key by key, null removes a key, all else replaces what the base has. Messages
/// and relative paths go by the file that says a value. The base of a material may be a name, which
/// whoever decodes materials looks up: such a "base" stays.
///
/// @param text  UTF-8.
/// @param name  the file that messages name and that paths in it are relative to.
/// @param memory  what the document and the files that it names may take; must outlive it. Without
///                one, that of a new MemoryBudget.
/// @param settings  changes on top, as `--set` of a command takes them: `camera.look_at=[0, 1, 0]`,
///                `lights[2].scale=3`, `name=Anna`; a path and JSON or a bare string. null removes,
///                list[+] adds an element.
/// @throws InvalidInput with name and line if it is not JSON, has a key twice in one object, has a
///         number beyond the range of double, or exceeds a limit above; FileError if it takes more
///         memory than is left.
[[nodiscard]] JsonDocument parse_json(std::string_view text, std::string name);
[[nodiscard]] JsonDocument parse_json(std::string_view text, std::string name, MemoryBudget& memory,
                                      std::span<const std::string> settings = {});

/// The text of a base with an object laid over it, as over the file that its "base" names.
/// @param name    what messages call the text; paths in it are relative to it
/// @param object  must not outlive the document that it is in, nor shall the result
/// @throws as parse_json
[[nodiscard]] JsonDocument laid_over(std::string_view text, std::string name,
                                     const JsonInput& object);

/// Reads a JSON file (or a pipe), or standard input if it is "-".
/// @throws FileError if it cannot be read; InvalidInput as parse_json.
[[nodiscard]] JsonDocument load_json(const std::filesystem::path& file);
[[nodiscard]] JsonDocument load_json(const JsonFile& file, MemoryBudget& memory,
                                     std::span<const std::string> settings = {});

}  // namespace lamina
