// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lamina {

/// In vacuum [mm/ps]; in a medium it is this over the index.
inline constexpr double speed_of_light = 0.299792458;

}  // namespace lamina
