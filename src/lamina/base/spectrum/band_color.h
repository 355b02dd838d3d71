// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lamina/base/spectrum/band_set.h"
#include "lamina/base/spectrum/color.h"

namespace lamina {

/// Weights that turn the values of a spectrum at the bands into linear sRGB, [band]: the colour is
/// the sum over b of weights[b] * spectrum[b].
using BandWeights = std::vector<std::array<double, 3>>;

/// The colour of reflectances (or of light as a fraction of the illuminant's) known at some bands.
///
/// The spectrum between and beyond the bands is taken as the smoothest likely one: the best linear
/// unbiased estimate for spectra whose values correlate over 150 nm (Matérn 5/2). It is then
/// integrated with the CIE 1931 observer and the illuminant, adapted from the illuminant's white to
/// that of sRGB (Bradford), and turned to linear sRGB. Each channel's weights sum to 1 exactly,
/// in any order, in double and in float: a reflectance of 1 is white, (1, 1, 1), under every
/// illuminant. Weights may be negative.
///
/// How good it is for the eight default wavelengths, against sums over 5 nm, under D65: measured
/// skin (100 forearms) within 0.007 linear and a CIEDE2000 of 0.85, median 0.3, since the eight
/// cannot follow the bands of haemoglobin; smooth random reflectances within 0.006 and a median
/// below 0.1. For RGB bands the weights are the identity.
///
/// Source: [CIE015]; [Cressie1993] §3.2 for the estimate.
[[nodiscard]] BandWeights make_band_weights(const BandSet& bands,
                                            Illuminant illuminant = Illuminant::d65);

/// Whether colours can be told by these weights, [band]: from three bands on that an eye can tell
/// apart.
[[nodiscard]] bool tells_colors(const BandWeights& weights);

/// The colour of a spectrum, [band].
[[nodiscard]] LinearSrgb linear_srgb(const BandWeights& weights, std::span<const double> spectrum);

/// Spectra of the three primaries, [band]: the spectrum of a colour is at b the sum over its
/// channels c of color[c] * basis[b][c].
using BandBasis = std::vector<std::array<double, 3>>;

/// Spectra for colours that are given as linear sRGB: lights and textures.
///
/// The way back is exact: make_band_weights (of the same illuminant) turns the spectrum into the
/// colour again, to 1e-10. White, (1, 1, 1), becomes exactly 1 in every band. Under these
/// conditions the basis is as smooth and as little negative as can be: at the default wavelengths
/// within [-0.005, 1.006]. Fewer than three bands, or bands that an eye cannot tell apart, cannot
/// show colour: all bands then take its luminance. For RGB bands the basis is the identity.
[[nodiscard]] BandBasis make_band_basis(const BandSet& bands,
                                        Illuminant illuminant = Illuminant::d65);

/// Makes a basis for other weights, each channel's of sum 1: these turn the spectrum into the
/// colour again.
[[nodiscard]] BandBasis make_band_basis(const BandSet& bands, const BandWeights& weights);

/// The spectrum of a colour, [band].
[[nodiscard]] std::vector<double> band_spectrum(const BandBasis& basis, const LinearSrgb& color);

}  // namespace lamina
