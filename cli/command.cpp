// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>

#include "console.h"

namespace lamina::cli {
Option Option::type_name(const std::string& name) const { return Option(option_->type_name(name)); }

Option Option::group(const std::string& title) const { return Option(option_->group(title)); }

Option Option::required() const { return Option(option_->required()); }

Option Option::show_default() const { return Option(option_->capture_default_str()); }

Option Option::delimiter(char c) const { return Option(option_->delimiter(c)); }

Option Option::expected(int count) const { return Option(option_->expected(count)); }

Option Option::range(double low, double high) const {
  const std::string interval = fmt::format("in [{}, {}]", low, high);
  const auto check = [=](const std::string& given) {
    double value;
    if (CLI::detail::lexical_cast(given, value) && value >= low && value <= high)
      return std::string();
    return fmt::format("must be {}, but is {}", interval, given);
  };
  return Option(option_->check(check, interval));
}

Option Option::one_of(const std::vector<std::string>& names) const {
  return Option(option_->check(CLI::IsMember(names)));
}

bool Option::is_given() const { return option_->count() > 0; }

Command::Command(CLI::App& app, const std::string& name, const std::string& text)
    : app_(app.add_subcommand(name, text)) {}

template <typename T>
Option Command::add_option(const std::string& name, T& value, const std::string& text) const {
  return Option(app_->add_option(name, value, text));
}

template <typename T>
Option Command::add_flag(const std::string& name, T& value, const std::string& text) const {
  return Option(app_->add_flag(name, value, text));
}

Option Command::add_output_file(const std::string& name, std::string& file,
                                const std::string& text) const {
  constexpr const char* file_type = "FILE";  // marks the files to be written
  const auto check = [app = app_](const std::string& given) {
    if (given != "-") require_writable(given);
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

Option Command::option(const std::string& name) const { return Option(app_->get_option(name)); }

bool Command::is_given(const std::string& name) const { return option(name).is_given(); }

void Command::footer(const std::string& text) const { app_->footer(text); }

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
