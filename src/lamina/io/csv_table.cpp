// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/io/csv_table.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "lamina/core/error.h"
#include "lamina/io/file_bytes.h"
#include "lamina/io/internal/range_rule.h"
#include "lamina/io/json_output.h"
#include "lamina/io/nearest_name.h"

namespace lamina {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r";
  const std::size_t first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

/// The first of comma, semicolon and tab outside of quotes; a comma in a line of one cell.
char find_separator(std::string_view line) {
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"') is_quoted = !is_quoted;
    if (!is_quoted && (c == ',' || c == ';' || c == '\t')) return c;
  }
  return ',';
}

std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells;
  while (true) {
    std::string cell;
    std::size_t at = 0;
    bool is_quoted = false;
    for (; at < line.size() && (is_quoted || line[at] != separator); ++at) {
      if (line[at] != '"')
        cell += line[at];
      else if (is_quoted && at + 1 < line.size() && line[at + 1] == '"')
        cell += line[++at];
      else
        is_quoted = !is_quoted;
    }
    cells.emplace_back(trimmed(cell));
    if (at == line.size()) return cells;
    line.remove_prefix(at + 1);
  }
}

/// Names in quotes; only the first ones of many.
std::string quoted_names(std::span<const std::string> names) {
  constexpr std::size_t most = 8;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i)
    list += (i > 0 ? ", " : "") + json_quoted(names[i]);
  return list + (names.size() > most ? ", ..." : "");
}

bool has_decimal_comma(std::string_view cell) {
  const std::size_t comma = cell.find(',');
  return comma != std::string_view::npos &&
         cell.find_first_not_of("0123456789,+-eE") == std::string_view::npos;
}

}  // namespace

std::optional<std::size_t> CsvTable::find_column(std::string_view name) const {
  const auto found = std::ranges::find(columns_, name);
  if (found == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns_.begin());
}

std::size_t CsvTable::column(std::string_view name) const {
  if (const auto found = find_column(name)) return *found;
  const std::vector<std::string_view> known(columns_.begin(), columns_.end());
  throw InvalidInput(file_ + ": there is no column " + json_quoted(name) + " among " +
                     quoted_names(columns_) + did_you_mean(name, known));
}

double CsvTable::number(std::size_t row, std::size_t column, const NumberRange& range) const {
  const std::string& cell = text(row, column);
  const char* const first = cell.data() + (cell.starts_with('+') ? 1 : 0);
  const char* const end = cell.data() + cell.size();
  double value = 0.0;
  const auto read = std::from_chars(first, end, value);
  const bool is_number = read.ec == std::errc() && read.ptr == end;
  if (is_number && input_detail::contains(range, value)) return value;
  fail(row, column,
       input_detail::rule_of(range) + ", but is " +
           (is_number                 ? cell
            : cell.empty()            ? "empty"
            : has_decimal_comma(cell) ? json_quoted(cell) + "; write a decimal point"
                                      : json_quoted(cell)));
}

void CsvTable::fail(std::size_t row, std::size_t column, std::string_view message) const {
  throw InvalidInput(file_ + ":" + std::to_string(lines_[row]) + ": " + columns_[column] + " " +
                     std::string(message));
}

CsvTable parse_csv(std::string_view text, std::string name, MemoryBudget& memory) {
  CsvTable table;
  table.file_ = std::move(name);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  char separator = ',';
  for (int line_number = 1; !text.empty(); ++line_number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto refuse = [&](const std::string& what) {
      throw InvalidInput(table.file_ + ":" + std::to_string(line_number) + ": " + what);
    };
    if (trimmed(line).empty() || line.starts_with('#')) continue;
    if (!is_utf8(line)) refuse("must be UTF-8");
    if (table.columns_.empty()) separator = find_separator(line);
    std::vector<std::string> cells = cells_of(line, separator);
    if (table.columns_.empty()) {
      for (std::size_t i = 0; i < cells.size(); ++i) {
        if (cells[i].empty()) refuse("column " + std::to_string(i + 1) + " has no name");
        if (std::find(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(i), cells[i]) !=
            cells.begin() + static_cast<std::ptrdiff_t>(i))
          refuse("there are two columns " + json_quoted(cells[i]));
      }
      if (std::ranges::all_of(cells, [](const std::string& cell) {
            return cell.find_first_not_of("0123456789.,+-eE ") == std::string::npos;
          }))
        refuse("the first line must name the columns, as in wavelength_nm,sigma_a");
      table.columns_ = std::move(cells);
      continue;
    }
    if (cells.size() != table.columns_.size())
      refuse("must hold " + std::to_string(table.columns_.size()) +
             " cells, one for each column, but holds " + std::to_string(cells.size()) +
             (separator == ',' && cells.size() > table.columns_.size()
                  ? "; numbers are written with a decimal point"
                  : ""));
    take_memory(memory, cells.size(), sizeof(std::string), table.file_ + ": its cells");
    table.lines_.push_back(line_number);
    std::ranges::move(cells, std::back_inserter(table.cells_));
  }
  if (table.columns_.empty()) throw InvalidInput(table.file_ + ": is empty");
  if (table.lines_.empty()) throw InvalidInput(table.file_ + ": has no line of values");
  return table;
}

CsvTable load_csv(const std::filesystem::path& file, MemoryBudget& memory) {
  return parse_csv(read_file_bytes(file, memory), file.string(), memory);
}

}  // namespace lamina
