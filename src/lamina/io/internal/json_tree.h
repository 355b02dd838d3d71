// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/core/memory_budget.h"

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
  Kind kind = Kind::null;
  bool is_whole = false;  ///< a number without point and exponent
};

/// All values of a file. Node 0 is the outermost.
struct Tree {
  std::string name;                ///< of the file
  std::vector<Node> nodes;         ///< each parent before its children
  std::vector<std::string> texts;  ///< keys and strings
  MemoryBudget* memory = nullptr;  ///< of the tree, and of what the file names
};

/// Reads JSON text into a tree. @throws InvalidInput, FileError as parse_json.
[[nodiscard]] Tree parse_tree(std::string_view text, std::string name, MemoryBudget& memory);

/// Text in quotes as messages show it: without control characters, cut if long.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace lamina::json_detail
