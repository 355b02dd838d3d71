// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/enum_names.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lamina::cli {

/// A handle of an option that was added to a command; each setter returns the option again.
class Option {
 public:
  Option() = default;
  explicit Option(CLI::Option* option) : option_(option) {}

  Option type_name(const std::string& name) const;
  Option group(const std::string& title) const;  ///< the heading it has in the help
  Option required() const;
  Option show_default() const;
  Option delimiter(char c) const;                              ///< between the values of a list
  Option expected(int count) const;                            ///< how many values there are
  Option repeated() const;                                     ///< a list: one value each time
  Option range(double low, double high) const;                 ///< both ends are allowed
  Option length() const;                                       ///< the range of lengths in mm
  Option one_of(const std::vector<std::string>& names) const;  ///< the values that are allowed
  Option environment(const std::string& variable) const;       ///< that it is taken from otherwise
  [[nodiscard]] bool is_given() const;

 private:
  CLI::Option* option_ = nullptr;
};

/// A handle of a subcommand. The parser behind it, CLI11, is included by command.cpp, main.cpp and
/// completion_command.cpp only, since every file that includes it takes ten seconds more to
/// compile.
class Command {
 public:
  Command(CLI::App& app, const std::string& name, const std::string& text);

  /// `value` must outlive the parse. Numbers must be finite, whole ones may be given as 1e6. A T is
  /// a std::string, bool (flags only), a number, a std::optional or std::vector of one; the list is
  /// at the end of command.cpp.
  template <typename T>
  Option add_option(const std::string& name, T& value, const std::string& text) const;
  template <typename T>
  Option add_flag(const std::string& name, T& value, const std::string& text) const;

  /// The name of a value of an enum; `value` is the default.
  template <NamedEnum E>
  Option add_choice(const std::string& name, E& value, const std::string& text) const {
    std::vector<std::string> names;
    for (const auto& known : enum_names<E>) names.emplace_back(known.name);
    return add_choice(
        name, names, std::string(name_of(value)),
        [&value](std::string_view given) { value = *find_enum_value<E>(given); }, text);
  }

  /// An option that may be given any number of times, in an order that counts among all of its
  /// kind: `take` gets each value when its turn comes.
  Option add_step(const std::string& name, const std::function<void(const std::string&)>& take,
                  const std::string& text) const;

  /// A file to be written, which is refused before the work if it cannot be, or if it has another
  /// `ending` than it must have. "-" passes: --json takes it for standard output.
  Option add_output_file(const std::string& name, std::string& file, const std::string& text,
                         const std::string& ending = "") const;

  /// A size of memory with its unit, as in 4GiB.
  Option add_memory_size(const std::string& name, std::size_t& bytes,
                         const std::string& text) const;

  [[nodiscard]] Option option(const std::string& name) const;  ///< one of those added
  [[nodiscard]] bool is_given(const std::string& name) const;
  void footer(const std::string& text) const;
  void when_parsed(const std::function<void()>& act) const;  ///< before the callback
  void callback(const std::function<void()>& work) const;

 private:
  Option add_choice(const std::string& name, const std::vector<std::string>& names,
                    const std::string& default_name,
                    const std::function<void(std::string_view)>& set,
                    const std::string& text) const;

  CLI::App* app_;
};

}  // namespace lamina::cli
