// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/memory_budget.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

constexpr std::array<std::string_view, 5> units = {"B", "KiB", "MiB", "GiB", "TiB"};

[[noreturn]] void refuse(const MemoryBudget& budget, const std::string& need,
                         std::string_view what) {
  throw FileError(std::string(what) + " would take " + need + " of memory, but only " +
                  memory_size_text(budget.left) + " are left of the budget (--memory-budget)");
}

}  // namespace

void take_memory(MemoryBudget& budget, std::size_t bytes, std::string_view what) {
  if (bytes > budget.left) refuse(budget, memory_size_text(bytes), what);
  budget.left -= bytes;
}

void take_memory(MemoryBudget& budget, std::size_t count, std::size_t size, std::string_view what) {
  if (size > 0 && count > std::numeric_limits<std::size_t>::max() / size)
    refuse(budget, "more than " + memory_size_text(std::numeric_limits<std::size_t>::max()), what);
  take_memory(budget, count * size, what);
}

std::string memory_size_text(std::size_t bytes) {
  std::size_t unit = 0;
  double value = static_cast<double>(bytes);
  for (; value >= 1023.5 && unit + 1 < units.size(); ++unit) value /= 1024.0;
  const bool has_fraction = value < 10.0 && value != std::floor(value);
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                 std::chars_format::fixed, has_fraction ? 1 : 0)
                       .ptr;
  return std::string(digits.data(), end) + " " + std::string(units[unit]);
}

std::size_t parse_memory_size(std::string_view text) {
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  unit.remove_prefix(std::min(unit.find_first_not_of(' '), unit.size()));
  const auto* const found = std::ranges::find(units, unit);
  const double bytes = std::ldexp(value, static_cast<int>(10 * (found - units.begin())));
  constexpr double most = 0x1p63;
  if (code != std::errc() || found == units.end() || !(bytes >= 1.0 && bytes < most))
    throw InvalidInput(
        "a size of memory must be a number > 0 with a unit, such as 512MiB or 4GiB, " +
        ("but is \"" + std::string(text.substr(0, 40)) + "\""));
  return static_cast<std::size_t>(bytes);
}

}  // namespace lamina
