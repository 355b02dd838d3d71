// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Tables, and the spectra in them.
#include "fuzz_input.h"
#include "lamina/base/io/csv_table.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lamina;
  return fuzz::read_or_refuse([&] {
    MemoryBudget memory{fuzz::most_memory};
    const CsvTable table = parse_csv(fuzz::text_of(data, size), "fuzz.csv", memory);
    for (std::size_t row = 0; row < table.rows(); ++row)
      for (std::size_t column = 0; column < table.columns().size(); ++column)
        static_cast<void>(table.number(row, column));
  });
}
