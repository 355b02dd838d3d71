// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace lamina {

/// Base of everything that lamina throws. The message is one line in the user's words: where,
/// what is required, and what was given.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Input from outside that cannot be used: a value out of range, an unknown key, a wrong type.
class InvalidInput : public Error {
 public:
  using Error::Error;
};

/// A file that cannot be read as what it should be. Whoever gave the path must mend it.
class FileError : public Error {
 public:
  using Error::Error;
};

/// A file or folder that cannot be written. The work is done; its result could not be kept.
class WriteError : public Error {
 public:
  using Error::Error;
};

}  // namespace lamina
