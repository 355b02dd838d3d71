// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// An ENVI image: its header up to a zero byte, then its numbers.
#include "fuzz_input.h"
#include "lamina/base/image/files/envi_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lamina;
  const std::string_view all = fuzz::text_of(data, size);
  const std::size_t end = std::min(all.find('\0'), all.size());
  const auto header = fuzz::scratch_file("cube.hdr", all.substr(0, end));
  fuzz::scratch_file("cube.raw", all.substr(std::min(end + 1, all.size())));
  return fuzz::read_or_refuse([&] {
    MemoryBudget memory{fuzz::most_memory};
    static_cast<void>(load_envi(header, {}, memory));
    static_cast<void>(
        load_envi(header, {.bands = {{550.0}, {600.0, EnviBandShape::gaussian, 20.0}}}, memory));
  });
}
