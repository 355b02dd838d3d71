// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lamina {

/// An element of an XML file with its attributes; text between elements is left out.
struct XmlElement {
  std::string name;
  std::map<std::string, std::string, std::less<>> attributes;
  std::vector<XmlElement> children;

  /// The value of an attribute; empty if there is none.
  [[nodiscard]] std::string_view attribute(std::string_view key) const {
    const auto found = attributes.find(key);
    return found != attributes.end() ? std::string_view(found->second) : std::string_view();
  }
};

/// The outermost element. Document types are skipped and their entities unknown; elements nest 64
/// deep and are a million at most.
/// @throws FileError naming the line
[[nodiscard]] XmlElement parse_xml(std::string_view text, const std::string& name);

}  // namespace lamina
