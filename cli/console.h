// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"
#include "lamina/base/core/memory_budget.h"
#include "lamina/base/core/progress.h"
#include "lamina/base/io/json_output.h"

namespace lamina::cli {

/// Options that every subcommand has.
struct CommonOptions {
  std::string json;  ///< file for the machine-readable result, "-" for standard output, or ""
  int threads = 0;   ///< 0: all
  std::uint64_t seed = 0;
  MemoryBudget memory;  ///< for reading files
};

/// Adds --json, --threads, --seed and --memory-budget; `options` must outlive the parse.
void add_common_options(const Command& command, CommonOptions& options);

/// Adds --set KEY=VALUE, which changes values of the `file` that a command reads.
void add_settings_option(const Command& command, std::vector<std::string>& settings,
                         const std::string& file,
                         const std::string& example = "camera.look_at or lights[0].scale");

/// Whether this is a device or pipe, such as /dev/null.
[[nodiscard]] bool is_device(const std::string& file);

/// ".png" of "X.PNG"; "" without one.
[[nodiscard]] std::string lower_case_ending(const std::filesystem::path& file);

/// Before the work: whether a file can be written, as far as can be told; "" is none.
/// @throws WriteError
void require_writable(const std::string& file);

/// Before the work: the same of files in a folder, which may have to be made. @throws WriteError
void require_writable_folder(const std::filesystem::path& folder);

/// A file that an option names; "" and "-" are none.
struct NamedFile {
  std::string option, file;
};

/// Before the work: that no result overwrites another, or what the work reads. Options that
/// Command::add_output_file made are looked at already. @throws InvalidInput
void require_different(const std::vector<NamedFile>& files);

/// An option that only some methods read.
struct MethodOption {
  std::string name;
  std::vector<std::string> methods;
};

/// @throws InvalidInput if an option was given that `method` does not read: nothing that a user
/// asks for is passed over in silence.
void refuse_unused(const Command& command, const std::string& method,
                   const std::vector<MethodOption>& options);

/// A result object that starts with "lamina": VERSION and "command": name.
[[nodiscard]] JsonOutput make_result(std::string_view command);

/// Writes the result where --json says; does nothing if it was not given. Comes before print(), so
/// that a file has the result even where standard output cannot be written.
/// @throws WriteError, also if the result holds a number that is not finite
void write_json(const JsonOutput& result, const CommonOptions& options);

/// Prints text for people, unless standard output is taken by --json -. @throws WriteError
void print(const CommonOptions& options, std::string_view text);

/// To standard output, at once. @throws WriteError
void write_output(std::string_view text);

/// Whether text on standard output may have colors: it is a terminal, and NO_COLOR is not set
/// (https://no-color.org) nor TERM "dumb".
[[nodiscard]] bool shows_colors();

/// A line on standard error, "lamina: MESSAGE": printable, and cut in its middle if it is long.
void say(std::string_view message);

/// Text without what would steer a terminal, which is shown as \x1b, but for the bytes `also`.
[[nodiscard]] std::string printable(std::string_view text, std::string_view also);

/// Results that work hands over when it is asked to stop.
enum class Keeps {
  what_there_is,  ///< from the first progress on; until then it is ended at once
  nothing,        ///< before its end: it is ended at once
};

/// A bar with the time left on standard error, as long as the result or a copy of it lives; shown
/// if that is a terminal and the work lasts over a second. Until the work reports, it is the time
/// that has passed. Asks the work to stop after Ctrl-C, SIGTERM or the end of the terminal.
[[nodiscard]] Progress make_progress(std::string label, Keeps keeps = Keeps::what_there_is);

/// Until the next make_progress a signal ends the process at once and without a word, with 130: all
/// is kept, and nothing is at work.
void rest_between_works();

/// Whether work was asked to stop; main then exits with 130. Without work that keeps something, the
/// signal itself ends the process with that code, and so does a second one in any case.
[[nodiscard]] bool was_interrupted();
void watch_for_signals();

/// Text put into a file whole or not at all: written beside it, then renamed.
/// @throws WriteError
void write_file(const std::string& path, std::string_view text);

}  // namespace lamina::cli
