// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/patch_acquisition.h"

#include <algorithm>
#include <limits>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/skin/acquire/capture_patch.h"
#include "lamina/skin/acquire/inversion/texels/inversion_tables.h"

namespace lamina {
namespace {

/// Enough for the tables of a large capture.
constexpr std::size_t table_samples = 65536;
/// Enough for the noise of a band to 5 %.
constexpr std::size_t misfit_samples = 1024;

/// Wavelengths of all lights that bands see.
std::size_t count_fields(const Capture& capture) {
  std::size_t count = 0;
  for (std::size_t w = 0; w < capture.wavelengths.size(); ++w)
    for (std::size_t l = 0; l < std::max<std::size_t>(1, capture.lights.size()); ++l) {
      bool is_seen = false;
      for (std::size_t b = 0; b < capture.sensor.rows; ++b)
        is_seen |= capture.sensor(b, w) != 0.0 &&
                   (capture.band_lights.empty() || capture.band_lights[b] == l);
      count += is_seen ? 1 : 0;
    }
  return count;
}

/// The tiles of a capture; none if it is inverted as a whole.
std::optional<TileOptions> tiling_of(const Capture& capture,
                                     const PatchAcquisitionOptions& options) {
  const std::size_t fields = count_fields(capture);
  if (static_cast<double>(capture.mask.faults.size() * fields) * inversion_bytes_per_texel <=
      options.most_bytes)
    return std::nullopt;
  TileOptions tiling{.kept = options.kept};
  if (!options.has_transport) tiling.halo = 0.0;
  tiling.side = side_of_tiles(options.most_bytes / 2.0, fields, capture.mm_per_pixel.value_or(1.0),
                              tiling.halo);
  return tiling;
}

/// Maps of the size of a capture, of which nothing is found yet.
AcquiredSkin skin_before(const Capture& capture, const InversionTables& tables) {
  const int width = capture.reflectance.width, height = capture.reflectance.height;
  const int step = picture_step(width, height);
  AcquiredSkin skin{.width = width,
                    .height = height,
                    .predicted = make_image((width + step - 1) / step, (height + step - 1) / step,
                                            capture.reflectance.channels)};
  std::ranges::fill(skin.predicted.pixels, std::numeric_limits<float>::quiet_NaN());
  skin.kinds.reserve(capture.mask.faults.size());
  for (const std::uint8_t faults : capture.mask.faults) {
    skin.kinds.push_back(faults == 0 ? PixelKind::skin : PixelKind::unused);
    ++skin.counts[static_cast<std::size_t>(skin.kinds.back())];
  }
  for (const SkinFitNumber& number : tables.numbers) {
    double prior = wide_deviation;
    if (capture.population) {
      const auto& names = capture.population->names;
      const auto at = std::ranges::find(names, number.parameter.name) - names.begin();
      prior = capture.population->priors[static_cast<std::size_t>(at)].standard_deviation;
    }
    skin.numbers.push_back({.number = number,
                            .prior_deviation = prior,
                            .values = make_image(width, height, {"Y"}),
                            .deviations = make_image(width, height, {"Y"})});
    std::ranges::fill(skin.numbers.back().deviations.pixels, static_cast<float>(prior));
  }
  return skin;
}

void put(const Plane& part, const TexelRectangle& place, Image& image) {
  for (int y = 0; y < part.height; ++y)
    std::copy_n(part.values.begin() + static_cast<std::ptrdiff_t>(y) * part.width, part.width,
                image.at(place.x, place.y + y));
}

/// Puts what was found in a rectangle of a capture in its place.
void put_found(const Capture& capture, const TexelRectangle& place, const InversionResult& found,
               AcquiredSkin& skin) {
  for (std::size_t n = 0; n < found.numbers.size(); ++n) {
    put(found.numbers[n].value, place, skin.numbers[n].values);
    if (!found.numbers[n].deviation.values.empty())
      put(found.numbers[n].deviation, place, skin.numbers[n].deviations);
  }
  const int step = picture_step(skin.width, skin.height);
  const auto first = [&](int at) { return (at + step - 1) / step * step; };
  for (int y = first(place.y); y < place.y + place.height; y += step)
    for (int x = first(place.x); x < place.x + place.width; x += step)
      for (std::size_t b = 0; b < found.residual.size(); ++b) {
        const auto i =
            static_cast<std::size_t>(y - place.y) * static_cast<std::size_t>(place.width) +
            static_cast<std::size_t>(x - place.x);
        skin.predicted.at(x / step, y / step)[b] =
            capture.reflectance.at(x, y)[b] - found.residual[b].values[i];
      }
}

/// A part of maps to go on from.
std::vector<Plane> parts_of(const std::vector<Image>& maps, const TexelRectangle& part) {
  std::vector<Plane> planes;
  for (const Image& map : maps) {
    Plane& plane = planes.emplace_back(make_plane(part.width, part.height));
    for (int y = 0; y < part.height; ++y)
      std::copy_n(map.at(part.x, part.y + y), part.width,
                  plane.values.begin() + static_cast<std::ptrdiff_t>(y) * part.width);
  }
  return planes;
}

void require_enough(const Capture& capture, const PatchAcquisitionOptions& options) {
  if (options.has_transport && !capture.mm_per_pixel)
    throw InvalidInput(
        "capture: light that travels sideways needs \"mm_per_pixel\", which is missing");
  const std::size_t bands = capture.reflectance.channel_count();
  if (!capture.population && bands < capture.numbers.size())
    throw InvalidInput("capture: " + std::to_string(bands) + " bands cannot tell " +
                       std::to_string(capture.numbers.size()) +
                       " numbers; give a \"population\", or fewer \"numbers\"");
  for (const Image& start : options.start)
    if (start.width != capture.reflectance.width || start.height != capture.reflectance.height ||
        start.channel_count() != 1)
      throw InvalidInput("start: must be of the size of the capture, and of one channel");
}

}  // namespace

AcquiredSkin acquire_patch(const Capture& capture, const PatchAcquisitionOptions& options,
                           const std::optional<DiskCache>& cache, const Progress& progress) {
  require_enough(capture, options);
  InversionModel model{.numbers = {},
                       .skin = capture.skin.skin,
                       .population = capture.population,
                       .has_transport = options.has_transport,
                       .totals = options.totals,
                       .reflectance = options.table ? options.table : table_of(capture)};
  for (const SkinFitNumber& number : capture.numbers)
    model.numbers.push_back(number.parameter.name);
  LargePatch patch = patch_of(capture);
  if (!options.start.empty())
    patch.start = [&](const TexelRectangle& part) { return parts_of(options.start, part); };
  const TexelRectangle all{0, 0, patch.width, patch.height};
  const std::optional<TileOptions> tiling = tiling_of(capture, options);
  const InversionTables tables = make_inversion_tables(
      tiling ? sampled_patch(capture, table_samples) : patch.part(all), model, cache);
  InversionOptions inversion = options.inversion;
  if (!options.has_transport) inversion.is_by_texel = true;
  AcquiredSkin skin = skin_before(capture, tables);
  // Pixels on their own have one growth of errors, whether they go by tiles or at once.
  std::vector<BandMisfit> misfit;
  if (inversion.is_by_texel && inversion.deviation_samples > 0) {
    misfit = misfit_of_texels(sampled_patch(capture, misfit_samples), tables, inversion);
    inversion.error_growth = error_growth_of(misfit);
  }
  InversionResult course;
  if (tiling) {
    course = invert_tiles(
        patch, tables, *tiling, inversion,
        [&](const PatchTile& tile, const InversionResult& part) {
          put_found(capture, tile.kept, part, skin);
        },
        progress);
  } else {
    if (patch.start) inversion.start = patch.start(all);
    course = invert_patch(patch.part(all), tables, inversion, progress);
    put_found(capture, all, course, skin);
  }
  for (AcquiredNumber& number : skin.numbers)
    number.prior_share = number.within_share =
        std::min(1.0, median_over_skin(number.deviations.pixels, skin.kinds) /
                          static_cast<double>(static_cast<float>(number.prior_deviation)));
  if (misfit.empty()) misfit = std::move(course.misfit);
  skin.chi_squared = chi_squared_of(misfit);
  if (!misfit.empty()) skin.error_growth = std::move(course.error_growth);
  skin.inversion = {.has_transport = options.has_transport,
                    .smoothness = std::move(course.smoothness),
                    .history = std::move(course.history),
                    .stop = course.stop};
  return skin;
}

std::size_t count_tiles(const Capture& capture, const PatchAcquisitionOptions& options) {
  const std::optional<TileOptions> tiling = tiling_of(capture, options);
  if (!tiling) return 1;
  return patch_tiles(capture.reflectance.width, capture.reflectance.height,
                     capture.mm_per_pixel.value_or(1.0), *tiling)
      .size();
}

}  // namespace lamina
