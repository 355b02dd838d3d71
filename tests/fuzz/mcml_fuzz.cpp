// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fuzz_input.h"
#include "lamina/solve/scattering/monte_carlo/mcml_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lamina;
  return fuzz::read_or_refuse([&] {
    for (const McmlRun& run : parse_mcml(fuzz::text_of(data, size), "fuzz.mci"))
      static_cast<void>(layer_stack(run));
  });
}
