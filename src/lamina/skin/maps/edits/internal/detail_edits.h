// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/skin/maps/edits/internal/edit_course.h"

namespace lamina::skin_edits {

/// 1 - A times what pigments differ from their surroundings.
void make_even(Course& course);

/// 1 + A times what freckles have more of than the skin around them.
void change_freckles(Course& course);

}  // namespace lamina::skin_edits
