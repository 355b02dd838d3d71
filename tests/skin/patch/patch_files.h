// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/skin/patch/files/skin_patch_file.h"
#include "lamina/skin/patch/skin_patch.h"

namespace lamina {

/// Tests of patch files in a folder of their own.
class PatchFolder : public ::testing::Test {
 protected:
  PatchFolder() { std::filesystem::create_directories(folder_); }
  ~PatchFolder() override { std::filesystem::remove_all(folder_); }

  /// The patch of a file with these keys besides its head.
  [[nodiscard]] SkinPatch load_patch(const std::string& keys) const {
    const std::filesystem::path file = folder_ / "patch.json";
    std::ofstream(file) << R"({"lamina": "patch", "version": 1, )" << keys << "}";
    return load_skin_patch(file);
  }

  /// Message of the error that `call` throws.
  template <class Call>
  [[nodiscard]] static std::string message_of(const Call& call) {
    try {
      (void)call();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / "lamina_patch_test";
};

}  // namespace lamina
