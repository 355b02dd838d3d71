// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/skin/maps/edits/internal/edit_course.h"

namespace lamina::skin_edits {

/// Moves mean and covariance of the pigments' coordinates to those of the reference.
void homogenize(Course& course);

}  // namespace lamina::skin_edits
