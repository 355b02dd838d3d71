// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/files/capture_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/json_input.h"
#include "lamina/skin/acquire/calibration/develop.h"
#include "lamina/skin/acquire/calibration/light_window.h"
#include "lamina/skin/acquire/calibration/registration.h"
#include "lamina/skin/acquire/calibration/skin_gains.h"
#include "lamina/skin/acquire/files/internal/decoded_photograph.h"
#include "lamina/skin/maps/files/skin_maps_file.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"

namespace lamina {
namespace {

using acquire_detail::BandWeightsOverWavelengths;
using acquire_detail::DecodedPhotograph;

constexpr std::size_t most_images = 64;
constexpr int usual_window_edge = 2;  ///< pixels along it that are left out

/// The lights of the images, each once; bands under them get their names.
void join_lights(std::vector<DecodedPhotograph>& images, Capture& capture) {
  if (std::ranges::all_of(images, [](const auto& each) { return each.light.pixels.empty(); }))
    return;
  std::vector<std::string> files;
  for (DecodedPhotograph& each : images) {
    auto found = std::ranges::find(files, each.light_file);
    if (found == files.end()) {
      const PixelMask& mask = each.developed.mask;
      if (each.light.pixels.empty()) {
        each.light = make_image(mask.width, mask.height, {"Y"});
        std::ranges::fill(each.light.pixels, 1.0f);
      }
      capture.lights.push_back(std::move(each.light));
      files.push_back(each.light_file);
      found = files.end() - 1;
    }
    for (std::string& name : each.sensor.names) {
      if (!each.light_file.empty()) name += " by " + each.light_file;
      capture.band_lights.push_back(static_cast<std::size_t>(found - files.begin()));
    }
    each.developed.reflectance.channels = each.sensor.names;
    each.developed.deviation.channels = each.sensor.names;
  }
}

/// All channels of all images in one, and spectra over all wavelengths that a band sees.
Developed join(const JsonInput& value, std::vector<DecodedPhotograph>& images, Capture& capture) {
  join_lights(images, capture);
  std::vector<std::string> names;
  std::map<double, std::size_t> places;  // of wavelengths
  for (const DecodedPhotograph& each : images) {
    names.insert(names.end(), each.sensor.names.begin(), each.sensor.names.end());
    capture.errors.insert(capture.errors.end(), each.errors.begin(), each.errors.end());
    capture.notes.insert(capture.notes.end(), each.notes.begin(), each.notes.end());
    for (const BandWeightsOverWavelengths& band : each.sensor.bands)
      for (const auto& [nm, weight] : band) places[nm] = 0;
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::ranges::count(names, names[i]) > 1)
      value.fail("must each be of bands of their own, but " + names[i] + " is there twice");
  for (auto& [nm, place] : places) {
    place = capture.wavelengths.size();
    capture.wavelengths.push_back(nm);
  }
  capture.sensor = DenseMatrix(names.size(), places.size());
  std::size_t first = 0;
  for (const DecodedPhotograph& each : images) {
    for (std::size_t b = 0; b < each.sensor.bands.size(); ++b)
      for (const auto& [nm, weight] : each.sensor.bands[b])
        capture.sensor(first + b, places[nm]) += weight;
    first += each.sensor.bands.size();
  }
  if (images.size() == 1) return std::move(images[0].developed);
  const int width = images[0].developed.mask.width, height = images[0].developed.mask.height;
  Developed all{.reflectance = make_image(width, height, names),
                .deviation = make_image(width, height, names),
                .mask = make_pixel_mask(width, height)};
  first = 0;
  for (DecodedPhotograph& each : images) {
    const Developed one = std::move(each.developed);  // which ends here
    if (one.mask.width != width || one.mask.height != height)
      value.fail("must be of one size, but are " + std::to_string(width) + " x " +
                 std::to_string(height) + " and " + std::to_string(one.mask.width) + " x " +
                 std::to_string(one.mask.height));
    all.mask = combined(all.mask, one.mask);
    const std::size_t bands = each.sensor.bands.size();
    for (std::size_t i = 0; i < one.reflectance.pixels.size(); ++i) {
      const std::size_t to = i / bands * names.size() + first + i % bands;
      all.reflectance.pixels[to] = one.reflectance.pixels[i];
      all.deviation.pixels[to] = one.deviation.pixels[i];
    }
    first += bands;
  }
  return all;
}

void register_bands(const JsonInput& value, Developed& developed, Capture& capture) {
  const std::vector<std::string>& names = developed.reflectance.channels;
  try {
    const std::vector<Registration> found =
        register_channels(developed.reflectance, 0, developed.mask);
    std::vector<ImageMotion> motions;
    for (std::size_t b = 0; b < found.size(); ++b) {
      if (b > 0) {
        require_registered(found[b], "the band " + names[b]);
        capture.notes.push_back(printf_text(
            "%s was moved by %.2f, %.2f pixels against %s, with an error of %.2f pixels",
            names[b].c_str(), found[b].motion.shift.x, found[b].motion.shift.y, names[0].c_str(),
            found[b].error));
      }
      motions.push_back(found[b].motion);
    }
    developed = moved_back(developed, motions);
  } catch (const InvalidInput& error) {
    value.fail(error.what());
  }
}

/// The window in a tape: what lies beyond it is not lit.
void cut_window(const JsonInput& value, const JsonObject& object, Developed& developed,
                Capture& capture) {
  std::vector<Vec2> corners;
  if (value.is_string()) {
    (void)value.choice<int>({{"find", 0}});
    try {
      const LightWindow found = find_light_window(developed.reflectance, "the image");
      corners.assign(found.corners.begin(), found.corners.end());
      capture.notes.push_back(
          printf_text("the window was found at %.1f, %.1f; %.1f, %.1f; %.1f, %.1f; %.1f, %.1f",
                      corners[0].x, corners[0].y, corners[1].x, corners[1].y, corners[2].x,
                      corners[2].y, corners[3].x, corners[3].y));
    } catch (const InvalidInput& error) {
      value.fail(error.what());
    }
  } else {
    corners = acquire_detail::decode_corners(value, 3, 1000);
  }
  const auto edge = object.optional("window_edge");
  Image window;
  try {
    window = polygon_image(corners, developed.mask.width, developed.mask.height);
  } catch (const InvalidInput& error) {
    value.fail(error.what());
  }
  developed.mask = combined(
      developed.mask, eroded(mask_from_image(window),
                             edge ? static_cast<int>(edge->integer(0, 1000)) : usual_window_edge));
  if (capture.lights.empty())
    capture.lights.push_back(window);
  else
    for (Image& light : capture.lights)
      for (std::size_t i = 0; i < light.pixels.size(); ++i) light.pixels[i] *= window.pixels[i];
}

void mask_by_file(const JsonInput& file, PixelMask& mask) {
  const Image image = acquire_detail::load_finite(file, ColorEncoding::linear);
  if (image.width != mask.width || image.height != mask.height)
    file.fail("must be of the size of the images, " + std::to_string(mask.width) + " x " +
              std::to_string(mask.height) + ", but is " + std::to_string(image.width) + " x " +
              std::to_string(image.height));
  mask = combined(mask, mask_from_image(image));
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
void fit_gains(const JsonInput& value, Developed& developed, Capture& capture) {
  (void)value.choice<int>({{"from_skin", 0}});
  if (!capture.population) value.fail("needs a population, but there is none");
  constexpr int people = 1000;
  try {
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
  } catch (const InvalidInput& error) {
    value.fail(error.what());
  }
}

/// Of each band, by noise and by calibration: what pixels have in the middle.
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

Incidence decode_incidence(const JsonInput& value) {
  if (value.is_string())
    return value.choice<Incidence>({{"diffuse", {.is_diffuse = true}}, {"normal", {}}});
  return {.theta = value.number(closed_interval(0.0, 89.0, "deg")) * std::numbers::pi / 180.0};
}

void decode_numbers(const JsonObject& object, Capture& capture) {
  const auto given = object.optional("numbers");
  std::vector<std::string_view> known;
  const std::vector<SkinFitNumber> all = skin_fit_numbers(capture.skin.skin);
  for (const SkinFitNumber& number : all)
    if (!capture.population ||
        std::ranges::count(capture.population->names, number.parameter.name) > 0)
      known.push_back(number.parameter.name);
  std::vector<std::string_view> chosen = known;
  capture.has_stated_numbers = given.has_value();
  if (given) {
    chosen.clear();
    for (const JsonInput& each : given->array(1, known.size())) {
      chosen.push_back(known[each.choice(known)]);
      if (std::ranges::count(chosen, chosen.back()) > 1) each.fail("is there twice");
    }
  }
  for (const SkinFitNumber& number : all)
    if (std::ranges::count(chosen, number.parameter.name) > 0) capture.numbers.push_back(number);
}

/// A leaf, of which nothing is said that is of skin.
void decode_leaf(const JsonObject& capture, const JsonInput& value, Capture& result) {
  for (const char* key : {"skin", "population", "numbers", "gains", "specular"})
    if (const auto given = capture.optional(key)) given->fail("is of skin, but this is a leaf");
  const JsonObject object = value.object({"ground", "shares_misfit", "has_background"});
  LeafCapture leaf;
  if (const auto ground = object.optional("ground"))
    leaf.ground = ground->number(closed_interval(0.0, 1.0));
  if (const auto shared = object.optional("shares_misfit")) leaf.shares_misfit = shared->boolean();
  if (const auto background = object.optional("has_background"))
    leaf.has_background = background->boolean();
  result.leaf = leaf;
}

}  // namespace

Capture load_capture(const JsonFile& file, MemoryBudget memory,
                     std::span<const std::string> settings) {
  const JsonDocument document = load_json(file, memory, settings);
  const JsonObject object = document.root().file_object(
      "capture", 1,
      {"name", "source", "images", "mask", "register", "mask_highlights", "window", "window_edge",
       "gains", "incidence", "specular", "mm_per_pixel", "skin", "population", "numbers", "leaf"});
  Capture capture;
  if (const auto name = object.optional("name")) capture.name = name->string();
  if (const auto source = object.optional("source")) (void)source->string();
  if (const auto leaf = object.optional("leaf")) decode_leaf(object, *leaf, capture);
  if (const auto skin = object.optional("skin")) {
    const SkinMaps decoded = decode_skin_maps(*skin);
    if (!decoded.maps.empty() || !decoded.others.empty())
      skin->fail("must be numbers that are known, but has maps");
    capture.skin = {decoded.skin, decoded.constants};
  }
  capture.population_name = "forearms";
  capture.population = forearm_population();
  if (const auto given = object.optional("population");
      given && given->is_string() && given->string() == "none") {
    capture.population.reset();
    capture.population_name = "none";
  } else if (given) {
    capture.population_name = given->string();
    capture.population =
        find_skin_population(capture.population_name == "forearms" ? capture.population_name
                                                                   : given->file_path().string(),
                             given->memory());
  }
  decode_numbers(object, capture);
  if (const auto given = object.optional("incidence"))
    capture.incidence = decode_incidence(*given);
  else
    capture.incidence = {.is_diffuse = true};
  if (const auto given = object.optional("specular"))
    capture.has_specular = given->choice<bool>({{"excluded", false}, {"included", true}});
  if (const auto given = object.optional("mm_per_pixel"))
    capture.mm_per_pixel = given->number(closed_interval(1e-3, 100.0, "mm"));

  const JsonInput images = object.required("images");
  std::vector<DecodedPhotograph> decoded;
  for (const JsonInput& each : images.array(1, most_images))
    decoded.push_back(acquire_detail::decode_photograph(each, capture.incidence));
  Developed developed = join(images, decoded, capture);
  if (const auto given = object.optional("register"); given && given->boolean())
    register_bands(*given, developed, capture);
  if (const auto given = object.optional("mask_highlights"); given && given->boolean())
    mark_specular(developed);
  if (const auto window = object.optional("window"))
    cut_window(*window, object, developed, capture);
  if (const auto mask = object.optional("mask")) mask_by_file(*mask, developed.mask);
  try {
    require_used_pixels(developed.mask, "the mask");
  } catch (const InvalidInput& error) {
    images.fail(error.what());
  }
  if (const auto gains = object.optional("gains")) fit_gains(*gains, developed, capture);
  capture.reflectance = std::move(developed.reflectance);
  capture.deviation = std::move(developed.deviation);
  capture.mask = std::move(developed.mask);
  set_errors(capture);
  if (!has_own_deviations(capture)) capture.deviation = {};
  return capture;
}

}  // namespace lamina
