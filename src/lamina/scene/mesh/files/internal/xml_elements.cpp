// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/files/internal/xml_elements.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

class XmlReader {
 public:
  XmlReader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  XmlElement read() {
    if (text_.starts_with("\xef\xbb\xbf")) position_ = 3;
    skip_between();
    if (!take("<")) refuse("an element is required");
    return element(0);
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw FileError(name_ + ":" + std::to_string(line()) + ": " + why);
  }
  [[nodiscard]] int line() const {
    return 1 + static_cast<int>(
                   std::count(text_.begin(), text_.begin() + static_cast<long>(position_), '\n'));
  }
  [[nodiscard]] bool is_at(std::string_view what) const {
    return text_.substr(position_).starts_with(what);
  }
  bool take(std::string_view what) {
    if (!is_at(what)) return false;
    position_ += what.size();
    return true;
  }
  void skip_past(std::string_view what) {
    const std::size_t at = text_.find(what, position_);
    if (at == std::string_view::npos)
      refuse("is cut off: \"" + std::string(what) + "\" is missing");
    position_ = at + what.size();
  }
  void skip_blanks() {
    while (position_ < text_.size() &&
           std::string_view(" \t\r\n").find(text_[position_]) != std::string_view::npos)
      ++position_;
  }

  /// Text, comments, instructions and document types, up to an element's beginning or end.
  void skip_between() {
    while (true) {
      const std::size_t at = text_.find('<', position_);
      if (at == std::string_view::npos) refuse("is cut off: an element does not end");
      position_ = at;
      if (take("<!--"))
        skip_past("-->");
      else if (take("<![CDATA["))
        skip_past("]]>");
      else if (is_at("<?") || is_at("<!"))
        skip_past(">");
      else
        return;
    }
  }

  std::string word() {
    const std::size_t begin = position_;
    while (position_ < text_.size() && !is_end_of_word(text_[position_])) ++position_;
    if (position_ == begin) refuse("a name is required");
    return std::string(text_.substr(begin, position_ - begin));
  }
  static bool is_end_of_word(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '=' || c == '>' || c == '/' ||
           c == '<' || c == '"' || c == '\'';
  }

  static std::string unescaped(std::string_view value) {
    constexpr std::pair<std::string_view, char> entities[] = {
        {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
    std::string result;
    while (!value.empty()) {
      const auto* const found = std::ranges::find_if(
          entities, [&](const auto& entity) { return value.starts_with(entity.first); });
      const bool is_entity = found != std::end(entities);
      result.push_back(is_entity ? found->second : value.front());
      value.remove_prefix(is_entity ? found->first.size() : 1);
    }
    return result;
  }

  /// After its "<".
  XmlElement element(int depth) {
    constexpr int deepest = 64, most = 1'000'000;
    if (depth > deepest || ++count_ > most)
      refuse("elements must not nest more than 64 deep, nor be more than a million");
    XmlElement result;
    result.name = word();
    while (true) {
      skip_blanks();
      if (take("/>")) return result;
      if (take(">")) break;
      const std::string key = word();
      skip_blanks();
      if (!take("=")) refuse("an attribute must have a value");
      skip_blanks();
      const char quote = position_ < text_.size() ? text_[position_] : '\0';
      if (quote != '"' && quote != '\'') refuse("a value must stand in quotes");
      const std::size_t begin = ++position_;
      skip_past(std::string_view(&quote, 1));
      result.attributes[key] = unescaped(text_.substr(begin, position_ - 1 - begin));
    }
    while (true) {
      skip_between();
      if (take("</")) {
        if (word() != result.name) refuse("an element must end with its own name, " + result.name);
        skip_blanks();
        if (!take(">")) refuse("\">\" is required");
        return result;
      }
      (void)take("<");
      result.children.push_back(element(depth + 1));
    }
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t position_ = 0;
  int count_ = 0;
};

}  // namespace

XmlElement parse_xml(std::string_view text, const std::string& name) {
  return XmlReader(text, name).read();
}

}  // namespace lamina
