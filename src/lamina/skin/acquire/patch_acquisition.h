// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "lamina/skin/acquire/acquired_skin.h"
#include "lamina/skin/acquire/capture.h"
#include "lamina/skin/acquire/inversion/kept_tiles.h"
#include "lamina/skin/acquire/inversion/patch_inversion.h"

namespace lamina {

struct PatchAcquisitionOptions {
  bool has_transport = true;  ///< light travels sideways; needs the size of pixels
  OperatorTotals totals = OperatorTotals::radiative_transfer_profile;
  InversionOptions inversion = {.deviation_samples = usual_deviation_samples};
  std::vector<Image> start;  ///< [number] values to go on from; empty: none
  /// Memory that the inversion may take [bytes]; where it would take more, tiles of half of that
  double most_bytes = 0x1p30;
  std::optional<KeptTiles> kept = {};                           ///< of a capture that goes by tiles
  std::shared_ptr<const SkinReflectanceTable> table = nullptr;  ///< null: table_of the capture

  static constexpr int usual_deviation_samples = 4;
};

/// All pixels of a capture of any bands together, by invert_patch; without transport each on its
/// own. What would take more memory than it may goes by invert_tiles: history, smoothness and,
/// with transport, growth of errors are those of the tile of which most is known; pixels on their
/// own have one growth, by a sample of all. Tiles that are left to other machines have the prior.
///
/// @param cache     keeps the tables of the transport; absent: none
/// @param progress  asked to stop, the best so far is handed over
/// @throws InvalidInput as invert_patch, for transport without the size of pixels, and for fewer
///         bands than numbers without a population.
[[nodiscard]] AcquiredSkin acquire_patch(const Capture& capture,
                                         const PatchAcquisitionOptions& options,
                                         const std::optional<DiskCache>& cache = {},
                                         const Progress& progress = {});

/// Tiles by which acquire_patch goes; 1: all pixels at once.
[[nodiscard]] std::size_t count_tiles(const Capture& capture,
                                      const PatchAcquisitionOptions& options);

}  // namespace lamina
