// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/internal/json_tree.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/json_input.h"

namespace lamina::json_detail {
namespace {

/// Twice as much, for the room that vectors keep to grow.
void take_memory(const Tree& tree, std::size_t bytes) {
  if (tree.memory->left < 2 * bytes)
    throw FileError(tree.sources[0].name +
                    ": its values would take more memory than is left of the budget "
                    "(--memory-budget)");
  tree.memory->left -= 2 * bytes;
}

/// Where the parser is in the text.
struct Position {
  std::uint32_t newlines = 0;              ///< read so far
  std::uint32_t newlines_before_last = 0;  ///< the same without the last character read
};

/// Walks over the text and keeps count of the lines in a Position outside of itself, because the
/// parser takes its iterators by value.
class LineCounter {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  LineCounter(const char* at, Position* position) : at_(at), position_(position) {}
  reference operator*() const { return *at_; }
  LineCounter& operator++() {
    position_->newlines_before_last = position_->newlines;
    if (*at_ == '\n') ++position_->newlines;
    ++at_;
    return *this;
  }
  LineCounter operator++(int) {
    LineCounter before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const LineCounter& a, const LineCounter& b) { return a.at_ == b.at_; }
  friend bool operator!=(const LineCounter& a, const LineCounter& b) { return a.at_ != b.at_; }

 private:
  const char* at_;
  Position* position_;
};

/// Takes the parser's events and grows the tree. The last character that the parser has read ends
/// the token of the event, except for numbers, which it reads one character beyond. No token holds
/// a newline, so the lines before the last character are those before the token in both cases.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  TreeBuilder(Tree& tree, const Position& position) : tree_(tree), position_(position) {}

  bool null() override { return add({.kind = Kind::null}); }
  bool boolean(bool value) override {
    return add({.number = value ? 1.0 : 0.0, .kind = Kind::boolean});
  }
  bool number_integer(number_integer_t value) override {
    return add({.number = static_cast<double>(value), .kind = Kind::number, .is_whole = true});
  }
  bool number_unsigned(number_unsigned_t value) override {
    return add({.number = static_cast<double>(value), .kind = Kind::number, .is_whole = true});
  }
  bool number_float(number_float_t value, const string_t&) override {
    return add({.number = value, .kind = Kind::number});
  }
  bool string(string_t& value) override {
    return add({.text = keep(std::move(value)), .kind = Kind::string});
  }
  bool binary(binary_t&) override { return false; }  // not part of JSON text
  bool start_object(std::size_t) override { return open(Kind::object); }
  bool start_array(std::size_t) override { return open(Kind::array); }
  bool end_array() override { return close(); }
  bool end_object() override {
    check_keys(open_.back().node);
    return close();
  }
  bool key(string_t& value) override {
    open_.back().key = keep(std::move(value));
    return true;
  }
  bool parse_error(std::size_t, const std::string&,
                   const nlohmann::json::exception& error) override {
    refuse(explain(error, !tree_.nodes.empty()));
  }

  [[noreturn]] void refuse(const std::string& message) const { refuse_in(line(), message); }

 private:
  struct Open {
    std::uint32_t node;
    std::uint32_t last_child;
    std::uint32_t key;  ///< of the value to come
  };

  [[nodiscard]] std::uint32_t line() const { return position_.newlines_before_last + 1; }

  [[noreturn]] void refuse_in(std::uint32_t line, const std::string& message) const {
    throw InvalidInput(tree_.sources[0].name + ":" + std::to_string(line) + ": " + message);
  }

  std::uint32_t keep(std::string text) { return add_text(tree_, std::move(text)); }

  bool add(Node node) {
    const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
    if (tree_.nodes.size() == json_max_values)
      refuse("holds more than " + std::to_string(json_max_values) + " values");
    node.line = line();
    if (!open_.empty()) {
      Open& open = open_.back();
      Node& parent = tree_.nodes[open.node];
      node.parent = open.node;
      node.key = open.key;
      node.place = parent.children++;
      (open.last_child == none ? parent.first_child : tree_.nodes[open.last_child].next_sibling) =
          index;
      open.last_child = index;
    }
    add_node(tree_, node);
    return true;
  }

  bool open(Kind kind) {
    if (open_.size() == json_max_depth)
      refuse("brackets are nested deeper than " + std::to_string(json_max_depth) + " levels");
    add({.kind = kind});
    open_.push_back({.node = static_cast<std::uint32_t>(tree_.nodes.size() - 1),
                     .last_child = none,
                     .key = none});
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  /// Refuses an object with a key twice.
  void check_keys(std::uint32_t object) const {
    std::vector<std::pair<std::string_view, std::uint32_t>> keys;
    keys.reserve(tree_.nodes[object].children);
    for (auto child = tree_.nodes[object].first_child; child != none;
         child = tree_.nodes[child].next_sibling)
      keys.emplace_back(tree_.texts[tree_.nodes[child].key], child);
    std::ranges::sort(keys);
    const auto twice = std::ranges::adjacent_find(
        keys, [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twice == keys.end()) return;
    const auto& first = tree_.nodes[twice->second];
    const auto& second = tree_.nodes[std::next(twice)->second];
    refuse_in(second.line, "key " + in_quotes(twice->first) + " is here and in line " +
                               std::to_string(first.line));
  }

  /// The parser's message without its number, its own line and column, and what it last read, which
  /// may be anything: of a file that does not even begin as JSON does, which another file may have
  /// named, it is not shown.
  static std::string explain(const nlohmann::json::exception& error, bool is_json_so_far) {
    std::string message = error.what();
    if (const auto start = message.find("] "); start != std::string::npos)
      message.erase(0, start + 2);
    if (message.starts_with("parse error"))
      if (const auto start = message.find(": "); start != std::string::npos)
        message.erase(0, start + 2);
    if (const auto start = message.find("syntax error while parsing "); start == 0)
      if (const auto dash = message.find(" - "); dash != std::string::npos)
        message.erase(0, dash + 3);
    if (const auto read = message.find("; last read: '"); read != std::string::npos) {
      const std::size_t start = read + 14;
      const std::size_t expected = message.rfind("'; expected ");
      const std::size_t end =
          expected != std::string::npos && expected >= start ? expected : message.size() - 1;
      const std::string near = last_line(message.substr(start, end - start));
      message.erase(read, end + 1 - read);
      if (is_json_so_far) message += ", near " + near;
    }
    constexpr std::size_t longest = 200;
    if (message.size() > longest) message = message.substr(0, longest) + "...";
    for (char& c : message)
      if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
    return "is not valid JSON: " + message;
  }

  /// The end of what the parser read, which may start with comments and hold any bytes.
  static std::string last_line(std::string read) {
    constexpr std::string_view newline = "<U+000A>";  // as the parser writes it
    constexpr std::size_t longest = 40;
    if (const auto end = read.rfind(newline);
        end != std::string::npos && end + newline.size() < read.size())
      read.erase(0, end + newline.size());
    read.erase(0, read.find_first_not_of(' '));
    return read.size() > longest ? "..." + read.substr(read.size() - longest) : read;
  }

  Tree& tree_;
  const Position& position_;
  std::vector<Open> open_;
};

}  // namespace

void add_node(Tree& tree, const Node& node) {
  take_memory(tree, sizeof node);
  tree.nodes.push_back(node);
}

std::uint32_t add_text(Tree& tree, std::string text) {
  take_memory(tree, sizeof text + text.capacity());
  tree.texts.push_back(std::move(text));
  return static_cast<std::uint32_t>(tree.texts.size() - 1);
}

std::uint32_t find_child(const Tree& tree, std::uint32_t object, std::string_view key) {
  for (auto child = tree.nodes[object].first_child; child != none;
       child = tree.nodes[child].next_sibling)
    if (tree.texts[tree.nodes[child].key] == key) return child;
  return none;
}

std::string place(const Tree& tree, std::uint32_t node) {
  const Source& source = tree.sources[tree.nodes[node].source];
  return source.is_option ? source.name : source.name + ":" + std::to_string(tree.nodes[node].line);
}

std::string path(const Tree& tree, std::uint32_t node) {
  std::vector<std::uint32_t> chain;  // from the value outward
  for (; node != 0; node = tree.nodes[node].parent) chain.push_back(node);
  std::string path;
  for (auto step = chain.rbegin(); step != chain.rend(); ++step) {
    const Node& at = tree.nodes[*step];
    if (at.key == none) {
      path += "[" + std::to_string(at.place) + "]";
    } else {
      const std::string key = in_quotes(tree.texts[at.key]);
      path += (path.empty() ? "" : ".") + key.substr(1, key.size() - 2);
    }
  }
  return path;
}

std::string where(const Tree& tree, std::uint32_t node) {
  const std::string inner = path(tree, node), at = place(tree, node);
  const bool says_it = tree.sources[tree.nodes[node].source].is_option && at.ends_with(" " + inner);
  return inner.empty() || says_it ? at : at + ": " + inner;
}

std::string described(const Tree& tree, std::uint32_t index) {
  const Node& node = tree.nodes[index];
  switch (node.kind) {
    case Kind::null:
      return "null";
    case Kind::boolean:
      return node.number != 0.0 ? "true" : "false";
    case Kind::number:
      return number_text(node.number);
    case Kind::string:
      return in_quotes(tree.texts[node.text]);
    case Kind::array:
      return "an array";
    case Kind::object:
      return "an object";
  }
  return {};
}

std::filesystem::path file_path(const Tree& tree, std::uint32_t node) {
  const auto refuse = [&](const std::string& rule) {
    throw InvalidInput(where(tree, node) + " " + rule + ", but is " + described(tree, node));
  };
  if (tree.nodes[node].kind != Kind::string) refuse("must be a string");
  const std::string& text = tree.texts[tree.nodes[node].text];
  if (text.empty() || text.find('\0') != std::string::npos) refuse("must be the path of a file");
  const Source& source = tree.sources[tree.nodes[node].source];
  const std::filesystem::path folder =
      source.is_option ? std::filesystem::path() : std::filesystem::path(source.name).parent_path();
  const std::filesystem::path path = folder / text;
  std::error_code ignored;  // what is missing is told by who reads it
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_other(status))  // whoever opens a pipe waits for its writer
    refuse("must be the path of a file, not of a pipe or device");
  return path;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::string shown(text.substr(0, longest));
  // Do not end within a character of several bytes.
  if (text.size() > longest)
    while (!shown.empty() && (static_cast<unsigned char>(shown.back()) & 0x80U) != 0)
      shown.pop_back();
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
  return '"' + shown + (text.size() > longest ? "...\"" : "\"");
}

Tree parse_tree(std::string_view text, std::string name, MemoryBudget& memory) {
  Tree tree{.sources = {{.name = std::move(name)}}, .nodes = {}, .texts = {}, .memory = &memory};
  if (text.size() > json_max_bytes)
    throw InvalidInput(tree.sources[0].name + ": is larger than " +
                       std::to_string(json_max_bytes >> 20) + " MiB");
  Position position;
  TreeBuilder builder(tree, position);
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) builder.refuse("is empty");
  const char* begin = text.data();
  nlohmann::json::sax_parse(LineCounter(begin, &position),
                            LineCounter(begin + text.size(), &position), &builder,
                            nlohmann::json::input_format_t::json, true, true);
  return tree;
}

}  // namespace lamina::json_detail
