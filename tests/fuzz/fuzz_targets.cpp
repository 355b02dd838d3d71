// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

// All fuzz targets as one program, which the variable LAMINA_FUZZ_TARGET chooses from: "obj" is
// obj_fuzz.cpp. Processes that libFuzzer starts have it, too.

#define FUZZ_TARGET(name) extern "C" int name##_fuzz(const std::uint8_t* data, std::size_t size);
#include "fuzz_targets.inc"
#undef FUZZ_TARGET

namespace {

struct Target {
  std::string_view name;
  int (*run)(const std::uint8_t*, std::size_t);
};

constexpr Target targets[] = {
#define FUZZ_TARGET(name) {#name, name##_fuzz},
#include "fuzz_targets.inc"
#undef FUZZ_TARGET
};

const Target& chosen_target() {
  const char* chosen = std::getenv("LAMINA_FUZZ_TARGET");
  for (const Target& target : targets)
    if (chosen && target.name == chosen) return target;
  std::fputs("LAMINA_FUZZ_TARGET: must be one of", stderr);
  for (const Target& target : targets) std::fprintf(stderr, " %s", target.name.data());
  std::fputs("\n", stderr);
  std::_Exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Target& target = chosen_target();
  return target.run(data, size);
}
