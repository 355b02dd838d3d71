// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fuzz_input.h"
#include "lamina/skin/acquire/files/capture_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lamina;
  return fuzz::read_or_refuse([&] {
    const JsonFile file(fuzz::corpus_file("capture"), std::string(fuzz::text_of(data, size)));
    static_cast<void>(develop_capture(load_capture(file, {fuzz::most_memory})));
  });
}
