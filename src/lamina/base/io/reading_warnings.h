// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace lamina {

/// Sets the listener to assumptions of readers about a file that leaves something out, in one line
/// that names the file. Nobody is at first; the command prints it, Python makes a UserWarning of
/// it. For the whole process; the last one given counts.
void tell_reading_warnings(std::function<void(const std::string&)> told);

/// Tells it; each text once, since some files are read several times.
void warn_of_file(const std::string& text);

}  // namespace lamina
