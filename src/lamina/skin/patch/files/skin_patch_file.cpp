// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/patch/files/skin_patch_file.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/resample.h"
#include "lamina/base/io/json_input.h"
#include "lamina/skin/maps/files/material_map_file.h"
#include "lamina/skin/maps/files/skin_maps_file.h"

namespace lamina {
namespace {

/// Says that a map of another size than the patch is resampled.
void note_size(const std::string& what, const Image& image, SkinPatch& patch) {
  if (image.width == patch.width && image.height == patch.height) return;
  PlainTextStream text;
  text << what << ": " << image.width << " x " << image.height << " texels, resampled to "
       << patch.width << " x " << patch.height;
  patch.warnings.push_back(text.str());
}

/// Strips of light across the patch, each texel by the fraction of it that is lit.
void cut_stripes(const JsonInput& value, const SkinPatch& patch, Image& light) {
  const JsonObject object = value.object({"period", "width", "angle"});
  const double period = object.required("period").number(closed_interval(1e-3, 1e6, "mm"));
  const double width = object.required("width").number(closed_interval(0.0, period, "mm"));
  const auto angle = object.optional("angle");
  const double turn = (angle ? angle->number(closed_interval(-360.0, 360.0, "deg")) : 0.0) *
                      std::numbers::pi / 180.0;
  constexpr int samples = 4;  // across a texel, each way
  for (int y = 0; y < light.height; ++y)
    for (int x = 0; x < light.width; ++x) {
      int lit = 0;
      for (int s = 0; s < samples * samples; ++s) {
        const double u = (x + (s % samples + 0.5) / samples - 0.5 * light.width);
        const double v = (y + (s / samples + 0.5) / samples - 0.5 * light.height);
        const double across =
            patch.mm_per_texel * (u * std::cos(turn) + v * std::sin(turn)) / period;
        lit += (across - std::floor(across)) * period < width ? 1 : 0;
      }
      light.at(x, y)[0] *= static_cast<float>(lit) / (samples * samples);
    }
}

/// Light on a rectangle in the middle only.
void cut_window(const JsonInput& value, const SkinPatch& patch, Image& light) {
  const std::vector<double> size = value.number_or_numbers(2, closed_interval(0.0, 1e6, "mm"));
  /// Fraction of texel i, of `count`, within `side` of the middle.
  const auto share = [&](int i, int count, double side) {
    const double half = 0.5 * side / patch.mm_per_texel, middle = 0.5 * count;
    return std::clamp(std::min(i + 1.0, middle + half) - std::max<double>(i, middle - half), 0.0,
                      1.0);
  };
  for (int y = 0; y < light.height; ++y)
    for (int x = 0; x < light.width; ++x)
      light.at(x, y)[0] *=
          static_cast<float>(share(x, light.width, size[0]) * share(y, light.height, size[1]));
}

void decode_light(const JsonInput& value, SkinPatch& patch) {
  const JsonObject object = value.object({"irradiance", "theta", "map", "window", "stripes"});
  if (const auto theta = object.optional("theta"))
    patch.theta = theta->number({.low = 0.0, .high = 90.0, .includes_high = false, .unit = "deg"}) *
                  std::numbers::pi / 180.0;
  if (const auto map = object.optional("map")) {
    Image image;
    try {
      image = load_image(map->file_path(), ColorEncoding::linear, map->memory());
      require_finite(image, map->file_path());
      image = select_channels(image, {image.channels.front()});
    } catch (const FileError& error) {
      map->fail(error.what());
    }
    for (const float light : image.pixels)
      if (light < 0.0f) map->fail("light must be >= 0, but the image has " + number_text(light));
    note_size("light.map", image, patch);
    patch.light = resampled(image, patch.width, patch.height);
  }
  if (const auto level = object.optional("irradiance")) {
    const auto factor = static_cast<float>(level->number(closed_interval(0.0, 1e6)));
    for (float& light : patch.light.pixels) light *= factor;
  }
  if (const auto window = object.optional("window")) cut_window(*window, patch, patch.light);
  if (const auto stripes = object.optional("stripes")) cut_stripes(*stripes, patch, patch.light);
}

/// An image that `lamina patch` has written of skin in even light.
void decode_albedo(const JsonInput& file, SkinPatch& patch) {
  std::vector<std::string> bands;
  for (std::size_t b = 0; b < patch.bands.size(); ++b)
    bands.push_back(band_name(patch.bands, b) + "nm");
  Image image;
  try {
    image = load_image(file.file_path(), ColorEncoding::linear, file.memory());
    for (const std::string& band : bands)
      if (!channel_index(image, band)) file.fail("the image has no channel \"" + band + "\"");
    image = select_channels(image, bands);
    require_finite(image, file.file_path());
  } catch (const FileError& error) {
    file.fail(error.what());
  }
  for (const float value : image.pixels)
    if (value < 0.0f)
      file.fail("reflectance must be >= 0, but the image has " + number_text(value));
  note_size("albedo", image, patch);
  patch.albedo = resampled(image, patch.width, patch.height);
}

void decode_transport(const JsonInput& value, SkinPatch& patch) {
  const JsonObject object =
      value.object({"interlayer_bounces", "local_closure", "energy_threshold", "profile"});
  TransportOptions& options = patch.transport;
  constexpr int most_bounces = 100;
  if (const auto bounces = object.optional("interlayer_bounces")) {
    if (bounces->is_array())
      for (const JsonInput& of_band : bounces->array(patch.bands.size(), patch.bands.size()))
        patch.interlayer_bounces.push_back(static_cast<int>(of_band.integer(1, most_bounces)));
    else
      options.interlayer_bounces = static_cast<int>(bounces->integer(1, most_bounces));
  }
  if (const auto threshold = object.optional("energy_threshold")) {
    if (object.has("interlayer_bounces"))
      threshold->fail("\"interlayer_bounces\" says already when to end the series");
    options.energy_threshold = threshold->number(closed_interval(0.0, 0.9999));
    options.interlayer_bounces = 0;
  }
  if (const auto profile = object.optional("profile")) patch.profile = profile->choice<ProfileAt>();
  if (const auto closure = object.optional("local_closure"))
    options.has_local_closure = closure->boolean();
}

/// What both kinds of constants of skin are for.
OperatorTotals totals_for(SkinConstants constants) {
  return are_for_transfer_totals(constants) ? OperatorTotals::radiative_transfer_profile
                                            : OperatorTotals::diffusion;
}

/// "skin" and "bands".
void decode_patch_skin(const JsonObject& object, SkinPatch& patch) {
  if (const auto bands = object.optional("bands")) {
    std::vector<double> wavelengths;
    for (const JsonInput& band : bands->array(1, 1000))
      wavelengths.push_back(band.number(closed_interval(350.0, 1000.0, "nm")));
    try {
      patch.bands = BandSet(std::move(wavelengths));
    } catch (const InvalidInput& error) {
      bands->fail(error.what());
    }
  }
  std::vector<std::string> channels;
  for (std::size_t b = 0; b < patch.bands.size(); ++b)
    channels.push_back(band_name(patch.bands, b) + "nm");
  patch.skin = decode_skin_maps(object.required("skin"), channels);
  patch.warnings = patch.skin.warnings;
  std::tie(patch.width, patch.height) = patch_size(object, first_map(patch.skin));
  for (const SkinMap& map : patch.skin.maps) note_size("skin." + map.name, map.values, patch);
  for (const MaterialMap& map : patch.skin.others) note_size(map.number.name, map.values, patch);
  patch.totals = totals_for(patch.skin.constants);
}

/// "material" in place of "skin".
void decode_patch_material(const JsonObject& object, SkinPatch& patch) {
  for (const char* key : {"skin", "bands"})
    if (const auto given = object.optional(key))
      given->fail("must be missing, because \"material\" says it");
  const JsonInput given = object.required("material");
  patch.material = decode_mapped_material(given);
  const MappedMaterial& material = *patch.material;
  patch.bands = material.material.bands;
  patch.warnings = material.warnings;
  std::tie(patch.width, patch.height) =
      patch_size(object, material.maps.empty() ? nullptr : &material.maps.front().values);
  for (const MaterialMap& map : material.maps) note_size(map.number.name, map.values, patch);
  patch.totals = material.material.skin ? totals_for(material.material.skin->constants)
                                        : OperatorTotals::radiative_transfer;
  constexpr std::size_t most_layers = 7;  // and a ground
  if (!material.material.skin && material.material.layers.size() > most_layers)
    given.fail("must have at most " + std::to_string(most_layers) + " layers, but has " +
               std::to_string(material.material.layers.size()));
}

}  // namespace

SkinPatch load_skin_patch(const JsonFile& file, MemoryBudget memory,
                          std::span<const std::string> settings) {
  const JsonDocument document = load_json(file, memory, settings);
  const JsonObject object =
      document.root().file_object("patch", 1,
                                  {"name", "mm_per_pixel", "width", "height", "bands", "skin",
                                   "material", "light", "totals", "transport", "albedo"});
  SkinPatch patch;
  patch.name = object.has("name") ? object.required("name").string() : file.path.stem().string();
  patch.mm_per_texel = object.required("mm_per_pixel").number(closed_interval(1e-3, 100.0, "mm"));
  if (object.has("material"))
    decode_patch_material(object, patch);
  else
    decode_patch_skin(object, patch);
  if (const auto totals = object.optional("totals"))
    patch.totals = totals->choice<OperatorTotals>();
  patch.light = make_image(patch.width, patch.height, {"Y"});
  std::ranges::fill(patch.light.pixels, 1.0f);
  if (const auto light = object.optional("light")) decode_light(*light, patch);
  if (const auto transport = object.optional("transport")) decode_transport(*transport, patch);
  if (const auto albedo = object.optional("albedo")) decode_albedo(*albedo, patch);
  return patch;
}

}  // namespace lamina
