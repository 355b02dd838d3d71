// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fuzz_input.h"
#include "lamina/reproduction/item.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lamina;
  return fuzz::read_or_refuse([&] {
    MemoryBudget memory{fuzz::most_memory};
    const JsonDocument document =
        parse_json(fuzz::text_of(data, size), fuzz::corpus_file("reproduction"), memory);
    for (const auto quality : {ReproductionQuality::draft, ReproductionQuality::full})
      static_cast<void>(decode_reproduction(document.root(), quality));
  });
}
