// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// libFuzzer's entry: whatever the bytes, parse_mcml reads them or throws InvalidInput.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "lamina/core/error.h"
#include "lamina/scattering/monte_carlo/mcml_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    for (const lamina::McmlRun& run : lamina::parse_mcml(text, "fuzz.mci"))
      static_cast<void>(lamina::layer_stack(run));
  } catch (const lamina::InvalidInput&) {
  }
  return 0;
}
