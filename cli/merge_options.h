// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "console.h"
#include "picture_look.h"

namespace lamina::cli {

/// Options of `lamina merge`.
struct MergeOptions {
  CommonOptions common;
  std::vector<std::string> files;
  bool needs_all = false;  ///< ends where shards are missing
  std::string plot;        ///< of photons
  std::string output;      ///< image, shard or table
  std::vector<std::string> channels;
  float noise = 0.0f;
  bool denoises = false;
  LookOptions look;
};

/// Says which shards are missing, and the commands that make them.
///
/// @param make  the words that make a shard, behind "lamina"; none if it is not known
/// @throws      FileError if all are needed
void report_missing(const std::vector<int>& missing, int of, bool needs_all,
                    const std::function<std::vector<std::string>(int shard)>& make);

/// Whether a file starts as a shard of a picture does.
[[nodiscard]] bool is_render_shard(const std::string& file);

/// Shards of pictures.
void merge_render(const MergeOptions& options);

}  // namespace lamina::cli
