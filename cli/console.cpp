// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "console.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <span>
#include <system_error>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/write_places.h"
#include "lamina/base/io/zero_signs.h"

namespace lamina::cli {

namespace fs = std::filesystem;

namespace {

/// Why the system takes no file of this name, such as one that is too long; "" if it does, or would
/// were the folder there.
std::string refusal_of_name(const fs::path& file) {
  struct stat status {};
  if (lstat(file.c_str(), &status) == 0 || errno == ENOENT) return {};
  return std::generic_category().message(errno);
}

}  // namespace

void write_output(std::string_view text) {
  const bool is_written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!is_written || std::fflush(stdout) != 0)
    throw WriteError(std::string("standard output: cannot be written: ") + std::strerror(errno));
}

bool shows_colors() {
  const auto is_set = [](const char* name, std::string_view unless) {
    const char* const value = std::getenv(name);
    return value && value != unless;
  };
  return isatty(STDOUT_FILENO) == 1 && !is_set("NO_COLOR", "") && is_set("TERM", "dumb");
}

void add_common_options(const Command& command, CommonOptions& options) {
  command.add_output_file("--json", options.json,
                          "write the result as JSON to FILE, or - for stdout");
  command.add_option("--threads", options.threads, "threads to use; 0 for all")
      .type_name("N")
      .range(0, 4096);
  command.when_parsed([&options] { set_thread_count(options.threads); });
  command.add_option("--seed", options.seed, "seed of everything random").type_name("N");
  command
      .add_memory_size("--memory-budget", options.memory.left,
                       "memory that reading files may take, such as 512MiB or 16GiB; 4GiB if not "
                       "given")
      .environment("LAMINA_MEMORY_BUDGET");
}

void add_settings_option(const Command& command, std::vector<std::string>& settings,
                         const std::string& file, const std::string& example) {
  command
      .add_option("--set", settings,
                  "changes a value of the " + file + ": a path in it, such as " + example +
                      ", and JSON or a "
                      "bare string; null removes, list[+] adds an element. As often as needed")
      .type_name("KEY=VALUE")
      .repeated();
}

bool is_device(const std::string& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

std::string lower_case_ending(const fs::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending)
    if ('A' <= c && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return ending;
}

void require_writable(const std::string& file) {
  if (file.empty()) return;
  require_write_place(file);
  std::error_code error;
  const auto fail = [&](const std::string& reason) {
    throw WriteError(file + ": cannot be written: " + reason);
  };
  if (fs::is_directory(file, error)) fail("it is a folder");
  const fs::path parent = fs::path(file).parent_path();
  const fs::path folder = parent.empty() ? fs::path(".") : parent;
  if (!fs::is_directory(folder, error)) fail("there is no folder " + folder.string());
  if (const std::string refusal = refusal_of_name(file); !refusal.empty()) fail(refusal);
  if (access(is_device(file) ? file.c_str() : folder.c_str(), W_OK) != 0) fail("no permission");
}

void require_writable_folder(const fs::path& folder) {
  const auto fail = [&](const std::string& reason) {
    throw WriteError(folder.string() + ": the folder cannot be written to: " + reason);
  };
  if (const std::string refusal = refusal_of_name(folder); !refusal.empty()) fail(refusal);
  std::error_code error;
  fs::path there = fs::absolute(folder, error).lexically_normal();
  while (!fs::exists(there, error) && there.has_relative_path()) there = there.parent_path();
  if (!fs::is_directory(there, error)) fail(there.string() + " is a file");
  if (access(there.c_str(), W_OK | X_OK) != 0) fail("no permission");
}

void require_different(const std::vector<NamedFile>& files) {
  std::map<fs::path, std::string> option_of;
  for (const auto& [option, file] : files) {
    std::error_code error;
    if (file.empty() || file == "-") continue;
    if (is_device(file)) continue;  // such as /dev/null
    const auto [place, is_new] =
        option_of.try_emplace(fs::weakly_canonical(fs::absolute(file), error), option);
    if (!is_new)
      throw InvalidInput(fmt::format("{} and {}: must be different files, but both are {}",
                                     place->second, option, file));
  }
}

void refuse_unused(const Command& command, const std::string& method,
                   const std::vector<MethodOption>& options) {
  for (const auto& [name, methods] : options) {
    if (!command.is_given(name) || std::ranges::count(methods, method) > 0) continue;
    throw InvalidInput(fmt::format("{}: is read by --method {} only, but the method is {}", name,
                                   fmt::join(methods, ", "), method));
  }
}

JsonOutput make_result(std::string_view command) {
  return {{"lamina", LAMINA_VERSION}, {"command", command}};
}

void write_json(const JsonOutput& result, const CommonOptions& options) {
  result.require_numbers();
  if (options.json.empty()) return;
  const std::string text = result.text(1) + "\n";
  if (options.json == "-")
    write_output(text);
  else
    write_file(options.json, text);
}

void print(const CommonOptions& options, std::string_view text) {
  if (options.json != "-") write_output(printable(without_negative_zeros(text), "\n\t"));
}

void write_file(const std::string& path, std::string_view text) {
  write_file_bytes(path, std::span(reinterpret_cast<const std::byte*>(text.data()), text.size()));
}

}  // namespace lamina::cli
