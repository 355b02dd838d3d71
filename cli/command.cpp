// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/memory_budget.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/base/io/whole_number_text.h"

namespace lamina::cli {
namespace {

/// The number itself where a T is one, holds one or may hold one.
template <typename T>
struct NumberIn {
  using Type = T;
};
template <typename T>
struct NumberIn<std::optional<T>> : NumberIn<T> {};
template <typename T>
struct NumberIn<std::vector<T>> : NumberIn<T> {};

template <std::signed_integral Whole>
std::string whole_text(Whole value) {
  return whole_number_text(std::int64_t{value});
}
template <std::unsigned_integral Whole>
std::string whole_text(Whole value) {
  return whole_number_text(std::uint64_t{value});
}

/// An end of a range as help and messages show it.
std::string bound_text(double bound) {
  constexpr double exact = 0x1p53;  // doubles up to here are whole numbers of their own
  if (bound == std::floor(bound) && std::abs(bound) <= exact)
    return whole_text(static_cast<std::int64_t>(bound));
  return fmt::format("{}", bound);
}

/// Makes plain digits of a whole number, which may be given as 1e6. Returns what is wrong with it.
template <typename Whole>
std::string check_whole(std::string& given) {
  const char *const begin = given.data(), *const end = begin + given.size();
  Whole value = 0;
  if (const auto read = std::from_chars(begin, end, value);
      read.ec == std::errc() && read.ptr == end) {
    given = fmt::format("{}", value);  // without zeros before it: the parser takes 010 for 8
    return {};
  }
  double number = 0.0;
  const auto read = std::from_chars(begin, end, number);
  using Limits = std::numeric_limits<Whole>;
  constexpr double exact = 0x1p53;  // doubles up to here are whole numbers of their own
  const bool fits = std::abs(number) <= exact && number >= static_cast<double>(Limits::min()) &&
                    number <= static_cast<double>(Limits::max());
  if (read.ec != std::errc() || read.ptr != end || !fits || number != std::floor(number))
    return fmt::format("must be a whole number in [{}, {}], but is {}", whole_text(Limits::min()),
                       whole_text(Limits::max()), given);
  given = fmt::format("{}", static_cast<Whole>(number));
  return {};
}

std::string check_finite(const std::string& given) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), value);
  const bool is_read = error == std::errc() && end == given.data() + given.size();
  return is_read && std::isfinite(value) ? ""
                                         : fmt::format("must be a finite number, but is {}", given);
}

/// Refuses what is no number, or too large to be one, before anything reads it.
template <typename T>
CLI::Option* with_checked_numbers(CLI::Option* option) {
  using Number = typename NumberIn<T>::Type;
  if constexpr (std::is_floating_point_v<Number>)
    option->check(check_finite, "");
  else if constexpr (std::is_integral_v<Number> && !std::is_same_v<Number, bool>)
    option->transform(
        CLI::Validator([](std::string& given) { return check_whole<Number>(given); }, ""));
  return option;
}

}  // namespace

Option Option::type_name(const std::string& name) const { return Option(option_->type_name(name)); }

Option Option::group(const std::string& title) const { return Option(option_->group(title)); }

Option Option::required() const { return Option(option_->required()); }

Option Option::show_default() const { return Option(option_->capture_default_str()); }

Option Option::delimiter(char c) const { return Option(option_->delimiter(c)); }

Option Option::expected(int count) const { return Option(option_->expected(count)); }

Option Option::range(double low, double high) const {
  const std::string interval = fmt::format("in [{}, {}]", bound_text(low), bound_text(high));
  const std::string in_help = fmt::format("in [{}, {}]", low, high);
  const auto check = [=](const std::string& given) {
    double value;
    if (CLI::detail::lexical_cast(given, value) && value >= low && value <= high)
      return std::string();
    return fmt::format("must be {}, but is {}", interval, given);
  };
  return Option(option_->check(check, in_help));
}

Option Option::repeated() const { return Option(option_->allow_extra_args(false)); }

Option Option::length() const { return range(1e-9, 1e9); }

Option Option::one_of(const std::vector<std::string>& names) const {
  const auto check = [names](const std::string& given) {
    if (std::ranges::find(names, given) != names.end()) return std::string();
    const std::vector<std::string_view> known(names.begin(), names.end());
    return fmt::format("must be one of {}, but is {}{}", fmt::join(names, ", "), given,
                       did_you_mean(given, known));
  };
  return Option(option_->check(check, fmt::format("{{{}}}", fmt::join(names, ","))));
}

Option Option::environment(const std::string& variable) const {
  return Option(option_->envname(variable));
}

bool Option::is_given() const { return option_->count() > 0; }

Command::Command(CLI::App& app, const std::string& name, const std::string& text)
    : app_(app.add_subcommand(name, text)) {}

template <typename T>
Option Command::add_option(const std::string& name, T& value, const std::string& text) const {
  return Option(with_checked_numbers<T>(app_->add_option(name, value, text)));
}

template <typename T>
Option Command::add_flag(const std::string& name, T& value, const std::string& text) const {
  return Option(with_checked_numbers<T>(app_->add_flag(name, value, text)));
}

Option Command::add_step(const std::string& name,
                         const std::function<void(const std::string&)>& take,
                         const std::string& text) const {
  return Option(app_->add_option_function<std::string>(name, take, text)->trigger_on_parse());
}

Option Command::add_output_file(const std::string& name, std::string& file, const std::string& text,
                                const std::string& ending) const {
  constexpr const char* file_type = "FILE";  // marks the files to be written
  const auto check = [app = app_, ending](const std::string& given) {
    if (given != "-") require_writable(given);
    if (!ending.empty() && !is_device(given) && lower_case_ending(given) != ending)
      return fmt::format("must end in {}, but is {}", ending, given);
    std::vector<NamedFile> files;
    for (const CLI::Option* option : app->get_options())
      if (option->get_type_name() == file_type)
        for (const std::string& used : option->results())
          files.push_back({option->get_name(), used});
    require_different(files);
    return std::string();
  };
  return Option(app_->add_option(name, file, text)->type_name(file_type)->check(check, ""));
}

Option Command::add_memory_size(const std::string& name, std::size_t& bytes,
                                const std::string& text) const {
  const auto set = [name, &bytes](const std::string& given) {
    try {
      bytes = parse_memory_size(given);
    } catch (const InvalidInput& error) {
      throw InvalidInput(name + ": " + error.what());
    }
  };
  return Option(app_->add_option_function<std::string>(name, set, text)->type_name("SIZE"));
}

Option Command::add_choice(const std::string& name, const std::vector<std::string>& names,
                           const std::string& default_name,
                           const std::function<void(std::string_view)>& set,
                           const std::string& text) const {
  const auto take = [set](const std::string& given) { set(given); };
  CLI::Option* option = app_->add_option_function<std::string>(name, take, text);
  return Option(option->default_str(default_name)).one_of(names);
}

Option Command::option(const std::string& name) const { return Option(app_->get_option(name)); }

bool Command::is_given(const std::string& name) const { return option(name).is_given(); }

void Command::footer(const std::string& text) const { app_->footer(text); }

void Command::when_parsed(const std::function<void()>& act) const {
  app_->parse_complete_callback(act);
}

void Command::callback(const std::function<void()>& work) const { app_->callback(work); }

template Option Command::add_flag(const std::string&, bool&, const std::string&) const;
template Option Command::add_flag(const std::string&, std::int64_t&, const std::string&) const;
template Option Command::add_option(const std::string&, std::string&, const std::string&) const;
template Option Command::add_option(const std::string&, std::vector<std::string>&,
                                    const std::string&) const;
template Option Command::add_option(const std::string&, int&, const std::string&) const;
template Option Command::add_option(const std::string&, std::uint32_t&, const std::string&) const;
template Option Command::add_option(const std::string&, std::uint64_t&, const std::string&) const;
template Option Command::add_option(const std::string&, double&, const std::string&) const;
template Option Command::add_option(const std::string&, float&, const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<double>&,
                                    const std::string&) const;
template Option Command::add_option(const std::string&, std::vector<double>&,
                                    const std::string&) const;

}  // namespace lamina::cli
