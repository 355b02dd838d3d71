// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "lamina/acquire/capture.h"
#include "lamina/acquire/internal/decoded_sensor.h"
#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/image/image_file.h"
#include "lamina/io/json_input.h"
#include "lamina/skin_maps/skin_maps.h"

namespace lamina {
namespace {

using acquire_detail::BandWeightsOverWavelengths;
using acquire_detail::DecodedSensor;

constexpr std::size_t most_images = 64;
constexpr double default_error = 0.005;
/// Reflectances of skin lie far within; what is beyond has another unit.
constexpr float lowest_reflectance = -0.02f, highest_reflectance = 2.0f;

/// One entry of "images".
struct DecodedImage {
  Image image;  ///< the channels that are measured
  Image alpha;  ///< empty: none
  DecodedSensor sensor;
  std::vector<double> errors, saturation;
};

std::vector<std::string> channels_to_read(const JsonObject& object, const Image& image) {
  if (const auto given = object.optional("channels")) {
    std::vector<std::string> names;
    for (const JsonInput& each : given->array(1, most_images)) {
      names.push_back(each.string());
      if (!channel_index(image, names.back())) each.refuse("must be a channel of the image");
    }
    return names;
  }
  std::vector<std::string> names;
  for (const std::string& name : image.channels)
    if (name != "A") names.push_back(name);
  return names;
}

/// An image without infinities and NaN.
Image load_finite(const JsonInput& file, ColorEncoding encoding) {
  try {
    Image image = load_image(file.file_path(), encoding, file.memory());
    require_finite(image, file.file_path());
    return image;
  } catch (const FileError& error) {
    file.fail(error.what());
  }
}

DecodedImage decode_captured(const JsonInput& value) {
  const JsonObject object =
      value.object({"image", "encoding", "channels", "sensor", "error", "white", "saturated"});
  const JsonInput file = object.required("image");
  const ColorEncoding encoding = object.required("encoding").choice<ColorEncoding>();
  const Image whole = load_finite(file, encoding);
  DecodedImage decoded;
  const std::vector<std::string> names = channels_to_read(object, whole);
  decoded.image = select_channels(whole, names);
  if (channel_index(whole, "A")) decoded.alpha = select_channels(whole, {"A"});
  decoded.sensor = acquire_detail::decode_sensor(object.required("sensor"), names);
  const std::size_t bands = names.size();
  decoded.errors.assign(bands, default_error);
  if (const auto error = object.optional("error"))
    decoded.errors = error->number_or_numbers(bands, closed_interval(1e-4, 0.5));
  decoded.saturation.assign(
      bands, encoding == ColorEncoding::srgb ? 1.0 : std::numeric_limits<double>::infinity());
  if (const auto saturated = object.optional("saturated"))
    decoded.saturation = saturated->number_or_numbers(bands, greater_than(0.0));
  std::vector<double> white(bands, 1.0);
  if (const auto given = object.optional("white"))
    white = given->number_or_numbers(bands, greater_than(0.0));
  for (std::size_t i = 0; i < decoded.image.pixels.size(); ++i) {
    float& pixel = decoded.image.pixels[i];
    pixel = static_cast<float>(static_cast<double>(pixel) / white[i % bands]);
    if (lowest_reflectance <= pixel && pixel <= highest_reflectance) continue;
    const auto width = static_cast<std::size_t>(decoded.image.width);
    file.fail(
        "must hold fractions of what white reflects, in [-0.02, 2] (\"white\" divides), but "
        "pixel " +
        std::to_string(i / bands % width) + ", " + std::to_string(i / bands / width) + " has " +
        names[i % bands] + " = " + number_text(static_cast<double>(pixel)));
  }
  for (std::size_t b = 0; b < bands; ++b) decoded.saturation[b] /= white[b];
  return decoded;
}

/// All channels of all images in one, and spectra over all wavelengths that a band sees.
void join(const JsonInput& value, std::vector<DecodedImage>& images, Capture& capture) {
  std::vector<std::string> names;
  std::map<double, std::size_t> places;  // of wavelengths
  for (const DecodedImage& each : images) {
    names.insert(names.end(), each.sensor.names.begin(), each.sensor.names.end());
    capture.errors.insert(capture.errors.end(), each.errors.begin(), each.errors.end());
    capture.saturation.insert(capture.saturation.end(), each.saturation.begin(),
                              each.saturation.end());
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
  const int width = images[0].image.width, height = images[0].image.height;
  if (images.size() == 1) {
    capture.reflectance = std::move(images[0].image);
    capture.reflectance.channels = names;
  } else {
    capture.reflectance = make_image(width, height, names);
  }
  std::size_t first = 0;
  for (const DecodedImage& each : images) {
    if (images.size() > 1 && (each.image.width != width || each.image.height != height))
      value.fail("must be of one size, but are " + std::to_string(width) + " x " +
                 std::to_string(height) + " and " + std::to_string(each.image.width) + " x " +
                 std::to_string(each.image.height));
    const std::size_t bands = each.sensor.bands.size();
    for (std::size_t b = 0; b < bands; ++b)
      for (const auto& [nm, weight] : each.sensor.bands[b])
        capture.sensor(first + b, places[nm]) += weight;
    for (std::size_t i = 0; images.size() > 1 && i < each.image.pixels.size(); ++i)
      capture.reflectance.pixels[i / bands * names.size() + first + i % bands] =
          each.image.pixels[i];
    first += bands;
  }
}

void mask_with(const Image& image, const JsonInput& file, Capture& capture) {
  const Image& pixels = capture.reflectance;
  if (image.width != pixels.width || image.height != pixels.height)
    file.fail("must be of the size of the images, " + std::to_string(pixels.width) + " x " +
              std::to_string(pixels.height) + ", but is " + std::to_string(image.width) + " x " +
              std::to_string(image.height));
  const std::size_t count = pixels.pixels.size() / pixels.channel_count();
  capture.is_masked.resize(count, false);
  for (std::size_t i = 0; i < count; ++i)
    if (image.pixels[i * image.channel_count()] < 0.5f) capture.is_masked[i] = true;
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
    if (std::ranges::count(capture.population.names, number.parameter.name) > 0)
      known.push_back(number.parameter.name);
  std::vector<std::string_view> chosen = known;
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

}  // namespace

Capture load_capture(const std::filesystem::path& file, MemoryBudget memory,
                     std::span<const std::string> settings) {
  const JsonDocument document = load_json(file, memory, settings);
  const JsonObject object =
      document.root().file_object("capture", 1,
                                  {"name", "source", "images", "mask", "incidence", "specular",
                                   "mm_per_pixel", "skin", "population", "numbers"});
  Capture capture;
  if (const auto name = object.optional("name")) capture.name = name->string();
  if (const auto source = object.optional("source")) (void)source->string();
  if (const auto skin = object.optional("skin")) {
    const SkinMaps decoded = decode_skin_maps(*skin);
    if (!decoded.maps.empty() || !decoded.others.empty())
      skin->fail("must be numbers that are known, but has maps");
    capture.skin = {decoded.skin, decoded.constants};
  }
  capture.population_name = "forearms";
  capture.population = forearm_population();
  if (const auto given = object.optional("population")) {
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
  std::vector<DecodedImage> decoded;
  for (const JsonInput& each : images.array(1, most_images))
    decoded.push_back(decode_captured(each));
  join(images, decoded, capture);
  for (const DecodedImage& each : decoded)
    if (!each.alpha.pixels.empty()) mask_with(each.alpha, images, capture);
  if (const auto mask = object.optional("mask"))
    mask_with(load_finite(*mask, ColorEncoding::linear), *mask, capture);
  return capture;
}

}  // namespace lamina
