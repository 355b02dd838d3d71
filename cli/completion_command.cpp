// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// Scripts for shells and pages for man, of the options that the subcommands have.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/layers/materials/builtin_texts.h"

namespace lamina::cli {
namespace {

/// What a shell needs to know of an option.
struct OptionWords {
  std::vector<std::string> names;   ///< "--method", "-o"; empty: it is given by its place
  std::vector<std::string> values;  ///< those that are allowed, if they are few
  bool takes_value = false, is_file = false, is_material = false;
  std::string type, text;
};

OptionWords words_of(const CLI::Option& option) {
  OptionWords words;
  for (const std::string& name : option.get_lnames()) words.names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) words.names.push_back("-" + name);
  words.text = option.get_description();
  words.takes_value = option.get_items_expected_max() > 0;
  words.type = option.get_type_name();  // with what checks say: "TEXT:{all,none}"
  const std::size_t begin = words.type.find('{'), end = words.type.find('}');
  if (begin != std::string::npos && end != std::string::npos)
    words.values = CLI::detail::split(words.type.substr(begin + 1, end - begin - 1), ',');
  for (const char* of : {"TEXT:", "FLOAT:", "INT:", "UINT:"})  // the parser's, not the users'
    if (words.type.starts_with(of)) words.type.erase(0, std::string_view(of).size());
  words.is_material = words.type.starts_with("MATERIAL");
  for (const char* kind : {"FILE", "FOLDER", "IMAGE", "NAME", "PATCH", "MEASUREMENT", "CAPTURE",
                           "SCENE", "RECIPE", "MAPS", "MATERIAL"})
    words.is_file = words.is_file || words.type.starts_with(kind);
  if (words.names.empty())
    words.is_file = words.values.empty() && !words.type.starts_with("SUBCOMMAND");
  return words;
}

/// Once for every option of a subcommand that users see.
std::vector<OptionWords> options_of(const CLI::App& command) {
  std::vector<OptionWords> all;
  for (const CLI::Option* option : command.get_options())
    if (!option->get_group().empty()) all.push_back(words_of(*option));
  return all;
}

std::vector<const CLI::App*> subcommands_of(const CLI::App& app) {
  std::vector<const CLI::App*> all;
  for (const CLI::App* command : app.get_subcommands({})) all.push_back(command);
  return all;
}

std::vector<std::string> names_of_subcommands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : subcommands_of(app)) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> materials() {
  std::vector<std::string> names;
  for (const std::string_view name : builtin_material_names()) names.emplace_back(name);
  return names;
}

std::string replaced(std::string text, std::string_view what, std::string_view with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string bash_script(const CLI::App& app) {
  std::string text = fmt::format(
      "# Completion of lamina for bash.\n"
      "_lamina() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} command= "
      "i\n"
      "  if [ \"$current\" = = ]; then current=; elif [ \"$before\" = = ]; then "
      "before=${{COMP_WORDS[COMP_CWORD-2]}}; fi\n"
      "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
      "    case ${{COMP_WORDS[i]}} in -*) ;; *) command=${{COMP_WORDS[i]}}; break ;; esac\n"
      "  done\n"
      "  local names= materials=\"{}\" files= \n"
      "  case $command in\n"
      "    '') names=\"{} --help --version\" ;;\n",
      fmt::join(materials(), " "), fmt::join(names_of_subcommands(app), " "));
  for (const CLI::App* command : subcommands_of(app)) {
    std::vector<std::string> names;
    std::string cases;
    OptionWords place;  // what stands without an option, all places together
    const auto offer = [](const OptionWords& option) {
      return fmt::format("names=\"{}{}\"; files={}", fmt::join(option.values, " "),
                         option.is_material ? "$materials" : "", option.is_file ? "1" : "");
    };
    for (const OptionWords& option : options_of(*command)) {
      names.insert(names.end(), option.names.begin(), option.names.end());
      if (option.names.empty()) {
        place.values.insert(place.values.end(), option.values.begin(), option.values.end());
        place.is_file = place.is_file || option.is_file;
        place.is_material = place.is_material || option.is_material;
      } else if (option.takes_value) {
        cases += fmt::format("        {}) {} ;;\n", fmt::join(option.names, "|"), offer(option));
      }
    }
    text += fmt::format(
        "    {})\n      case $before in\n{}        *) if [[ $current == -* ]]; then names=\"{}\"; "
        "else {}; fi ;;\n      esac ;;\n",
        command->get_name(), cases, fmt::join(names, " "), offer(place));
  }
  return text +
         "  esac\n"
         "  COMPREPLY=($(compgen -W \"$names\" -- \"$current\"))\n"
         "  [ -n \"$files\" ] && COMPREPLY+=($(compgen -f -- \"$current\"))\n"
         "  return 0\n"
         "}\n"
         "complete -o filenames -F _lamina lamina\n";
}

std::string zsh_text(const std::string& text) {
  std::string quoted = replaced(first_line(text), "'", "'\\''");
  for (const char* sign : {"[", "]", ":"})
    quoted = replaced(quoted, sign, std::string("\\") + sign);
  return quoted;
}

std::string zsh_script(const CLI::App& app) {
  std::string text = fmt::format(
      "#compdef lamina\n# Completion of lamina for zsh.\n_lamina_materials() {{\n"
      "  local -a names=({})\n  _describe -t materials 'built-in material' names\n  _files\n}}\n"
      "_lamina() {{\n  local -a commands=(\n",
      fmt::join(materials(), " "));
  for (const CLI::App* command : subcommands_of(app))
    text += fmt::format("    '{}:{}'\n", command->get_name(), zsh_text(command->get_description()));
  text +=
      "  )\n  if ((CURRENT == 2)); then\n    _describe -t commands 'subcommand' commands\n"
      "    _arguments '--help[prints help]' '--version[prints the version]'\n    return\n  fi\n"
      "  local command=$words[2]\n  shift words\n  ((CURRENT--))\n  case $command in\n";
  for (const CLI::App* command : subcommands_of(app)) {
    text += fmt::format("    {})\n      _arguments", command->get_name());
    for (const OptionWords& option : options_of(*command)) {
      const std::string what = option.is_material ? "_lamina_materials"
                               : !option.values.empty()
                                   ? fmt::format("({})", fmt::join(option.values, " "))
                               : option.is_file ? "_files"
                                                : " ";
      if (option.names.empty())
        text += fmt::format(" \\\n        '*:{}:{}'", zsh_text(option.text), what);
      for (const std::string& name : option.names)
        text += fmt::format(" \\\n        '{}[{}]{}'", name, zsh_text(option.text),
                            option.takes_value ? fmt::format(":value:{}", what) : "");
    }
    text += " ;;\n";
  }
  return text + "  esac\n}\n_lamina \"$@\"\n";
}

std::string fish_text(const std::string& text) {
  return replaced(replaced(first_line(text), "\\", "\\\\"), "'", "\\'");
}

std::string fish_script(const CLI::App& app) {
  std::string text = "# Completion of lamina for fish.\n";
  for (const CLI::App* command : subcommands_of(app))
    text += fmt::format("complete -c lamina -n __fish_use_subcommand -f -a {} -d '{}'\n",
                        command->get_name(), fish_text(command->get_description()));
  text +=
      "complete -c lamina -n __fish_use_subcommand -l help -d 'prints help'\n"
      "complete -c lamina -n __fish_use_subcommand -l version -d 'prints the version'\n";
  for (const CLI::App* command : subcommands_of(app)) {
    const std::string of =
        fmt::format("complete -c lamina -n '__fish_seen_subcommand_from {}'", command->get_name());
    for (const OptionWords& option : options_of(*command)) {
      const std::string values =
          option.is_material      ? fmt::format(" -a '{}'", fmt::join(materials(), " "))
          : option.values.empty() ? ""
                                  : fmt::format(" -a '{}'", fmt::join(option.values, " "));
      if (option.names.empty()) {
        if (!values.empty()) text += of + values + "\n";
        continue;
      }
      std::string names;
      for (const std::string& name : option.names)
        names += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      const char* takes = !option.takes_value ? "" : option.is_file ? " -r" : " -x";
      text += of + names + takes + values + " -d '" + fish_text(option.text) + "'\n";
    }
  }
  return text;
}

/// As roff reads it.
std::string roff(const std::string& text) {
  std::string quoted = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  if (quoted.starts_with('.') || quoted.starts_with('\'')) quoted = "\\&" + quoted;
  return replaced(replaced(quoted, "\n.", "\n\\&."), "\n'", "\n\\&'");
}

std::string man_page(const CLI::App& app, const CLI::App* command) {
  const std::string name = command ? "lamina-" + command->get_name() : "lamina";
  const CLI::App& what = command ? *command : app;
  std::string text =
      fmt::format(".TH {} 1 \"\" \"lamina {}\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B lamina{}\n",
                  replaced(name, "-", "\\-"), LAMINA_VERSION, roff(name),
                  roff(what.get_description()), command ? " " + command->get_name() : "");
  std::string places, options;
  for (const OptionWords& option : options_of(what)) {
    if (option.names.empty()) {
      places += fmt::format(" {}", option.type.substr(0, option.type.find(':')));
      continue;
    }
    options +=
        fmt::format(".TP\n.B {}{}\n{}\n", roff(fmt::format("{}", fmt::join(option.names, ", "))),
                    option.takes_value  // a long list of values may end a line behind each comma
                        ? " \\fI" + replaced(roff(option.type), ",", ",\\:") + "\\fR"
                        : "",
                    roff(option.text));
  }
  text += command ? fmt::format("[\\fIOPTIONS\\fR]{}\n", roff(places))
                  : "\\fISUBCOMMAND\\fR [\\fIOPTIONS\\fR]\n";
  if (!command) {
    text += ".SH SUBCOMMANDS\n";
    for (const CLI::App* one : subcommands_of(app))
      text += fmt::format(".TP\n.BR lamina\\-{} (1)\n{}\n", one->get_name(),
                          roff(one->get_description()));
  }
  text += ".na\n.SH OPTIONS\n" + options;
  if (!what.get_footer().empty()) text += ".SH NOTES\n.nf\n" + roff(what.get_footer()) + "\n.fi\n";
  text +=
      ".SH EXIT STATUS\n0: done; 2: wrong use or input, in a line; 1: failed, as where a file "
      "cannot be written; 130: ended by Ctrl\\-C.\n.SH SEE ALSO\n";
  return text + (command ? ".BR lamina (1)\n" : "the guide, docs/index.md\n");
}

struct CompletionOptions {
  std::string kind, page;
};

void run_completion(const CLI::App& app, const CompletionOptions& options) {
  if (options.kind == "bash") return write_output(bash_script(app));
  if (options.kind == "zsh") return write_output(zsh_script(app));
  if (options.kind == "fish") return write_output(fish_script(app));
  if (options.page.empty()) return write_output(man_page(app, nullptr));
  for (const CLI::App* command : subcommands_of(app))
    if (command->get_name() == options.page) return write_output(man_page(app, command));
  throw InvalidInput(fmt::format("page: must be one of {}, but is {}",
                                 fmt::join(names_of_subcommands(app), ", "), options.page));
}

}  // namespace

void add_completion_command(CLI::App& app) {
  auto options = std::make_shared<CompletionOptions>();
  const Command command(app, "completion",
                        "Prints what completes command lines in a shell, or a page for man.");
  command.add_option("kind", options->kind, "bash, zsh or fish: a script; man: a page")
      .one_of({"bash", "zsh", "fish", "man"})
      .required();
  command.add_option("page", options->page, "of man: the subcommand; without one, of all of lamina")
      .type_name("SUBCOMMAND");
  command.footer(
      "Installed with lamina. To try it in this shell:\n"
      "  eval \"$(lamina completion bash)\"\n"
      "A page\n"
      "  lamina completion man render > render.1 && man -l render.1");
  command.callback([options, &app] {
    if (!options->page.empty() && options->kind != "man")
      throw InvalidInput("page: is for man, but the kind is " + options->kind);
    run_completion(app, *options);
  });
}

}  // namespace lamina::cli
