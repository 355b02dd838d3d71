// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Lines of `lamina info` on parts of pictures.
#include <fmt/format.h>

#include <cstdint>
#include <optional>

#include "info_kinds.h"
#include "lamina/base/core/error.h"
#include "lamina/render/film/film_shard.h"
#include "lamina/render/film/tile_passes.h"

namespace lamina::cli {

bool is_picture_shard(const FileLook& look) { return !look.is_folder && is_film_shard(look.path); }

FileFacts picture_shard_facts(const FileLook& look, MemoryBudget) {
  const FilmShardInfo info = FilmShard(look.path).info();
  std::int64_t samples = 0;
  for (const IndexRange& range : info.ranges) samples += range.size();
  FileFacts facts;
  facts.lines = {{"size", fmt::format("{} x {} pixels", info.width, info.height)},
                 {"samples", fmt::format("{} of {} per pixel, in {} shards", samples, info.samples,
                                         info.shards)},
                 {"method", info.method},
                 {"lamina", info.version}};
  facts.json = {{"width", info.width},        {"height", info.height}, {"samples", samples},
                {"of_samples", info.samples}, {"shards", info.shards}, {"method", info.method},
                {"version", info.version}};
  return facts;
}

FileFacts kept_picture_facts(const FileLook& look, MemoryBudget) {
  const std::optional<KeptSamples> kept = kept_samples(look.path);
  if (!kept)
    throw FileError(
        look.path.string() +
        ": must be an unfinished picture of this version, but is of another or damaged");
  FileFacts facts;
  facts.lines.emplace_back("samples",
                           kept->least == kept->most
                               ? fmt::format("{} per pixel", kept->least)
                               : fmt::format("{} to {} per pixel", kept->least, kept->most));
  facts.json = {{"least_samples", kept->least}, {"most_samples", kept->most}};
  return facts;
}

}  // namespace lamina::cli
