// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fuzz_input.h"
#include "lamina/scene/mesh/files/mesh_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lamina;
  return fuzz::read_or_refuse([&] {
    static_cast<void>(parse_ply(fuzz::text_of(data, size), "fuzz.ply", {fuzz::most_memory}));
  });
}
