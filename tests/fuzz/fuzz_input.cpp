// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fuzz_input.h"

#include <unistd.h>

#include <fstream>
#include <system_error>

namespace lamina::fuzz {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("lamina_fuzz_" + std::to_string(getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() {
    std::error_code error;
    fs::remove_all(path, error);
  }
};

}  // namespace

fs::path corpus_file(const char* kind) {
  return fs::path(LAMINA_SOURCE_DIR) / "tests/inputs" / kind / "good/fuzz.json";
}

const fs::path& scratch_folder() {
  static const Folder folder;
  return folder.path;
}

fs::path scratch_file(const std::string& name, std::string_view bytes) {
  fs::path file = scratch_folder() / name;
  std::ofstream(file, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file;
}

}  // namespace lamina::fuzz
