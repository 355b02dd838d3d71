// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/base/io/reading_warnings.h"
#include "lamina/base/io/write_places.h"
#include "lamina/reproduction/run_item.h"
#include "shard_option.h"

namespace {

using namespace lamina::cli;

enum ExitCode { done = 0, failed = 1, wrong_use = 2, interrupted = 130 };

/// The names that would have been understood, for one that was not.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& known) {
  return lamina::did_you_mean(name, std::vector<std::string_view>(known.begin(), known.end()));
}

/// What is wrong with a command line that the parser refuses.
std::string explain(const CLI::App& app, const CLI::ParseError& error,
                    const std::vector<std::string>& arguments) {
  const auto chosen = app.get_subcommands();
  if (chosen.empty()) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    if (!arguments.empty() && !arguments[0].starts_with('-'))
      return fmt::format("there is no subcommand \"{}\"{}; see lamina --help", arguments[0],
                         did_you_mean(arguments[0], names));
    return fmt::format("{}; see lamina --help", error.what());
  }
  const CLI::App& command = *chosen[0];
  std::string what = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& argument : arguments) {
      const std::string name = argument.substr(0, argument.find('='));
      if (name.starts_with("--") && std::ranges::find(names, name) == names.end())
        what = fmt::format("there is no option {}{}", name, did_you_mean(name, names));
    }
  }
  return fmt::format("{}; see lamina {} --help", what, command.get_name());
}

/// Who runs what a stranger has written, as `reproduce` does, names the only folder to write to.
/// The cache is written, too, under names that nobody chooses.
void hold_to_write_folder() {
  const char* folder = std::getenv("LAMINA_WRITE_FOLDER");
  if (!folder || *folder == '\0') return;
  std::vector<std::filesystem::path> folders = {folder};
  if (const auto cache = lamina::user_cache()) folders.push_back(cache->folder);
  lamina::write_only_inside(std::move(folders));
}

int run(int argc, char** argv) {
  set_words_of_call(argc, argv);
  lamina::tell_reading_warnings([](const std::string& text) { say("warning: " + text); });
  CLI::App app("Light in layered translucent materials: predict and render.", "lamina");
  app.set_version_flag("--version", LAMINA_VERSION);
  app.require_subcommand(1);
  add_bsdf_command(app);
  add_acquire_command(app);
  add_completion_command(app);
  add_edit_command(app);
  add_export_command(app);
  add_import_command(app);
  add_filters_command(app);
  add_fit_command(app);
  add_info_command(app);
  add_invert_command(app);
  add_maps_command(app);
  add_materials_command(app);
  add_merge_command(app);
  add_patch_command(app);
  add_photons_command(app);
  add_profile_command(app);
#ifdef LAMINA_RENDER
  add_render_command(app);
#endif
  add_reproduce_command(app);
#ifdef LAMINA_RENDER
  add_serve_command(app);
#endif
  add_slab_command(app);
  add_status_command(app);
  add_submit_command(app);
  try {
    hold_to_write_folder();
    app.parse(argc, argv);
    return was_interrupted() ? interrupted : done;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      say(explain(app, error, std::vector<std::string>(argv + std::min(argc, 1), argv + argc)));
      return wrong_use;
    }
    std::ostringstream text;  // of --help or --version
    app.exit(error, text, text);
    write_output(text.str());
    return done;
  }
}

/// Runs the command and turns what it throws into a line and an exit code.
int run_and_explain(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const lamina::Interrupted& error) {
    say(error.what());
    return interrupted;
  } catch (const lamina::WriteError& error) {
    say(error.what());
    return failed;
  } catch (const lamina::ReproductionFailed& error) {
    say(error.what());
    return failed;
  } catch (const lamina::Error& error) {
    say(error.what());
    return wrong_use;
  } catch (const std::bad_alloc&) {
    say("not enough memory");
    return failed;
  } catch (const std::exception& error) {
    say(error.what());
    return failed;
  }
}

/// Standard streams that the caller has closed: else the first files opened would take their place,
/// and get what is printed.
void hold_closed_streams() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(number, F_GETFD) < 0 && errno == EBADF)
      (void)!open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY);  // using it fails
}

}  // namespace

int main(int argc, char** argv) {
  hold_closed_streams();
  watch_for_signals();
  const int code = run_and_explain(argc, argv);
  if (std::fclose(stdout) == 0) return code;
  say(fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
  return code == done ? failed : code;
}
