// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/json_input.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/internal/file_kinds.h"
#include "lamina/base/io/internal/json_changes.h"
#include "lamina/base/io/internal/json_tree.h"
#include "lamina/base/io/internal/range_rule.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/base/io/whole_number_text.h"

namespace lamina {
namespace {

using json_detail::in_quotes;
using json_detail::Kind;
using json_detail::Node;
using json_detail::none;
using json_detail::Tree;

/// `"mm", "cm" or "m"`.
std::string listed(std::span<const std::string_view> names) {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) list += i + 1 == names.size() ? " or " : ", ";
    list += '"' + std::string(names[i]) + '"';
  }
  return list;
}

std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// "-" is what flows in.
std::string read_json_text(const std::filesystem::path& file, std::size_t most) {
  return read_stream_bytes(file == "-" ? "/dev/stdin" : file, most);
}

}  // namespace

namespace input_detail {

bool contains(const NumberRange& range, double value) {
  return std::isfinite(value) && (range.includes_low ? value >= range.low : value > range.low) &&
         (range.includes_high ? value <= range.high : value < range.high);
}

std::string rule_of(const NumberRange& range) {
  const std::string unit = range.unit.empty() ? "" : " [" + std::string(range.unit) + "]";
  if (std::isinf(range.low) && std::isinf(range.high)) return "must be a number" + unit;
  if (std::isinf(range.high))
    return (range.includes_low ? "must be >= " : "must be > ") + number_text(range.low) + unit;
  if (std::isinf(range.low))
    return (range.includes_high ? "must be <= " : "must be < ") + number_text(range.high) + unit;
  return std::string("must lie in ") + (range.includes_low ? "[" : "(") + number_text(range.low) +
         ", " + number_text(range.high) + (range.includes_high ? "]" : ")") +
         (range.unit.empty() ? "" : " " + std::string(range.unit));
}

std::string number_rule_of(const NumberRange& range) {
  const std::string must = "must be ", lie = "must lie ";
  std::string rule = rule_of(range);
  if (std::isinf(range.low) && std::isinf(range.high)) return rule;
  return must + "a number " + rule.substr(rule.starts_with(lie) ? lie.size() : must.size());
}

}  // namespace input_detail

bool JsonInput::is_null() const { return tree_->nodes[node_].kind == Kind::null; }
bool JsonInput::is_boolean() const { return tree_->nodes[node_].kind == Kind::boolean; }
bool JsonInput::is_number() const { return tree_->nodes[node_].kind == Kind::number; }
bool JsonInput::is_whole_number() const { return is_number() && tree_->nodes[node_].is_whole; }
bool JsonInput::is_string() const { return tree_->nodes[node_].kind == Kind::string; }
bool JsonInput::is_array() const { return tree_->nodes[node_].kind == Kind::array; }
bool JsonInput::is_object() const { return tree_->nodes[node_].kind == Kind::object; }

double JsonInput::number(const NumberRange& range) const {
  const double value = tree_->nodes[node_].number;
  if (!is_number()) refuse(input_detail::number_rule_of(range));
  if (!input_detail::contains(range, value)) refuse(input_detail::rule_of(range));
  return value;
}

std::int64_t JsonInput::integer(std::int64_t low, std::int64_t high) const {
  assert(-(std::int64_t{1} << 53) <= low && high <= (std::int64_t{1} << 53));
  const double value = tree_->nodes[node_].number;
  if (!is_number() || value != std::floor(value) || value < static_cast<double>(low) ||
      value > static_cast<double>(high))
    refuse("must be a whole number in [" + whole_number_text(low) + ", " + whole_number_text(high) +
           "]");
  return static_cast<std::int64_t>(value);
}

bool JsonInput::boolean() const {
  if (!is_boolean()) refuse("must be true or false");
  return tree_->nodes[node_].number != 0.0;
}

std::string JsonInput::string() const {
  if (!is_string()) refuse("must be a string");
  return tree_->texts[tree_->nodes[node_].text];
}

std::filesystem::path JsonInput::file_path() const { return json_detail::file_path(*tree_, node_); }

MemoryBudget& JsonInput::memory() const { return *tree_->memory; }

std::vector<JsonInput> JsonInput::array(std::size_t fewest, std::size_t most) const {
  if (!is_array()) refuse("must be an array");
  const Node& node = tree_->nodes[node_];
  if (node.children < fewest || node.children > most)
    say("must hold " +
        (fewest == most           ? counted(fewest, "value")
         : node.children < fewest ? "at least " + counted(fewest, "value")
                                  : "at most " + counted(most, "value")) +
        ", but holds " + std::to_string(node.children));
  std::vector<JsonInput> elements;
  elements.reserve(node.children);
  for (auto child = node.first_child; child != none; child = tree_->nodes[child].next_sibling)
    elements.push_back(JsonInput(*tree_, child));
  return elements;
}

std::vector<double> JsonInput::numbers(std::size_t size, const NumberRange& range) const {
  if (!is_array()) refuse("must be an array of " + counted(size, "number"));
  std::vector<double> values;
  values.reserve(size);
  for (const JsonInput& element : array(size, size)) values.push_back(element.number(range));
  return values;
}

std::vector<double> JsonInput::number_or_numbers(std::size_t size, const NumberRange& range) const {
  if (is_number()) return std::vector<double>(size, number(range));
  if (!is_array()) refuse("must be a number or an array of " + counted(size, "number"));
  return numbers(size, range);
}

std::size_t JsonInput::choice(std::span<const std::string_view> names) const {
  const std::string rule = "must be " + listed(names);
  if (!is_string()) refuse(rule);
  const std::string text = string();
  const auto found = std::ranges::find(names, text);
  if (found == names.end()) say(rule + ", but is " + described() + did_you_mean(text, names));
  return static_cast<std::size_t>(found - names.begin());
}

JsonObject JsonInput::object(std::initializer_list<std::string_view> keys) const {
  return object(std::span(keys.begin(), keys.size()));
}

JsonObject JsonInput::object(std::span<const std::string_view> keys) const {
  const auto all = entries();
  for (const auto& [key, value] : all) {
    if (std::ranges::find(keys, key) != keys.end()) continue;
    const bool is_option = tree_->sources[tree_->nodes[value.node_].source].is_option;
    std::vector<std::string_view> missing;  // what the same file has already was not meant
    for (const std::string_view known : keys)
      if (is_option || !peek(known)) missing.push_back(known);
    std::string choice = did_you_mean(key, missing);
    std::erase(missing, "$schema");
    if (choice.empty() && !missing.empty()) choice = "; it can be " + listed(missing);
    const std::string owner = path();
    throw InvalidInput(json_detail::place(*tree_, value.node_) + ": " +
                       (owner.empty() ? "" : owner + ": ") + "unknown key " + in_quotes(key) +
                       choice);
  }
  return JsonObject(*this);
}

JsonObject JsonInput::file_object(std::string_view kind, int version,
                                  std::initializer_list<std::string_view> keys) const {
  const std::string given_kind = JsonObject(*this).required("lamina").string();
  if (given_kind != kind)
    JsonObject(*this).required("lamina").say("must be \"" + std::string(kind) + "\", but is " +
                                             in_quotes(given_kind) +
                                             input_detail::use_of_kind(given_kind));
  const JsonInput given_version = JsonObject(*this).required("version");
  if (!given_version.is_number() || given_version.number() != version)
    given_version.refuse("must be " + std::to_string(version));
  if (const auto schema = peek("$schema")) (void)schema->string();
  std::vector<std::string_view> all = {"lamina", "version", "$schema"};
  all.insert(all.end(), keys.begin(), keys.end());
  return object(all);
}

std::vector<std::pair<std::string, JsonInput>> JsonInput::entries() const {
  if (!is_object()) refuse("must be an object");
  std::vector<std::pair<std::string, JsonInput>> all;
  const Node& node = tree_->nodes[node_];
  all.reserve(node.children);
  for (auto child = node.first_child; child != none; child = tree_->nodes[child].next_sibling)
    all.emplace_back(tree_->texts[tree_->nodes[child].key], JsonInput(*tree_, child));
  return all;
}

std::optional<JsonInput> JsonInput::peek(std::string_view key) const {
  if (!is_object()) refuse("must be an object");
  const std::uint32_t child = json_detail::find_child(*tree_, node_, key);
  return child == none ? std::nullopt : std::optional(JsonInput(*tree_, child));
}

int JsonInput::line() const { return static_cast<int>(tree_->nodes[node_].line); }

std::string JsonInput::path() const { return json_detail::path(*tree_, node_); }

std::string JsonInput::where() const { return json_detail::where(*tree_, node_); }

std::string JsonInput::described() const { return json_detail::described(*tree_, node_); }

void JsonInput::refuse(std::string_view rule) const {
  say(std::string(rule) + ", but is " + described());
}

void JsonInput::say(const std::string& text) const {
  throw InvalidInput(where() + (node_ == 0 ? ": the file " : " ") + text);
}

void JsonInput::fail(std::string_view message) const {
  throw InvalidInput(where() + ": " + std::string(message));
}

std::optional<JsonInput> JsonObject::optional(std::string_view key) const {
  return value_.peek(key);
}

JsonInput JsonObject::required(std::string_view key) const {
  if (const auto found = optional(key)) return *found;
  value_.fail("\"" + std::string(key) + "\" is required, but missing");
}

JsonDocument::JsonDocument(std::unique_ptr<MemoryBudget> own_memory,
                           std::unique_ptr<const Tree> tree)
    : own_memory_(std::move(own_memory)), tree_(std::move(tree)) {}
JsonDocument::JsonDocument(JsonDocument&&) noexcept = default;
JsonDocument& JsonDocument::operator=(JsonDocument&&) noexcept = default;
JsonDocument::~JsonDocument() = default;

JsonInput JsonDocument::root() const { return {*tree_, 0}; }

JsonDocument parse_json(std::string_view text, std::string name, MemoryBudget& memory,
                        std::span<const std::string> settings) {
  Tree tree = json_detail::parse_tree(text, std::move(name), memory);
  json_detail::resolve_bases(tree);
  for (const std::string& setting : settings) json_detail::apply_setting(tree, setting);
  return {nullptr, std::make_unique<const Tree>(std::move(tree))};
}

JsonDocument laid_over(std::string_view text, std::string name, const JsonInput& object) {
  Tree base = json_detail::parse_tree(text, std::move(name), *object.tree_->memory);
  json_detail::resolve_bases(base);
  json_detail::lay_over(base, *object.tree_, object.node_);
  return {nullptr, std::make_unique<const Tree>(std::move(base))};
}

JsonDocument parse_json(std::string_view text, std::string name) {
  auto memory = std::make_unique<MemoryBudget>();
  JsonDocument document = parse_json(text, std::move(name), *memory);
  document.own_memory_ = std::move(memory);
  return document;
}

JsonDocument load_json(const JsonFile& file, MemoryBudget& memory,
                       std::span<const std::string> settings) {
  const std::string name = file.path.string();
  if (file.text) return parse_json(*file.text, name, memory, settings);
  const std::string text = read_json_text(file.path, std::min(json_max_bytes, memory.left));
  take_memory(memory, text.size(), name);
  JsonDocument document = parse_json(text, name, memory, settings);
  memory.left += text.size();  // which is there while it is parsed only
  return document;
}

JsonDocument load_json(const std::filesystem::path& file) {
  return parse_json(read_json_text(file, json_max_bytes), file.string());
}

}  // namespace lamina
