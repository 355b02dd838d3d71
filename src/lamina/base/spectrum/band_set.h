// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace lamina {

/// The bands that a calculation runs over: the channels of linear Rec.709/sRGB, or wavelengths.
class BandSet {
 public:
  /// The three linear Rec.709/sRGB channels R, G, B.
  [[nodiscard]] static BandSet rgb() { return BandSet(); }

  /// @param wavelengths  [nm], ascending, at least one, each in [200, 3000].
  /// @throws InvalidInput naming the wavelength that breaks the rule.
  explicit BandSet(std::vector<double> wavelengths);

  [[nodiscard]] bool is_rgb() const { return wavelengths_.empty(); }
  [[nodiscard]] std::size_t size() const { return is_rgb() ? 3 : wavelengths_.size(); }

  /// [nm]; empty for RGB.
  [[nodiscard]] std::span<const double> wavelengths() const { return wavelengths_; }

  friend bool operator==(const BandSet&, const BandSet&) = default;

 private:
  BandSet() = default;
  std::vector<double> wavelengths_;
};

/// Name of a band in files and on plots: "R", "G", "B", or its wavelength as in "540".
[[nodiscard]] std::string band_name(const BandSet& bands, std::size_t band);

/// The eight wavelengths of [Donner2008] §7: 400, 435, 470, 505, 540, 575, 610, 645 nm.
[[nodiscard]] BandSet default_spectral_bands();

}  // namespace lamina
