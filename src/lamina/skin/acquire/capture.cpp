// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/capture.h"

namespace lamina {

std::shared_ptr<const SkinReflectanceTable> table_of(const Capture& capture,
                                                     const Progress& progress) {
  if (capture.table) return capture.table;
  return std::make_shared<const SkinReflectanceTable>(capture.wavelengths, capture.incidence,
                                                      skin_fit_range(capture.skin.skin), progress);
}

}  // namespace lamina
