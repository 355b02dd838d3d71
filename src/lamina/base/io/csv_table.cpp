// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/csv_table.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/internal/range_rule.h"
#include "lamina/base/io/json_output.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/base/io/utf8_text.h"

namespace lamina {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r";
  const std::size_t first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

struct TextLine {
  std::string_view text;
  int number;  ///< counted from 1
};

/// Lines that are neither empty nor comments, whether they end as those of Unix, Windows or old
/// Macs.
std::vector<TextLine> lines_of(std::string_view text) {
  std::vector<TextLine> lines;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end);
    text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1);
    if (!trimmed(line).empty() && !line.starts_with('#')) lines.push_back({line, number});
  }
  return lines;
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

/// Cells in a line. Blanks part them in runs, and tabs count as blanks among these.
std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells;
  if (separator == ' ') {
    for (std::string_view rest = trimmed(line); !rest.empty();) {
      const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
      cells.emplace_back(rest.substr(0, end));
      rest = trimmed(rest.substr(end));
    }
    return cells;
  }
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
    list += (i > 0 ? ", " : "") + json_quoted(excerpt(names[i]));
  return list + (names.size() > most ? ", ..." : "");
}

/// A cell as a number, if it is one: with a decimal point, or with the mark in its place.
std::optional<double> number_of(std::string_view cell, char decimal_mark = '.') {
  std::string text(cell.substr(cell.starts_with('+') ? 1 : 0));
  if (decimal_mark != '.') std::ranges::replace(text, decimal_mark, '.');
  const char* const end = text.data() + text.size();
  double value = 0.0;
  const auto read = std::from_chars(text.data(), end, value);
  if (text.empty() || read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return value;
}

bool has_decimal_comma(std::string_view cell) {
  const std::size_t comma = cell.find(',');
  return comma != std::string_view::npos &&
         cell.find_first_not_of("0123456789,+-eE") == std::string_view::npos;
}

struct TableShape {
  std::size_t head = 0;  ///< the line that names the columns
  char separator = ',';
};

bool is_number(const std::string& cell) {
  return number_of(cell).has_value() || (has_decimal_comma(cell) && number_of(cell, ','));
}

/// Whether all cells are numbers but for an empty last one, and there are two at least.
bool are_numbers(std::vector<std::string> cells) {
  if (cells.size() > 2 && cells.back().empty()) cells.pop_back();
  return cells.size() > 1 && std::ranges::all_of(cells, is_number);
}

/// The first line names the columns, unless there are lines before it that an instrument says of
/// itself: then it is the line before the first of numbers, which also says how cells are parted.
TableShape shape_of(const std::vector<TextLine>& lines) {
  const TableShape plain{.head = 0, .separator = find_separator(lines[0].text)};
  for (std::size_t i = 1; i < lines.size(); ++i)
    for (const char separator : {'\t', ';', ',', ' '}) {
      const std::vector<std::string> cells = cells_of(lines[i].text, separator);
      if (!are_numbers(cells)) continue;
      const std::vector<std::string> names = cells_of(lines[i - 1].text, separator);
      const bool is_head = names.size() == cells.size() && std::ranges::none_of(names, is_number);
      return is_head ? TableShape{.head = i - 1, .separator = separator} : plain;
    }
  return plain;
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
  throw InvalidInput(file_ + ": there is no column " + json_quoted(excerpt(name)) + " among " +
                     quoted_names(columns_) + did_you_mean(name, known));
}

double CsvTable::number(std::size_t row, std::size_t column, const NumberRange& range) const {
  const std::string& cell = text(row, column);
  const std::optional<double> value = number_of(cell, decimal_mark_);
  if (value && input_detail::contains(range, *value)) return *value;
  fail(row, column,
       input_detail::rule_of(range) + ", but is " +
           (value                     ? excerpt(cell)
            : cell.empty()            ? "empty"
            : has_decimal_comma(cell) ? json_quoted(excerpt(cell)) + "; write a decimal point"
                                      : json_quoted(excerpt(cell))));
}

void CsvTable::reverse_rows() {
  const std::size_t width = columns_.size();
  for (std::size_t low = 0, high = rows(); low + 1 < high; ++low) {
    --high;
    std::swap(lines_[low], lines_[high]);
    for (std::size_t column = 0; column < width; ++column)
      std::swap(cells_[low * width + column], cells_[high * width + column]);
  }
}

void CsvTable::fail(std::size_t row, std::size_t column, std::string_view message) const {
  throw InvalidInput(file_ + ":" + std::to_string(lines_[row]) + ": " + excerpt(columns_[column]) +
                     " " + std::string(message));
}

CsvTable parse_csv(std::string_view text, std::string name, MemoryBudget& memory) {
  CsvTable table;
  table.file_ = std::move(name);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  const auto refuse = [&](int line, const std::string& what) {
    throw InvalidInput(table.file_ + ":" + std::to_string(line) + ": " + what);
  };
  const std::vector<TextLine> lines = lines_of(text);
  if (lines.empty()) throw InvalidInput(table.file_ + ": is empty");
  const TableShape shape = shape_of(lines);
  const char separator = shape.separator;
  const TextLine& head = lines[shape.head];
  if (!is_utf8(head.text)) refuse(head.number, "must be UTF-8");
  table.columns_ = cells_of(head.text, separator);
  // Some instruments end each line with a separator.
  const bool has_empty_end =
      table.columns_.size() > 2 && table.columns_.back().empty() &&
      std::ranges::all_of(lines.begin() + shape.head + 1, lines.end(), [&](const TextLine& line) {
        return cells_of(line.text, separator).back().empty();
      });
  if (has_empty_end) table.columns_.pop_back();
  const std::vector<std::string>& columns = table.columns_;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].empty()) refuse(head.number, "column " + std::to_string(i + 1) + " has no name");
    if (std::ranges::count(columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(i),
                           columns[i]) > 0)
      refuse(head.number, "there are two columns " + json_quoted(excerpt(columns[i])));
  }
  if (std::ranges::all_of(columns, [](const std::string& cell) {
        return cell.find_first_not_of("0123456789.,+-eE ") == std::string::npos;
      }))
    refuse(head.number, "the first line must name the columns, as in wavelength_nm,sigma_a");
  bool has_point = false, has_comma = false;
  for (std::size_t i = shape.head + 1; i < lines.size(); ++i) {
    const TextLine& line = lines[i];
    if (!is_utf8(line.text)) refuse(line.number, "must be UTF-8");
    std::vector<std::string> cells = cells_of(line.text, separator);
    if (has_empty_end) cells.pop_back();
    if (cells.size() != columns.size())
      refuse(line.number, "must hold " + std::to_string(columns.size()) +
                              " cells, one for each column, but holds " +
                              std::to_string(cells.size()) +
                              (separator == ',' && cells.size() > columns.size()
                                   ? "; numbers are written with a decimal point"
                                   : ""));
    take_memory(memory, cells.size(), sizeof(std::string), table.file_ + ": its cells");
    for (const std::string& cell : cells) {
      has_comma = has_comma || has_decimal_comma(cell);
      has_point = has_point || (cell.find('.') != std::string::npos && number_of(cell));
    }
    table.lines_.push_back(line.number);
    std::ranges::move(cells, std::back_inserter(table.cells_));
  }
  if (table.lines_.empty()) throw InvalidInput(table.file_ + ": has no line of values");
  if (has_comma && !has_point) table.decimal_mark_ = ',';
  return table;
}

CsvTable load_csv(const std::filesystem::path& file, MemoryBudget& memory) {
  return parse_csv(read_file_bytes(file, memory), file.string(), memory);
}

std::string csv_cell(std::string_view text) {
  std::string cell;
  for (const char c : text) cell += static_cast<unsigned char>(c) < 32 || c == 127 ? ' ' : c;
  if (!cell.empty() && std::string_view("=+-@").find(cell.front()) != std::string_view::npos &&
      !number_of(cell))
    cell.insert(0, 1, '\'');
  if (cell.find_first_of(",;\"'") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace lamina
