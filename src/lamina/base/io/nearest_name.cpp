// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/nearest_name.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "lamina/base/io/renamed_names.h"

namespace lamina {
namespace {

constexpr std::size_t edit = 2;         // cost of one
constexpr std::size_t change_case = 1;  // a slip that is likelier than others

char lower(char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Cost of the edits between two short names: the optimal string alignment distance, three rows at
/// a time.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j * edit;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i * edit;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const char x = a[i - 1], y = b[j - 1];
      const std::size_t replace = x == y ? 0 : lower(x) == lower(y) ? change_case : edit;
      row[j] = std::min({last[j] + edit, row[j - 1] + edit, last[j - 1] + replace});
      if (i > 1 && j > 1 && x == b[j - 2] && a[i - 2] == y)
        row[j] = std::min(row[j], before_last[j - 2] + edit);
    }
  }
  return row[b.size()];
}

}  // namespace

std::optional<std::string_view> nearest_name(std::string_view name,
                                             std::span<const std::string_view> known) {
  for (const auto& [before, now] : renamed_names)
    if (name == before && std::ranges::find(known, now) != known.end()) return now;
  constexpr std::size_t longest = 64;  // no name that lamina knows is longer
  if (name.size() > longest) return std::nullopt;
  std::optional<std::string_view> nearest;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string_view candidate : known) {
    const std::size_t allowed = edit * std::max<std::size_t>(1, candidate.size() / 3);
    const std::size_t cost = distance(name, candidate);
    if (cost > allowed || cost >= least) continue;
    least = cost;
    nearest = candidate;
  }
  if (nearest || name.size() < 3) return nearest;
  for (const std::string_view candidate : known)
    if (candidate.find(name) != std::string_view::npos &&
        (!nearest || candidate.size() < nearest->size()))
      nearest = candidate;
  return nearest;
}

std::string did_you_mean(std::string_view name, std::span<const std::string_view> known) {
  const auto nearest = nearest_name(name, known);
  return nearest ? "; did you mean \"" + std::string(*nearest) + "\"?" : "";
}

}  // namespace lamina
