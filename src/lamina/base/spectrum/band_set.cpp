// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/band_set.h"

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina {

BandSet::BandSet(std::vector<double> wavelengths) : wavelengths_(std::move(wavelengths)) {
  const auto require = [](bool holds, const std::string& rule, double given) {
    if (holds) return;
    PlainTextStream message;
    message << "bands: " << rule << ", but one is " << given;
    throw InvalidInput(message.str());
  };
  if (wavelengths_.empty()) throw InvalidInput("bands: at least one wavelength is required");
  for (std::size_t i = 0; i < wavelengths_.size(); ++i) {
    require(wavelengths_[i] >= 200.0 && wavelengths_[i] <= 3000.0,
            "wavelengths must lie in [200, 3000] nm", wavelengths_[i]);
    require(i == 0 || wavelengths_[i] > wavelengths_[i - 1], "wavelengths must ascend",
            wavelengths_[i]);
  }
}

std::string band_name(const BandSet& bands, std::size_t band) {
  if (bands.is_rgb()) return std::string(1, "RGB"[band]);
  PlainTextStream name;
  name << bands.wavelengths()[band];
  return name.str();
}

BandSet default_spectral_bands() {
  return BandSet({400.0, 435.0, 470.0, 505.0, 540.0, 575.0, 610.0, 645.0});
}

}  // namespace lamina
