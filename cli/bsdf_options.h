// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/layers/optics/rough/rough_surface_scattering.h"
#include "monte_carlo_method.h"

namespace lamina::cli {

/// Options of `lamina bsdf`. Each model reads its own part.
struct BsdfOptions {
  CommonOptions common;
  std::string material;               ///< file or built-in; "" if a model is asked for
  std::string bands;                  ///< of --bands
  std::vector<std::string> settings;  ///< of --set
  std::string model;                  ///< "rough_transmission" or ""
  std::string method;                 ///< of the model; "" for its default
  double theta_i_deg = 30.0;
  MonteCarloEffort effort;  ///< of the random methods
  std::string plot;         ///< SVG file or ""
  bool compare = false;     ///< all methods side by side

  // layered materials
  double accuracy = 1e-3;
  double step_deg = 5.0;            ///< between the angles to look from
  int cosines = 18, azimuths = 36;  ///< cells of monte_carlo: rows and columns
  bool orders = false;              ///< of monte_carlo: tell scattering orders apart

  // rough_transmission
  double eta = 1.4;
  double smoothness = 3.0;
  FacetVisibility visibility = FacetVisibility::xu_sun;
  int realizations = 8;
};

/// A layered material. @throws InvalidInput, FileError, WriteError
void run_material_bsdf(const BsdfOptions& options);

/// Prints a BSDF by photons, in cells of equal solid angle. @throws InvalidInput, FileError,
/// WriteError
void run_monte_carlo_bsdf(const BsdfOptions& options);

/// The rough surface of Xu and Sun. @throws InvalidInput, WriteError
void run_rough_transmission(const BsdfOptions& options);

}  // namespace lamina::cli
