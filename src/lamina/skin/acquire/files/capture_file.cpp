// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/files/capture_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "lamina/base/io/json_input.h"
#include "lamina/skin/acquire/files/internal/decoded_photograph.h"
#include "lamina/skin/maps/files/skin_maps_file.h"

namespace lamina {
namespace {

using acquire_detail::BandWeightsOverWavelengths;
using acquire_detail::DecodedPhotograph;

constexpr std::size_t most_images = 64;

/// The lights of the images, each once; bands under them get their names.
void join_lights(std::vector<DecodedPhotograph>& images, Capture& capture) {
  if (std::ranges::all_of(images, [](const auto& each) { return each.light.pixels.empty(); }))
    return;
  std::vector<std::string> files;
  for (DecodedPhotograph& each : images) {
    auto found = std::ranges::find(files, each.light_file);
    if (found == files.end()) {
      const PixelMask& mask = each.photograph.mask;
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
  }
}

/// Bands of all images together, and spectra over all wavelengths that one of them sees.
void join_bands(const JsonInput& value, std::vector<DecodedPhotograph>& images, Capture& capture) {
  join_lights(images, capture);
  std::vector<std::string>& names = capture.reflectance.channels;
  std::map<double, std::size_t> places;  // of wavelengths
  for (const DecodedPhotograph& each : images) {
    names.insert(names.end(), each.sensor.names.begin(), each.sensor.names.end());
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
}

void require_one_size(const JsonInput& value, const std::vector<DecodedPhotograph>& images) {
  const PixelMask& all = images[0].photograph.mask;
  for (const DecodedPhotograph& each : images) {
    const PixelMask& one = each.photograph.mask;
    if (one.width != all.width || one.height != all.height)
      value.fail("must be of one size, but are " + std::to_string(all.width) + " x " +
                 std::to_string(all.height) + " and " + std::to_string(one.width) + " x " +
                 std::to_string(one.height));
  }
}

CaptureDescription::Window decode_window(const JsonInput& value, const JsonObject& object) {
  CaptureDescription::Window window{.place = value.where()};
  if (value.is_string())
    (void)value.choice<int>({{"find", 0}});
  else
    window.corners = acquire_detail::decode_corners(value, 3, 1000);
  if (const auto edge = object.optional("window_edge"))
    window.edge = static_cast<int>(edge->integer(0, 1000));
  return window;
}

PixelMask decode_mask(const JsonInput& file, const PixelMask& like) {
  const Image image = acquire_detail::load_finite(file, ColorEncoding::linear);
  if (image.width != like.width || image.height != like.height)
    file.fail("must be of the size of the images, " + std::to_string(like.width) + " x " +
              std::to_string(like.height) + ", but is " + std::to_string(image.width) + " x " +
              std::to_string(image.height));
  return mask_from_image(image);
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

CaptureDescription load_capture(const JsonFile& file, MemoryBudget memory,
                                std::span<const std::string> settings) {
  const JsonDocument document = load_json(file, memory, settings);
  const JsonObject object = document.root().file_object(
      "capture", 1,
      {"name", "source", "images", "mask", "register", "mask_highlights", "window", "window_edge",
       "gains", "incidence", "specular", "mm_per_pixel", "skin", "population", "numbers", "leaf"});
  CaptureDescription description;
  Capture& capture = description.capture;
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
  description.place = images.where();
  std::vector<DecodedPhotograph> decoded;
  for (const JsonInput& each : images.array(1, most_images))
    decoded.push_back(acquire_detail::decode_photograph(each, capture.incidence));
  join_bands(images, decoded, capture);
  require_one_size(images, decoded);
  for (DecodedPhotograph& each : decoded)
    description.photographs.push_back(std::move(each.photograph));
  if (const auto given = object.optional("register"); given && given->boolean())
    description.registered = given->where();
  if (const auto given = object.optional("mask_highlights"))
    description.masks_highlights = given->boolean();
  if (const auto given = object.optional("window"))
    description.window = decode_window(*given, object);
  if (const auto given = object.optional("mask"))
    description.mask = decode_mask(*given, description.photographs[0].mask);
  if (const auto given = object.optional("gains")) {
    (void)given->choice<int>({{"from_skin", 0}});
    if (!capture.population) given->fail("needs a population, but there is none");
    description.gains_from_skin = given->where();
  }
  return description;
}

}  // namespace lamina
