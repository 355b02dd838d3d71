// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/leaf_acquisition.h"

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"

namespace lamina {

LeafMaps acquire_leaf(const Capture& capture, const Progress& progress) {
  if (!capture.lights.empty())
    throw InvalidInput(
        "capture: a leaf needs even light, but there is a window or a pattern of it");
  std::vector<double> middles;
  for (std::size_t b = 0; b < capture.sensor.rows; ++b) {
    double middle = 0.0;
    for (std::size_t w = 0; w < capture.wavelengths.size(); ++w)
      middle += capture.sensor(b, w) * capture.wavelengths[w];
    middles.push_back(middle);
  }
  LeafPixelOptions options;
  options.incidence = capture.incidence;
  options.shares_misfit = capture.leaf->shares_misfit;
  options.has_background = capture.leaf->has_background;
  if (capture.leaf->ground) options.ground.assign(middles.size(), *capture.leaf->ground);
  options.mask = capture.mask;
  return fit_leaf_pixels(capture.reflectance, middles, options, progress);
}

std::vector<std::string> notes_of_misfit(const Capture& capture, const LeafMaps& leaf) {
  std::string grown;
  for (std::size_t b = 0; b < leaf.chi_squared.size(); ++b)
    if (leaf.chi_squared[b] > chi_squared_of_note)
      grown += printf_text("%s %.3g (%s)", grown.empty() ? "" : ",", leaf.chi_squared[b],
                           capture.reflectance.channels[b].c_str());
  if (grown.empty()) return {};
  return {"chi squared by the noise that was found is" + grown +
          ": some pixels are met much worse than most; errors of maps have grown with it"};
}

}  // namespace lamina
