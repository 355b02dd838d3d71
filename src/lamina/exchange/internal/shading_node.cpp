// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/internal/shading_node.h"

#include <array>
#include <type_traits>

#include "lamina/base/core/number_text.h"
#include "lamina/exchange/internal/format_text.h"

namespace lamina::detail {
JsonOutput node_json(const ShadingNode& node) {
  JsonOutput json = {{"node", node.type}};
  for (const auto& [name, value] : node.parameters)
    std::visit(
        [&, key = std::string_view(name)](const auto& v) {
          using T = std::decay_t<decltype(v)>;
          if constexpr (std::is_same_v<T, NodeGray>)
            json[key] = v.value;
          else if constexpr (std::is_same_v<T, NodeChoice>)
            json[key] = v.name;
          else
            json[key] = v;
        },
        value);
  return json;
}

std::string arnold_text(const ShadingNode& node) {
  std::string text = node.type + "\n{\n name " + node.name + "\n";
  for (const auto& [name, value] : node.parameters) {
    text += " " + name + " ";
    std::visit(
        [&](const auto& v) {
          using T = std::decay_t<decltype(v)>;
          if constexpr (std::is_same_v<T, bool>)
            text += v ? "on" : "off";
          else if constexpr (std::is_same_v<T, double>)
            text += number_text(v);
          else if constexpr (std::is_same_v<T, NodeGray>)
            text += numbers_text(std::array{v.value, v.value, v.value});
          else if constexpr (std::is_same_v<T, NodeChoice>)
            text += "\"" + v.name + "\"";
          else
            text += numbers_text(v);
        },
        value);
    text += "\n";
  }
  return text + "}\n";
}

std::string rib_text(const ShadingNode& node) {
  std::string text = "Bxdf \"" + node.type + "\" \"" + node.name + "\"\n";
  for (const auto& [name, value] : node.parameters) {
    const auto line = [&, of = name](const char* type, const std::string& values) {
      text += std::string("  \"") + type + " " + of + "\" [" + values + "]\n";
    };
    std::visit(
        [&](const auto& v) {
          using T = std::decay_t<decltype(v)>;
          if constexpr (std::is_same_v<T, bool>)
            line("int", v ? "1" : "0");
          else if constexpr (std::is_same_v<T, double>)
            line("float", number_text(v));
          else if constexpr (std::is_same_v<T, NodeGray>)
            line("color", numbers_text(std::array{v.value, v.value, v.value}));
          else if constexpr (std::is_same_v<T, NodeChoice>)
            line("int", std::to_string(v.place));
          else
            line("color", numbers_text(v));
        },
        value);
  }
  return text;
}

}  // namespace lamina::detail
