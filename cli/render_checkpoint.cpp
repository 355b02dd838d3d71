// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

#include "lamina/base/core/error.h"
#include "lamina/render/film/tile_passes.h"
#include "render_options.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

/// "x.unfinished keeps 64 samples per pixel of an earlier render".
std::string describe_kept(const fs::path& file) {
  const std::optional<KeptSamples> kept = kept_samples(file);
  if (!kept) return file.string() + " is there, and is no unfinished picture of this version";
  const std::string count = kept->least == kept->most
                                ? fmt::format("{}", kept->most)
                                : fmt::format("{} to {}", kept->least, kept->most);
  return fmt::format("{} keeps {} samples per pixel of an earlier render", file.string(), count);
}

}  // namespace

fs::path checkpoint_beside(const RenderCommandOptions& options, const fs::path& file) {
  if (options.resumes && options.starts_anew)
    throw InvalidInput("--fresh: does not go with --resume");
  fs::path checkpoint = fs::path(file).replace_extension(".unfinished");
  try {
    require_writable(checkpoint.string());
  } catch (const WriteError& error) {
    if (options.keeps || options.resumes) throw;
    say(fmt::format("warning: {}: nothing is kept if this render is stopped", error.what()));
    return {};
  }
  std::error_code ignored;
  if (options.resumes || options.starts_anew || !fs::exists(checkpoint, ignored)) return checkpoint;
  const std::string kept = describe_kept(checkpoint);
  if (options.keeps)
    throw InvalidInput(fmt::format("--keep: {}; --resume adds to it, --fresh replaces it", kept));
  say(fmt::format(
      "{}. It stays, and this render keeps nothing if it is stopped; --resume goes on from it, "
      "--fresh replaces it",
      kept));
  return {};
}

}  // namespace lamina::cli
