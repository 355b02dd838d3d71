// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "console.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <span>

#include "lamina/core/error.h"
#include "lamina/core/file_bytes.h"

namespace lamina::cli {
namespace {

std::atomic<bool> interrupted{false};

class Bar {
 public:
  explicit Bar(std::string label) : label_(std::move(label)) {}
  ~Bar() {
    if (shown_) fmt::print(stderr, "\r\033[K");
  }
  Bar(const Bar&) = delete;
  Bar& operator=(const Bar&) = delete;

  bool operator()(double finished) {
    if (interrupted) return false;
    if (!is_terminal_) return true;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return true;
    const auto now = std::chrono::steady_clock::now();
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    if (elapsed < 1.0 || std::chrono::duration<double>(now - last_).count() < 0.1) return true;
    last_ = now;
    shown_ = true;
    constexpr int width = 32;
    const int filled = static_cast<int>(finished * width);
    const double left = finished > 0.0 ? elapsed * (1.0 - finished) / finished : 0.0;
    fmt::print(stderr, "\r{} [{:#<{}}{:.<{}}] {:3.0f} %, {:.0f} s left\033[K", label_, "", filled,
               "", width - filled, 100.0 * finished, left);
    return true;
  }

 private:
  std::string label_;
  bool is_terminal_ = isatty(STDERR_FILENO) == 1;
  bool shown_ = false;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_ = start_;
};

}  // namespace

void add_common_options(const Command& command, CommonOptions& options) {
  command.add_output_file("--json", options.json,
                          "write the result as JSON to FILE, or - for stdout");
  command.add_option("--threads", options.threads, "threads to use; 0 for all")
      .type_name("N")
      .range(0, 4096);
  command.add_option("--seed", options.seed, "seed of everything random").type_name("N");
}

void require_writable(const std::string& file) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto fail = [&](const std::string& reason) {
    throw WriteError(file + ": cannot be written: " + reason);
  };
  if (fs::is_directory(file, error)) fail("it is a folder");
  const fs::path parent = fs::path(file).parent_path();
  const fs::path folder = parent.empty() ? fs::path(".") : parent;
  if (!fs::is_directory(folder, error)) fail("there is no folder " + folder.string());
  const bool is_device = fs::exists(file, error) && !fs::is_regular_file(file, error);
  if (access(is_device ? file.c_str() : folder.c_str(), W_OK) != 0) fail("no permission");
}

void require_different(const std::vector<NamedFile>& files) {
  namespace fs = std::filesystem;
  std::map<fs::path, std::string> option_of;
  for (const auto& [option, file] : files) {
    std::error_code error;
    if (file.empty() || file == "-") continue;
    if (fs::exists(file, error) && !fs::is_regular_file(file, error)) continue;  // /dev/null
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

nlohmann::ordered_json make_result(std::string_view command) {
  return {{"lamina", LAMINA_VERSION}, {"command", command}};
}

void write_json(const nlohmann::ordered_json& result, const CommonOptions& options) {
  if (options.json.empty()) return;
  const std::string text = result.dump(1) + "\n";
  if (options.json == "-")
    fmt::print("{}", text);
  else
    write_file(options.json, text);
}

void print(const CommonOptions& options, std::string_view text) {
  if (options.json != "-") fmt::print("{}", text);
}

Progress make_progress(std::string label) {
  return
      [bar = std::make_shared<Bar>(std::move(label))](double finished) { return (*bar)(finished); };
}

bool was_interrupted() { return interrupted; }

void watch_for_interrupt() {
  struct sigaction action{};
  action.sa_handler = [](int) { interrupted = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second Ctrl-C ends at once
  sigaction(SIGINT, &action, nullptr);
}

void write_file(const std::string& path, std::string_view text) {
  write_file_bytes(path, std::span(reinterpret_cast<const std::byte*>(text.data()), text.size()));
}

}  // namespace lamina::cli
