// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/image/image.h"
#include "lamina/base/io/json_output.h"
#include "lamina/base/spectrum/band_set.h"

// Kinds of files that lamina reads or writes, and what `lamina info` says of each.
namespace lamina::cli {

/// A file as far as its kind shows: its name and its first bytes, and of JSON what it says it is.
struct FileLook {
  std::filesystem::path path;
  bool is_folder = false;
  std::string ending;       ///< ".png" of "X.PNG"
  std::string start;        ///< its first 4096 bytes
  bool is_json = false;     ///< an object of JSON
  std::string said;         ///< its key "lamina": "scene"; of results the version
  std::string command;      ///< of results of lamina: which one made it
  bool has_counts = false;  ///< of these: whether they hold sums of photons
  bool is_shard = false;    ///< of these: whether they are a part of more
};

/// @throws FileError if there is no such file, or it cannot be read.
[[nodiscard]] FileLook look_at(const std::filesystem::path& path, MemoryBudget memory);

/// Facts of a file for its user: lines of a name and a text, and the same as JSON.
struct FileFacts {
  std::vector<std::pair<std::string, std::string>> lines;
  JsonOutput json = JsonOutput::object();
  std::vector<std::string> warnings;
};

/// A kind of file.
struct FileKind {
  std::string_view name;      ///< "capture"
  std::string_view files;     ///< how it is found: ".json with \"lamina\": \"capture\""
  std::string_view commands;  ///< what takes it: "acquire"; empty: nothing
  bool (*is)(const FileLook&);
  /// Null: of meshes and scenes, of which info says more.
  FileFacts (*facts)(const FileLook&, MemoryBudget);
};

/// The kind of a file; null if it is of none.
[[nodiscard]] const FileKind* find_file_kind(const FileLook& look);

/// Values of the key "lamina" of documents.
[[nodiscard]] std::span<const std::string_view> document_kinds();

/// The names of all kinds, for messages.
[[nodiscard]] std::string file_kind_names();

// Facts of documents that lamina has a format of its own for.
[[nodiscard]] FileFacts material_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts capture_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts patch_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts measurement_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts population_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts recipe_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts maps_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts job_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts job_folder_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts reproduction_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts changes_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts photon_counts_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts result_facts(const FileLook& look, MemoryBudget memory);

// Facts of parts of pictures; only where lamina renders.
[[nodiscard]] bool is_picture_shard(const FileLook& look);
[[nodiscard]] FileFacts picture_shard_facts(const FileLook& look, MemoryBudget memory);
[[nodiscard]] FileFacts kept_picture_facts(const FileLook& look, MemoryBudget memory);

/// Adds "bands": "8, 400 to 645 nm".
void add_bands(FileFacts& facts, const BandSet& bands);

/// Adds the size of an image, its channels, and the range of each.
void add_image(FileFacts& facts, const Image& image);

}  // namespace lamina::cli
