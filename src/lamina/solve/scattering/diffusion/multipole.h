// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/optics/medium.h"
#include "lamina/solve/scattering/profile/layer_response.h"

namespace lamina {

/// One layer under a pencil beam, replaced by a point source and its images in the two planes where
/// the fluence vanishes; one wavelength. A half-space, whose thickness is infinite, is a dipole.
struct Multipole {
  double source_depth;  ///< depth of the source, one reduced mean free path [mm]
  double sigma_tr;      ///< effective transport coefficient [1/mm]
  double albedo_prime;  ///< reduced albedo, in (0, 1]
  double thickness;     ///< [mm], > 0
  double z_b_top;       ///< distance above the layer at which the fluence vanishes [mm]
  double z_b_bottom;    ///< the same below the layer [mm]
};

/// @param medium              must scatter; sigma_a may be 0.
/// @param thickness           [mm], > 0; may be infinite.
/// @param reflectance_top     fraction of the diffuse light inside that the top boundary turns
///                            back, as from `diffuse_reflectance_inside`; in [0, 1).
/// @param reflectance_bottom  the same of the bottom boundary; not used in a half-space.
[[nodiscard]] Multipole make_multipole(const Medium& medium, double thickness,
                                       double reflectance_top, double reflectance_bottom);

/// Whether the layer is no thicker than one reduced mean free path, so that some light crosses it
/// unscattered.
[[nodiscard]] inline bool is_thin(const Multipole& layer) {
  return layer.source_depth >= layer.thickness;
}

/// The layer's response at spatial frequency k [1/mm], k >= 0, per flux that has entered: the sum
/// over infinitely many image sources, in closed form.
///
///     R+(k) = albedo' sinh(s (d + z_bd - l)) cosh(s z_b0) / sinh(s (d + z_b0 + z_bd))
///     T+(k) = albedo' sinh(s (l + z_b0)) cosh(s z_bd) / sinh(s (d + z_b0 + z_bd))
///
/// with s = sqrt(k^2 + sigma_tr^2), l the source depth, d the thickness, z_b0 and z_bd the
/// distances of top and bottom. Written in decaying exponentials: relative error below 1e-13 for
/// s d from 0 to 1e4 and beyond, until it underflows to 0.
///
/// In a layer with l > d, where the formula turns negative, only the fraction d / l of the light
/// scatters, and its source stays at the far side, z = d. The rest goes straight on: what of it the
/// far boundary turns back crosses the layer once more, by the same rule. So the response is
/// continuous in all parameters, keeps the energy, and a vanishing layer leaves its boundaries
/// behind. Straight light that entered through a boundary misses those directions that the
/// boundary would turn back; of the others the far one turns back (f_far - f_near) / (1 - f_near).
///
/// Source: the transform of [DonnerJensen2005] Eqs. 12, 13 and 16, summed. In their Eq. 13 the
/// distances must be those to the bottom plane; as printed T is wrong by a factor of 16 at d = 2 l.
/// Layers with l > d are lamina's own (docs/diffusion.md).
[[nodiscard]] LayerResponse response(const Multipole& layer, double k);

/// The limit of `response` for k to infinity: what leaves where it entered. 0 unless the layer is
/// thin.
[[nodiscard]] LayerResponse local_response(const Multipole& layer);

}  // namespace lamina
