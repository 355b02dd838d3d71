// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/measured/iad_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/io/json_output.h"

namespace lamina::fit_detail {
namespace {

struct IadLine {
  std::vector<std::string_view> words;  ///< without comments
  int number;                           ///< counted from 1
};

std::vector<IadLine> iad_lines(std::string_view text) {
  constexpr std::string_view blanks = " \t\f\v,";
  std::vector<IadLine> lines;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    std::string_view line = text.substr(0, std::min(end, text.find('#')));
    text.remove_prefix(end);
    text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1);
    IadLine& of = lines.emplace_back(IadLine{{}, number});
    while (true) {
      line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
      if (line.empty()) break;
      of.words.push_back(line.substr(0, line.find_first_of(blanks)));
      line.remove_prefix(of.words.back().size());
    }
  }
  return lines;
}

std::optional<double> iad_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

/// Columns that a number of measurements stands for, or letters.
using Columns = std::vector<std::string_view>;

class IadReader {
 public:
  IadReader(std::string_view text, const std::string& name) : name_(name) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    lines_ = iad_lines(text);
  }

  [[nodiscard]] IadFile read() {
    if (next("IAD1") != "IAD1") fail("must begin with IAD1");
    IadFile file;
    for (const char* const what : {"the index of the sample", "the index of the slides",
                                   "the thickness of the sample", "the thickness of the slides"})
      static_cast<void>(number(what));  // the material says them
    file.beam_diameter = number("the diameter of the beam");
    file.above.standard_reflectance = number("the reflectance of the standard");
    const double spheres = number("the number of spheres");
    if (spheres != 0.0 && spheres != 1.0)
      fail("the number of spheres must be 0 or 1, but is " + std::string(last_) +
           (spheres == 2.0 ? ": light that passes the sample between two spheres is not modelled"
                           : ""));
    file.spheres = static_cast<int>(spheres);
    for (IntegratingSphere* const sphere : {&file.above, &file.below}) {
      sphere->diameter = number("the diameter of a sphere");
      sphere->sample_port = number("a sample's port");
      sphere->entrance_port = number("an entrance port");
      sphere->detector_port = number("a detector's port");
      sphere->wall_reflectance = number("the reflectance of a wall");
    }
    file.below.standard_reflectance = file.below.wall_reflectance;
    const Columns columns = read_columns();
    file.table = read_table(columns);
    return file;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InvalidInput(name_ + ":" +
                       std::to_string(line_ < lines_.size() ? lines_[line_].number : line_ + 1) +
                       ": " + what);
  }

  std::string_view next(const std::string& what) {
    while (line_ < lines_.size() && word_ == lines_[line_].words.size()) ++line_, word_ = 0;
    if (line_ == lines_.size()) fail(what + " is missing: the file ends");
    return last_ = lines_[line_].words[word_++];
  }

  double number(const std::string& what) {
    const auto value = iad_number(next(what));
    if (!value || *value < 0.0)
      fail(what + " must be a number >= 0, but is " + json_quoted(std::string(last_)));
    return *value;
  }

  /// What follows the wavelength, which stands before it where it exceeds 1.
  Columns read_columns() {
    const std::string_view first = next("the number of measurements");
    if (const auto count = iad_number(first)) {
      constexpr std::array<std::string_view, 7> all = {
          "reflectance", "transmittance", "unscattered_transmittance", "r_w", "t_w",
          "r_std",       "t_std"};
      if (*count == 5.0)
        fail(
            "versions of iad differ in the last of 5 measurements; give 4, or 6 or 7 with both "
            "walls and the standard");
      if (!(*count >= 1.0 && *count <= 7.0 && *count == std::floor(*count)))
        fail("the number of measurements must be one from 1 to 7, but is " + std::string(first));
      return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(*count)};
    }
    Columns columns;
    for (std::string_view word = first;; word = lines_[line_].words[word_++]) {
      constexpr std::array<std::pair<std::string_view, std::string_view>, 5> letters = {
          {{"L", "wavelength_nm"},
           {"r", "reflectance"},
           {"t", "transmittance"},
           {"u", "unscattered_transmittance"},
           {"n", "ior"}}};
      const auto found = std::ranges::find(letters, word, &decltype(letters)::value_type::first);
      if (found == letters.end())
        fail("columns must be L, r, t, u or n, but one is " + json_quoted(std::string(word)));
      columns.push_back(found->second);
      if (word_ == lines_[line_].words.size()) return columns;
    }
  }

  std::string read_table(Columns columns) {
    if (word_ != lines_[line_].words.size())
      fail("measurements must begin on a line of their own, but there is " +
           json_quoted(std::string(lines_[line_].words[word_])));
    const std::size_t head = line_;
    std::vector<std::vector<std::string_view>> rows(lines_.size());
    bool is_first = true;
    std::vector<int> known, unknown;
    for (++line_; line_ < lines_.size(); ++line_) {
      const auto& words = lines_[line_].words;
      if (words.empty()) continue;
      if (is_first && words.size() == columns.size() + 1 &&
          iad_number(words[0]).value_or(0.0) > 1.0)
        columns.insert(columns.begin(), "wavelength_nm");
      if (words.size() != columns.size())
        fail("must hold " + std::to_string(columns.size()) + " numbers, but holds " +
             std::to_string(words.size()));
      if (is_first) known.resize(columns.size()), unknown.resize(columns.size());
      is_first = false;
      for (std::size_t i = 0; i < words.size(); ++i) {
        const auto value = iad_number(words[i]);
        if (!value) fail("must hold numbers, but one is " + json_quoted(std::string(words[i])));
        ++(*value == 0.0 && columns[i].ends_with("transmittance") ? unknown : known)[i];
        if (columns[i] == "t_std" && *value != 1.0)
          fail("t_std must be 1: readings of transmittance are against the empty port");
        if (known[i] > 0 && unknown[i] > 0)
          fail(std::string(columns[i]) +
               " is 0 in some lines, which iad takes for not measured, and not in others; write a "
               "file for each kind");
      }
      rows[line_] = words;
    }
    if (is_first) fail("measurements are missing: the file ends");
    std::string text;
    for (std::size_t line = 0; line < lines_.size(); ++line) {
      std::string row;
      for (std::size_t i = 0; i < columns.size(); ++i)
        if (known[i] > 0 && columns[i] != "ior" && columns[i] != "t_std" &&
            (line == head || !rows[line].empty()))
          row += (row.empty() ? "" : ",") + std::string(line == head ? columns[i] : rows[line][i]);
      text += (row.empty() ? "#" : row) + "\n";
    }
    return text;
  }

  const std::string& name_;
  std::vector<IadLine> lines_;
  std::size_t line_ = 0, word_ = 0;  ///< of what comes next
  std::string_view last_;
};

}  // namespace

IadFile read_iad_file(std::string_view text, const std::string& name) {
  return IadReader(text, name).read();
}

}  // namespace lamina::fit_detail
