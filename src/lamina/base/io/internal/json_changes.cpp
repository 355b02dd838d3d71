// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/internal/json_changes.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/io/nearest_name.h"

namespace lamina::json_detail {
namespace {

std::uint32_t last_node(const Tree& tree) {
  return static_cast<std::uint32_t>(tree.nodes.size() - 1);
}

/// Adds a value that has no place in the tree yet, and what is in it.
std::uint32_t add_copy(Tree& to, const Tree& from, std::uint32_t node, std::uint32_t source) {
  if (to.nodes.size() >= json_max_values)
    throw InvalidInput(to.sources[0].name + ": holds more than " + std::to_string(json_max_values) +
                       " values with its bases");
  Node copy = from.nodes[node];
  copy.source += source;
  copy.parent = copy.next_sibling = copy.first_child = copy.key = none;
  if (copy.text != none) copy.text = add_text(to, from.texts[copy.text]);
  add_node(to, copy);
  const std::uint32_t index = last_node(to);
  std::uint32_t last = none;
  for (auto child = from.nodes[node].first_child; child != none;
       child = from.nodes[child].next_sibling) {
    const std::uint32_t added = add_copy(to, from, child, source);
    to.nodes[added].parent = index;
    if (from.nodes[child].key != none)
      to.nodes[added].key = add_text(to, from.texts[from.nodes[child].key]);
    (last == none ? to.nodes[index].first_child : to.nodes[last].next_sibling) = added;
    last = added;
  }
  return index;
}

/// The link that leads to a value: of its parent, or of the sibling before it.
std::uint32_t& link_to(Tree& tree, std::uint32_t node) {
  std::uint32_t* link = &tree.nodes[tree.nodes[node].parent].first_child;
  while (*link != node) link = &tree.nodes[*link].next_sibling;
  return *link;
}

void replace(Tree& tree, std::uint32_t old, std::uint32_t value) {
  Node& there = tree.nodes[old];
  Node& here = tree.nodes[value];
  here.parent = there.parent, here.key = there.key, here.place = there.place;
  here.next_sibling = there.next_sibling;
  link_to(tree, old) = value;
}

void remove(Tree& tree, std::uint32_t node) {
  for (auto after = tree.nodes[node].next_sibling; after != none;
       after = tree.nodes[after].next_sibling)
    --tree.nodes[after].place;
  --tree.nodes[tree.nodes[node].parent].children;
  link_to(tree, node) = tree.nodes[node].next_sibling;
}

/// Gives an object, or an array, one more value.
void append(Tree& tree, std::uint32_t owner, std::uint32_t value) {
  tree.nodes[value].parent = owner;
  tree.nodes[value].place = tree.nodes[owner].children++;
  std::uint32_t* link = &tree.nodes[owner].first_child;
  while (*link != none) link = &tree.nodes[*link].next_sibling;
  *link = value;
}

std::vector<std::string_view> keys_of(const Tree& tree, std::uint32_t object) {
  std::vector<std::string_view> keys;
  for (auto child = tree.nodes[object].first_child; child != none;
       child = tree.nodes[child].next_sibling)
    keys.push_back(tree.texts[tree.nodes[child].key]);
  return keys;
}

/// Takes the object `changes` of another tree over into an object.
void merge(Tree& to, std::uint32_t object, const Tree& from, std::uint32_t changes,
           std::uint32_t source) {
  to.nodes[object].line = from.nodes[changes].line;  // where users look for what is missing
  to.nodes[object].source = from.nodes[changes].source + source;
  for (auto change = from.nodes[changes].first_child; change != none;
       change = from.nodes[change].next_sibling) {
    const Node& node = from.nodes[change];
    const std::string& key = from.texts[node.key];
    const std::uint32_t there = find_child(to, object, key);
    if (there == none) {
      if (node.kind == Kind::null)
        throw InvalidInput(where(from, change) + ": removes what the base does not have" +
                           did_you_mean(key, keys_of(to, object)));
      const std::uint32_t added = add_copy(to, from, change, source);
      to.nodes[added].key = add_text(to, key);
      append(to, object, added);
    } else if (node.kind == Kind::null) {
      remove(to, there);
    } else if (node.kind == Kind::object && to.nodes[there].kind == Kind::object) {
      merge(to, there, from, change, source);
    } else {
      replace(to, there, add_copy(to, from, change, source));
    }
  }
}

using Chain = std::vector<std::filesystem::path>;  // files that name one another as base

void resolve_bases(Tree& tree, Chain& chain);

/// The tree of a base, all bases of which are resolved.
Tree base_of(const Tree& tree, std::uint32_t value, Chain& chain) {
  const auto fail = [&](const std::string& reason) {
    throw InvalidInput(where(tree, value) + ": " + reason);
  };
  const std::filesystem::path file = file_path(tree, value);
  std::error_code ignored;
  const std::filesystem::path real = std::filesystem::weakly_canonical(file, ignored);
  if (std::ranges::find(chain, real) != chain.end())
    fail("the file is a base of itself: " + file.string());
  if (chain.size() > json_max_bases)
    fail("bases stand on bases more than " + std::to_string(json_max_bases) + " times");
  const std::string text = [&] {
    try {
      return read_stream_bytes(file, std::min(json_max_bytes, tree.memory->left));
    } catch (const FileError& error) {
      throw FileError(where(tree, value) + ": " + error.what());
    }
  }();
  Tree base = parse_tree(text, file.string(), *tree.memory);
  chain.push_back(real);
  resolve_bases(base, chain);
  chain.pop_back();
  return base;
}

/// Whether a base is no file, but the name of a material.
bool is_named_material(const Tree& tree, std::uint32_t kind, std::uint32_t name) {
  const auto is_text = [&](std::uint32_t node) { return tree.nodes[node].kind == Kind::string; };
  if (!is_text(kind) || !is_text(name) || tree.texts[tree.nodes[kind].text] != "material")
    return false;
  const std::string& text = tree.texts[tree.nodes[name].text];
  std::error_code ignored;
  return text.find_first_of("./\\") == std::string::npos &&
         !std::filesystem::exists(file_path(tree, name), ignored);
}

void resolve_bases(Tree& tree, Chain& chain) {
  for (auto object = last_node(tree) + 1; object-- > 0;) {  // what is inside comes first
    if (tree.nodes[object].kind != Kind::object) continue;
    const std::uint32_t kind = find_child(tree, object, "lamina");
    const std::uint32_t name = find_child(tree, object, "base");
    if (kind == none || name == none || tree.nodes[kind].kind != Kind::string ||
        is_named_material(tree, kind, name))
      continue;  // a schema describes both
    Tree base = base_of(tree, name, chain);
    const std::uint32_t base_kind =
        base.nodes[0].kind == Kind::object ? find_child(base, 0, "lamina") : none;
    if (base_kind == none || described(tree, kind) != described(base, base_kind))
      throw InvalidInput(where(tree, name) + ": must be a file of the same kind, \"lamina\": " +
                         described(tree, kind) + ", but is " +
                         (base_kind == none ? "none of lamina's" : described(base, base_kind)));
    remove(tree, name);
    const auto source = static_cast<std::uint32_t>(base.sources.size());
    base.sources.insert(base.sources.end(), tree.sources.begin(), tree.sources.end());
    merge(base, 0, tree, object, source);
    if (object == 0) {
      tree = std::move(base);
    } else {
      const auto first = static_cast<std::uint32_t>(tree.sources.size());
      tree.sources.insert(tree.sources.end(), base.sources.begin(), base.sources.end());
      replace(tree, object, add_copy(tree, base, 0, first));
    }
  }
}

/// The next step of a path below a value: takes it off the path.
class Steps {
 public:
  Steps(const Tree& tree, const std::string& key) : tree_(tree), key_(key), left_(key) {}

  [[nodiscard]] bool is_done() const { return left_.empty(); }

  /// In an object: the longest key of it that the path goes on with, or the text up to a dot.
  [[nodiscard]] std::string key(std::uint32_t object) {
    std::size_t length = left_.find_first_of(".[");
    for (const std::string_view known : keys_of(tree_, object))
      if (left_.starts_with(known) && !known.empty() &&
          (left_.size() == known.size() || left_[known.size()] == '.' ||
           left_[known.size()] == '[') &&
          (length == std::string_view::npos || known.size() > length))
        length = known.size();
    const std::string key(left_.substr(0, length));
    if (key.empty()) fail("must be a path such as camera.look_at or lights[0].scale");
    advance(key.size());
    return key;
  }

  /// In an array: [2] or 2; [+] at the end is one more than there are.
  [[nodiscard]] std::size_t index(std::size_t size, const std::string& owner) {
    if (left_ == "[+]") {
      left_ = {};
      return size;
    }
    const bool has_bracket = left_.starts_with('[');
    if (has_bracket) left_.remove_prefix(1);
    std::size_t digits = 0, index = 0;
    for (; digits < std::min<std::size_t>(left_.size(), 9) && '0' <= left_[digits] &&
           left_[digits] <= '9';
         ++digits)
      index = 10 * index + static_cast<std::size_t>(left_[digits] - '0');
    const bool is_closed = !has_bracket || (digits < left_.size() && left_[digits] == ']');
    if (digits == 0 || !is_closed)
      fail(owner + " is an array: go on with the number of an element, such as [0]");
    if (index >= size)
      fail(owner + " has " + std::to_string(size) + " elements, counted from 0; [+] adds one");
    advance(digits + (has_bracket ? 1 : 0));
    return index;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw InvalidInput("--set " + key_ + ": " + reason);
  }

 private:
  /// Past a step and the dot after it.
  void advance(std::size_t length) {
    left_.remove_prefix(length);
    if (left_.starts_with('.')) left_.remove_prefix(1);
  }

  const Tree& tree_;
  const std::string& key_;
  std::string_view left_;
};

/// The text with zeros where people leave them out beside a point: `[.3, -.5, 2.]`. Strings stay.
std::string with_zeros(const std::string& text) {
  const auto is_digit = [&](std::size_t i) {
    return i < text.size() && '0' <= text[i] && text[i] <= '9';
  };
  std::string result;
  bool is_quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"' && (i == 0 || text[i - 1] != '\\')) is_quoted = !is_quoted;
    const bool is_point = text[i] == '.' && !is_quoted;
    if (is_point && !(i > 0 && is_digit(i - 1)) && is_digit(i + 1)) result += '0';
    result += text[i];
    if (is_point && i > 0 && is_digit(i - 1) && !is_digit(i + 1)) result += '0';
  }
  return result;
}

/// JSON, in which numbers may begin or end with their point, or else a bare string.
Tree parse_value(const std::string& text, const std::string& name, MemoryBudget& memory) {
  for (const std::string& spelled : {text, with_zeros(text)}) {
    try {
      return parse_tree(spelled, name, memory);
    } catch (const InvalidInput&) {
      continue;
    }
  }
  {
    Tree tree{.sources = {{.name = name}}, .nodes = {}, .texts = {}, .memory = &memory};
    add_node(tree, {.text = add_text(tree, text), .kind = Kind::string});
    return tree;
  }
}

}  // namespace

void resolve_bases(Tree& tree) {
  std::error_code ignored;
  Chain chain = {std::filesystem::weakly_canonical(tree.sources[0].name, ignored)};
  resolve_bases(tree, chain);
}

void lay_over(Tree& base, const Tree& from, std::uint32_t object) {
  const auto source = static_cast<std::uint32_t>(base.sources.size());
  base.sources.insert(base.sources.end(), from.sources.begin(), from.sources.end());
  Tree changes{.sources = from.sources, .nodes = {}, .texts = {}, .memory = from.memory};
  const std::uint32_t own = add_copy(changes, from, object, 0);
  if (const std::uint32_t name = find_child(changes, own, "base"); name != none)
    remove(changes, name);
  merge(base, 0, changes, own, source);
}

void apply_setting(Tree& tree, const std::string& setting) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InvalidInput("--set: must be KEY=VALUE, such as camera.look_at=[0,1,0], but is " +
                       in_quotes(setting));
  const std::string key = setting.substr(0, equals);
  Tree value = parse_value(setting.substr(equals + 1), "--set " + key, *tree.memory);
  for (Source& source : value.sources) source = {.name = "--set " + key, .is_option = true};
  const auto source = static_cast<std::uint32_t>(tree.sources.size());
  tree.sources.push_back(value.sources[0]);
  Steps steps(tree, key);
  const bool is_removed = value.nodes[0].kind == Kind::null;
  bool has_base = false;  // which is known where it is laid under: null goes on until then
  std::uint32_t at = 0;
  std::string owner = "the file";
  do {
    std::uint32_t next = none;
    if (tree.nodes[at].kind == Kind::object) {
      const std::string step = steps.key(at);
      next = find_child(tree, at, step);
      has_base = has_base || find_child(tree, at, "base") != none;
      if (next == none) {
        if (is_removed && !has_base)
          steps.fail("there is nothing to remove" + did_you_mean(step, keys_of(tree, at)));
        add_node(tree, {.source = source, .kind = Kind::object});
        next = last_node(tree);
        tree.nodes[next].key = add_text(tree, step);
        append(tree, at, next);
      }
    } else if (tree.nodes[at].kind == Kind::array) {
      std::size_t left = steps.index(tree.nodes[at].children, owner);
      if (left == tree.nodes[at].children) {
        add_node(tree, {.source = source});
        append(tree, at, last_node(tree));
      }
      for (next = tree.nodes[at].first_child; left > 0; --left)
        next = tree.nodes[next].next_sibling;
    } else if (tree.nodes[at].kind == Kind::string && at != 0) {
      add_node(
          tree,
          {.line = tree.nodes[at].line, .source = tree.nodes[at].source, .kind = Kind::object});
      const std::uint32_t object = last_node(tree);
      replace(tree, at, object);
      tree.nodes[at].key = add_text(tree, "base");
      tree.nodes[at].next_sibling = none;
      append(tree, object, at);
      next = object;
      owner = path(tree, object);
    } else {
      steps.fail(owner + " is " + described(tree, at) + ", which has no keys");
    }
    at = next;
    owner = path(tree, at);
  } while (!steps.is_done());
  if (is_removed && !has_base)
    remove(tree, at);
  else
    replace(tree, at, add_copy(tree, value, 0, source));
}

}  // namespace lamina::json_detail
