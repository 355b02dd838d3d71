// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// All formats of images whose bytes say what they are.
#include "fuzz_input.h"
#include "lamina/base/image/files/image_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lamina;
  return fuzz::read_or_refuse([&] {
    MemoryBudget memory{fuzz::most_memory};
    const Image image =
        decode_image(std::as_bytes(std::span(data, size)), "fuzz", ColorEncoding::srgb, memory);
    require_finite(image, "fuzz");
  });
}
