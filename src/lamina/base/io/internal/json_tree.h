// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/memory_budget.h"

namespace lamina::json_detail {

enum class Kind : std::uint8_t { null, boolean, number, string, array, object };

/// No node, no text.
inline constexpr std::uint32_t none = 0xffffffff;

/// One value. Children form a list in the order of the file.
struct Node {
  double number = 0.0;                ///< a number's value; a boolean's 0 or 1
  std::uint32_t text = none;          ///< a string's value: index into Tree::texts
  std::uint32_t key = none;           ///< under which an object holds it: index into Tree::texts
  std::uint32_t parent = none;        ///< node
  std::uint32_t first_child = none;   ///< node
  std::uint32_t next_sibling = none;  ///< node
  std::uint32_t children = 0;         ///< how many
  std::uint32_t place = 0;            ///< among its siblings
  std::uint32_t line = 0;             ///< counted from 1
  std::uint32_t source = 0;           ///< where it was said: index into Tree::sources
  Kind kind = Kind::null;
  bool is_whole = false;  ///< a number without point and exponent
};

/// Origin of a value: a file, or an option of the command line.
struct Source {
  std::string name;        ///< as messages show it
  bool is_option = false;  ///< has no lines; its files are relative to the working folder
};

/// All values of a file, and of what it is based on or changed by. Node 0 is the outermost.
struct Tree {
  std::vector<Source> sources;  ///< the file itself first
  std::vector<Node> nodes;
  std::vector<std::string> texts;  ///< keys and strings
  MemoryBudget* memory = nullptr;  ///< of the tree, and of what the file names
};

/// Reads JSON text into a tree. @throws InvalidInput, FileError as parse_json.
[[nodiscard]] Tree parse_tree(std::string_view text, std::string name, MemoryBudget& memory);

/// Adds a node, which belongs to no other yet, or a text. @throws FileError if the memory is used
/// up
void add_node(Tree& tree, const Node& node);
[[nodiscard]] std::uint32_t add_text(Tree& tree, std::string text);

/// The value of a key of an object, or none.
[[nodiscard]] std::uint32_t find_child(const Tree& tree, std::uint32_t object,
                                       std::string_view key);

/// `head.json:12`, `layers[1].sigma_a`, and both: `head.json:12: layers[1].sigma_a`.
[[nodiscard]] std::string place(const Tree& tree, std::uint32_t node);
[[nodiscard]] std::string path(const Tree& tree, std::uint32_t node);
[[nodiscard]] std::string where(const Tree& tree, std::uint32_t node);

/// A value as messages show it.
[[nodiscard]] std::string described(const Tree& tree, std::uint32_t node);

/// A string as the path of a file, as JsonInput::file_path.
[[nodiscard]] std::filesystem::path file_path(const Tree& tree, std::uint32_t node);

/// Text in quotes as messages show it: without control characters, cut if long.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace lamina::json_detail
