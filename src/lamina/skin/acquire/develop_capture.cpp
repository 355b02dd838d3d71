// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/develop_capture.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lamina/base/core/number_text.h"
#include "lamina/skin/acquire/calibration/develop.h"
#include "lamina/skin/acquire/calibration/light_window.h"
#include "lamina/skin/acquire/calibration/registration.h"
#include "lamina/skin/acquire/calibration/skin_gains.h"
#include "lamina/skin/acquire/internal/developed_photograph.h"

namespace lamina {
namespace {

using acquire_detail::at_place;
using acquire_detail::DevelopedPhotograph;

/// Develops all photographs, whose channels become those of one image: the bands.
Developed develop_all(std::vector<PhotographDescription> photographs, Capture& capture) {
  const std::vector<std::string>& names = capture.reflectance.channels;
  Developed all;
  std::size_t first = 0;
  capture.errors.clear();
  for (PhotographDescription& each : photographs) {
    DevelopedPhotograph photograph = acquire_detail::develop_photograph(std::move(each));
    capture.errors.insert(capture.errors.end(), photograph.errors.begin(), photograph.errors.end());
    capture.notes.insert(capture.notes.end(), photograph.notes.begin(), photograph.notes.end());
    Developed& one = photograph.developed;
    if (photographs.size() == 1) {
      all = std::move(one);
      break;
    }
    if (first == 0)
      all = {.reflectance = make_image(one.mask.width, one.mask.height, names),
             .deviation = make_image(one.mask.width, one.mask.height, names),
             .mask = make_pixel_mask(one.mask.width, one.mask.height)};
    all.mask = combined(all.mask, one.mask);
    const std::size_t bands = photograph.errors.size();
    for (std::size_t i = 0; i < one.reflectance.pixels.size(); ++i) {
      const std::size_t to = i / bands * names.size() + first + i % bands;
      all.reflectance.pixels[to] = one.reflectance.pixels[i];
      all.deviation.pixels[to] = one.deviation.pixels[i];
    }
    first += bands;
  }
  all.reflectance.channels = names;
  all.deviation.channels = names;
  return all;
}

void register_bands(Developed& developed, Capture& capture) {
  const std::vector<std::string>& names = developed.reflectance.channels;
  const std::vector<Registration> found =
      register_channels(developed.reflectance, 0, developed.mask);
  std::vector<ImageMotion> motions;
  for (std::size_t b = 0; b < found.size(); ++b) {
    if (b > 0) {
      require_registered(found[b], "the band " + names[b]);
      capture.notes.push_back(
          printf_text("%s was moved by %.2f, %.2f pixels against %s, with an error of %.2f pixels",
                      names[b].c_str(), found[b].motion.shift.x, found[b].motion.shift.y,
                      names[0].c_str(), found[b].error));
    }
    motions.push_back(found[b].motion);
  }
  developed = moved_back(developed, motions);
}

/// The window in a tape: what lies beyond it is not lit.
void cut_window(const CaptureDescription::Window& given, Developed& developed, Capture& capture) {
  std::vector<Vec2> corners = given.corners;
  if (corners.empty()) {
    const LightWindow found = find_light_window(developed.reflectance, "the image");
    corners.assign(found.corners.begin(), found.corners.end());
    capture.notes.push_back(
        printf_text("the window was found at %.1f, %.1f; %.1f, %.1f; %.1f, %.1f; %.1f, %.1f",
                    corners[0].x, corners[0].y, corners[1].x, corners[1].y, corners[2].x,
                    corners[2].y, corners[3].x, corners[3].y));
  }
  const Image window = polygon_image(corners, developed.mask.width, developed.mask.height);
  developed.mask = combined(developed.mask, eroded(mask_from_image(window), given.edge));
  if (capture.lights.empty())
    capture.lights.push_back(window);
  else
    for (Image& light : capture.lights)
      for (std::size_t i = 0; i < light.pixels.size(); ++i) light.pixels[i] *= window.pixels[i];
}

/// A color chart that lies in the image is no skin.
void leave_out_found_chart(Developed& developed, Capture& capture) {
  if (developed.reflectance.channels != std::vector<std::string>{"R", "G", "B"}) return;
  try {
    const ChartReading chart = find_color_chart(developed.reflectance, "the image");
    acquire_detail::leave_out_chart(chart.corners, developed.mask);
    capture.notes.emplace_back("a color chart was found and left out; \"chart\" calibrates by it");
  } catch (const InvalidInput&) {
    return;  // there is none
  }
}

constexpr double far_gains = 2.5;  ///< standard deviations: of one in a hundred, or other skin

/// Gains that make the middle of the image skin of the population.
void fit_gains(Developed& developed, Capture& capture) {
  constexpr int people = 1000;
  capture.table = table_of(capture);
  leave_out_found_chart(developed, capture);
  const FoundSkinGains of_skin =
      find_skin_gains(developed.reflectance, developed.mask,
                      make_skin_colors(*capture.table, capture.sensor, *capture.population,
                                       capture.has_specular, people, 1));
  const SkinGains& found = of_skin.gains;
  const std::size_t bands = found.gains.size();
  std::string text = "bands were multiplied by";
  for (std::size_t b = 0; b < bands; ++b)
    text += printf_text("%s %.3f ± %.0f %%", b == 0 ? "" : ",", found.gains[b],
                        100.0 * std::sqrt(found.covariance(b, b)));
  const auto& [mask, skin, dark, bright, colored] = of_skin.pixels;
  const auto share =
      [all = std::max<std::size_t>(1, skin + dark + bright + colored)](std::size_t count) {
        return 100.0 * static_cast<double>(count) / static_cast<double>(all);
      };
  capture.notes.push_back(
      text + ", which makes the middle of the pixels of skin's color skin of the population");
  capture.notes.push_back(
      printf_text("by these gains %.1f %% of what is used is of skin's color, %.1f %% too dark, "
                  "%.1f %% too bright, %.1f %% of another color",
                  share(skin), share(dark), share(bright), share(colored)));
  if (found.distance > far_gains)
    capture.notes.push_back(printf_text(
        "skin and gains are %.1f standard deviations from what they are usually: other skin, or "
        "none; give a mask, a chart or a white",
        found.distance));
  for (Image* image : {&developed.reflectance, &developed.deviation})
    for (std::size_t i = 0; i < image->pixels.size(); ++i)
      image->pixels[i] *= static_cast<float>(found.gains[i % bands]);
  capture.gain_covariance = found.covariance;
}

/// Sets the errors of each band, by noise and by calibration: medians over the pixels.
void set_errors(Capture& capture) {
  const std::size_t bands = capture.reflectance.channel_count();
  constexpr std::size_t most = 100000;  // pixels that are looked at
  const std::size_t pixels = capture.mask.faults.size(), step = pixels / most + 1;
  for (std::size_t b = 0; b < bands; ++b) {
    std::vector<float> relative;
    for (std::size_t i = 0; i < pixels; i += step) {
      const float value = capture.reflectance.pixels[i * bands + b];
      if (capture.mask.faults[i] == 0 && value > 0.0f)
        relative.push_back(capture.deviation.pixels[i * bands + b] / value);
    }
    if (relative.empty()) continue;
    const auto middle = relative.begin() + static_cast<std::ptrdiff_t>(relative.size() / 2);
    std::ranges::nth_element(relative, middle);
    capture.errors[b] =
        std::clamp(std::max(capture.errors[b], static_cast<double>(*middle)), 1e-4, 0.5);
  }
}

/// Whether deviations of single numbers say more than the errors of bands.
bool has_own_deviations(const Capture& capture) {
  constexpr float rounding = 1e-5f;  // of what was multiplied by gains, exposures and so on
  const std::size_t bands = capture.reflectance.channel_count();
  for (std::size_t i = 0; i < capture.deviation.pixels.size(); ++i)
    if (capture.mask.faults[i / bands] == 0 &&
        capture.deviation.pixels[i] > (1.0f + rounding) *
                                          static_cast<float>(capture.errors[i % bands]) *
                                          std::abs(capture.reflectance.pixels[i]))
      return true;
  return false;
}

}  // namespace

Capture develop_capture(CaptureDescription description) {
  Capture capture = std::move(description.capture);
  Developed developed = develop_all(std::move(description.photographs), capture);
  if (description.registered)
    at_place(*description.registered, [&] { register_bands(developed, capture); });
  if (description.masks_highlights) mark_specular(developed);
  if (const auto& window = description.window)
    at_place(window->place, [&] { cut_window(*window, developed, capture); });
  if (description.mask) developed.mask = combined(developed.mask, *description.mask);
  at_place(description.place, [&] { require_used_pixels(developed.mask, "the mask"); });
  if (description.gains_from_skin)
    at_place(*description.gains_from_skin, [&] { fit_gains(developed, capture); });
  capture.reflectance = std::move(developed.reflectance);
  capture.deviation = std::move(developed.deviation);
  capture.mask = std::move(developed.mask);
  set_errors(capture);
  if (!has_own_deviations(capture)) capture.deviation = {};
  return capture;
}

}  // namespace lamina
