// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <malloc.h>

#include <cstddef>
#include <fstream>
#include <optional>
#include <string>

// Sanitizers keep memory of their own; gcc and clang tell of them in ways of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LAMINA_IS_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define LAMINA_IS_SANITIZED
#endif
#endif

namespace lamina {

/// A line of this process's status, such as "VmHWM:", in bytes.
inline std::optional<std::size_t> status_bytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == key) {
      std::size_t kibibytes = 0;
      status >> kibibytes;
      return kibibytes * 1024;
    }
  return std::nullopt;
}

/// How far the memory in use rises above where it was while `work` is done [bytes]; absent where
/// the system does not tell, or a sanitizer keeps memory of its own.
template <class Work>
std::optional<std::size_t> peak_memory(const Work& work) {
#ifdef LAMINA_IS_SANITIZED
  work();
  return std::nullopt;
#else
  malloc_trim(0);
  {
    std::ofstream reset("/proc/self/clear_refs");
    reset << "5";  // the highest so far is forgotten
    reset.close();
    if (!reset) {
      work();
      return std::nullopt;
    }
  }
  const auto before = status_bytes("VmRSS:");
  work();
  const auto highest = status_bytes("VmHWM:");
  if (!before || !highest) return std::nullopt;
  return *highest > *before ? *highest - *before : 0;
#endif
}

}  // namespace lamina
