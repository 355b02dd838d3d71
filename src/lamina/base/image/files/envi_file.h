// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/image/files/envi_header.h"
#include "lamina/base/image/image.h"
#include "lamina/base/image/pixel_rectangle.h"

namespace lamina {

/// How the bands of a file become one that is asked for.
enum class EnviBandShape {
  nearest,   ///< the one band that is nearest in wavelength
  box,       ///< the mean of those within half of a width
  gaussian,  ///< their mean by a Gaussian of a width at half of its height
};

/// A band that is asked for.
struct EnviBand {
  double wavelength = 0.0;  ///< [nm]
  EnviBandShape shape = EnviBandShape::nearest;
  double width = 0.0;  ///< [nm] full, > 0 but for the nearest
};

/// Part of a file to be read, so that not all of it need be in memory.
struct EnviSelection {
  std::vector<EnviBand> bands;              ///< none: all but those that the file calls bad
  std::optional<PixelRectangle> rectangle;  ///< absent: the whole image
};

/// The bands of a file that make one that is asked for, and their weights, whose sum is 1: by the
/// shape at their wavelengths, times the distance between their neighbours, so that bands need not
/// be equally far apart. Those that the file calls bad are left out.
struct EnviBandWeights {
  std::vector<std::size_t> bands;
  std::vector<double> weights;
};

/// @param name  the file that messages name.
/// @throws InvalidInput if the file names no wavelengths, or has none where the band lies: the
///         nearest is further off than the file's own bands are from each other, or than its width.
[[nodiscard]] EnviBandWeights envi_band_weights(const EnviHeader& header, const EnviBand& band,
                                                const std::string& name);

/// The header of an ENVI file. @throws FileError if it is missing, damaged or of another kind.
[[nodiscard]] EnviHeader load_envi_header(const std::filesystem::path& header_file,
                                          MemoryBudget& memory);

/// Reads an ENVI image: a text file, cube.hdr, beside its numbers, which are in the file of the
/// same name without .hdr or with .raw, .img, .dat, .bin, .bsq, .bil or .bip instead.
///
/// @return  numbers over the file's reflectance scale factor, linear; NaN where there are no data.
///          A channel is called by the wavelength of its band, "538.799nm", or by what was asked
///          for if that is a mean, "540nm"; without wavelengths by the name of the band.
/// @throws  FileError if a file is missing, damaged or not as long as its header says, two channels
///          would have one name, or more memory is needed than is left; what the image takes stays
///          taken from the budget. InvalidInput if the selection is not in the file.
///
/// Source: [ENVI] for the entries of the header.
[[nodiscard]] Image load_envi(const std::filesystem::path& header_file,
                              const EnviSelection& selection, MemoryBudget& memory);

}  // namespace lamina
