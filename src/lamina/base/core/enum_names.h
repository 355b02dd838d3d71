// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <optional>
#include <string_view>
#include <type_traits>

// The names that the values of an enum have in files and options, said once, beside the enum:
//
//   enum class View { standard, filmic };
//
//   template <>
//   inline constexpr auto enum_names<View> =
//       std::to_array<EnumName<View>>({{"standard", View::standard}, {"filmic", View::filmic}});
//
// Decoders (`value.choice<View>()`), options (`command.add_choice("--view", view, …)`), results and
// messages (`name_of(view)`) read this table, and a test holds the schemas against it.

namespace lamina {

template <class E>
struct EnumName {
  std::string_view name;
  E value;
};

/// The table of an enum; empty for one that has no names.
template <class E>
inline constexpr std::array<EnumName<E>, 0> enum_names{};

template <class E>
concept NamedEnum = std::is_enum_v<E> && !enum_names<E>.empty();

/// The name of a value that the table has.
template <NamedEnum E>
[[nodiscard]] constexpr std::string_view name_of(E value) {
  const auto found = std::ranges::find(enum_names<E>, value, &EnumName<E>::value);
  assert(found != enum_names<E>.end());
  return found->name;
}

/// The value of a name, absent if there is none.
template <NamedEnum E>
[[nodiscard]] constexpr std::optional<E> find_enum_value(std::string_view name) {
  const auto found = std::ranges::find(enum_names<E>, name, &EnumName<E>::name);
  return found == enum_names<E>.end() ? std::nullopt : std::optional(found->value);
}

/// All names, in the order of the table.
template <NamedEnum E>
[[nodiscard]] constexpr auto names_of() {
  std::array<std::string_view, enum_names<E>.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = enum_names<E>[i].name;
  return names;
}

}  // namespace lamina
