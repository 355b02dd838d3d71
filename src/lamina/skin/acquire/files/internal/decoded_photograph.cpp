// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/files/internal/decoded_photograph.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/skin/acquire/calibration/color_chart.h"
#include "lamina/skin/acquire/calibration/color_correction.h"
#include "lamina/skin/acquire/calibration/gray_card.h"
#include "lamina/skin/acquire/calibration/light_window.h"
#include "lamina/skin/acquire/calibration/polarized_pair.h"
#include "lamina/skin/lookup/skin_lookup.h"

namespace lamina::acquire_detail {
namespace {

constexpr std::size_t most_channels = 512;
/// Reflectances of skin lie far within; what is beyond has another unit.
constexpr float lowest_reflectance = -0.05f, highest_reflectance = 4.0f;

std::vector<std::string> channels_to_read(const JsonObject& object, const Image& image) {
  std::vector<std::string> names;
  if (const auto given = object.optional("channels")) {
    for (const JsonInput& each : given->array(1, most_channels)) {
      names.push_back(each.string());
      if (!channel_index(image, names.back())) each.refuse("must be a channel of the image");
    }
    return names;
  }
  for (const std::string& name : image.channels)
    if (name != "A") names.push_back(name);
  std::vector<std::string> colors = names;  // which EXR files hold by their names
  std::ranges::sort(colors);
  if (colors == std::vector<std::string>{"B", "G", "R"}) names = {"R", "G", "B"};
  return names;
}

/// What all images of an entry have alike.
struct Reading {
  const JsonObject& object;
  ColorEncoding encoding;
  std::vector<std::string> channels;

  /// Another image of the entry, of the same channels and size.
  [[nodiscard]] Image operator()(const JsonInput& file, const Image& like) const {
    Image image = load_finite(file, encoding);
    for (const std::string& name : channels)
      if (!channel_index(image, name)) file.fail("must have the channel " + name + " of the image");
    image = select_channels(image, channels);
    if (image.width != like.width || image.height != like.height)
      file.fail("must be of the size of the image, " + std::to_string(like.width) + " x " +
                std::to_string(like.height) + ", but is " + std::to_string(image.width) + " x " +
                std::to_string(image.height));
    return image;
  }
};

void require_reflectances(const JsonInput& file, const Image& image) {
  const std::size_t bands = image.channel_count();
  const auto width = static_cast<std::size_t>(image.width);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (!(lowest_reflectance <= image.pixels[i] && image.pixels[i] <= highest_reflectance))
      file.fail(
          "must hold fractions of what white reflects, in [-0.05, 4] (\"white\" divides), but "
          "pixel " +
          std::to_string(i / bands % width) + ", " + std::to_string(i / bands / width) + " has " +
          image.channels[i % bands] + " = " +
          printf_text("%.4g", static_cast<double>(image.pixels[i])));
}

/// How the white beside a polarized pair was photographed.
enum class WhitePolarizers {
  none,      ///< without the sheet before the lens: all the light that it returns
  crossed,   ///< through the sheets as the image has them
  parallel,  ///< through the sheets as its other photograph has them
};

/// The polarizers of the white: they must be stated beside a pair, whose level hangs on them by a
/// factor of two, and mean nothing else.
/// @throws InvalidInput where they are missing, or there is no pair
WhitePolarizers decode_polarizers(const JsonObject& object) {
  const auto white = object.optional("white");
  const auto given = white && white->is_object() ? white->peek("polarizers") : std::nullopt;
  const auto parallel = object.optional("parallel");
  if (!parallel) {
    if (given) given->fail("is of the white of a pair, but there is no \"parallel\"");
    return WhitePolarizers::none;
  }
  if (given)
    return given->choice<WhitePolarizers>({{"none", WhitePolarizers::none},
                                           {"crossed", WhitePolarizers::crossed},
                                           {"parallel", WhitePolarizers::parallel}});
  if (!white && object.optional("chart")) return WhitePolarizers::none;  // which has the level
  constexpr const char* rule =
      "the sheets that white was seen through: \"crossed\", \"parallel\" or \"none\"";
  if (white && white->is_object())
    white->fail(std::string("must say \"polarizers\", ") + rule + ", since there is a pair");
  if (white)
    white->fail(std::string("must be an object with \"level\" and \"polarizers\", ") + rule +
                ", since there is a pair, but is a number");
  parallel->fail(std::string("needs \"white\" with \"polarizers\", ") + rule +
                 "; {\"level\": 1, \"polarizers\": \"none\"} where images hold fractions of all "
                 "the light that white returns");
}

/// The part of the light of a matte white that passes the sheet before the lens: of light without
/// polarization half, either way [Jacques2002].
double light_past(WhitePolarizers polarizers) {
  return polarizers == WhitePolarizers::none ? 1.0 : 0.5;
}

/// What the image would hold where white is, [channel].
std::vector<double> decode_white_number(const JsonObject& object, const Image& image,
                                        const std::vector<double>& saturation) {
  const std::size_t bands = image.channel_count();
  const auto given = object.optional("white");
  if (!given) return std::vector(bands, 1.0);
  if (!given->is_object()) return given->number_or_numbers(bands, greater_than(0.0));
  if (const auto level = given->peek("level")) {
    const JsonObject white = given->object({"level", "polarizers"});
    std::vector<double> levels =
        white.required("level").number_or_numbers(bands, greater_than(0.0));
    for (double& each : levels) each /= light_past(decode_polarizers(object));
    return levels;
  }
  const JsonObject white = given->object({"card", "reflectance", "polarizers"});
  const JsonInput card = white.required("card");
  std::vector<double> reflectance =
      white.required("reflectance")
          .number_or_numbers(bands, {.low = 0.0, .high = 2.0, .includes_low = false});
  const WhitePolarizers polarizers = decode_polarizers(object);
  if (polarizers == WhitePolarizers::none && object.optional("parallel"))
    white.required("polarizers")
        .fail("must be \"crossed\" or \"parallel\": the card lies in the image, behind its sheets");
  for (double& each : reflectance) each *= light_past(polarizers);
  const std::vector<Vec2> corners = decode_corners(card, 3, 100);
  try {
    return white_level(
        read_card(image, mask_from_image(polygon_image(corners, image.width, image.height)),
                  *std::ranges::min_element(saturation), "the card"),
        reflectance);
  } catch (const InvalidInput& error) {
    card.fail(error.what());
  }
}

double decode_exposure(const JsonObject& object) {
  const auto given = object.optional("exposure");
  return given ? given->number(greater_than(0.0)) : 1.0;
}

/// By an image of a white reference.
Developed develop_by_image(const Reading& read, Image raw, const PixelMask& mask) {
  const JsonInput given = read.object.required("white");
  const JsonObject white =
      given.object({"image", "reflectance", "exposure", "count", "polarizers"});
  Photographs photographs{.white = read(white.required("image"), raw)};
  DevelopOptions options;
  const std::size_t bands = raw.channel_count();
  if (const auto reflectance = white.optional("reflectance"))
    options.white_reflectance =
        reflectance->number_or_numbers(bands, {.low = 0.0, .high = 2.0, .includes_low = false});
  const double past = light_past(decode_polarizers(read.object));
  if (past != 1.0) {
    options.white_reflectance.resize(bands, 1.0);
    for (double& each : options.white_reflectance) each *= past;
  }
  options.exposure_ratio = {decode_exposure(white) / decode_exposure(read.object)};
  if (const auto count = white.optional("count"))
    photographs.white_count = static_cast<int>(count->integer(1, 10000));
  if (const auto dark = read.object.optional("dark")) {
    if (dark->is_number())
      photographs.black = dark->number();
    else
      photographs.dark = read(*dark, raw);
  }
  if (const auto saturated = read.object.optional("saturated"))
    options.saturation = saturated->number(greater_than(0.0));
  photographs.raw = std::move(raw);
  try {
    return develop(photographs, mask, options);
  } catch (const InvalidInput& error) {
    given.fail(error.what());
  }
}

/// By what the image holds where white is; the errors are stated.
Developed develop_by_numbers(const Reading& read, Image image, PixelMask mask,
                             const std::vector<double>& errors) {
  const std::size_t bands = image.channel_count();
  if (const auto dark = read.object.optional("dark")) {
    if (dark->is_number()) {
      const auto black = static_cast<float>(dark->number());
      for (float& pixel : image.pixels) pixel -= black;
    } else {
      const Image black = read(*dark, image);
      for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] -= black.pixels[i];
    }
  }
  const auto stated = stated_encoding(read.encoding);
  const bool is_of_displays =
      read.encoding == ColorEncoding::srgb || (stated && !is_linear(stated->curve));
  std::vector<double> saturation(bands,
                                 is_of_displays ? 1.0 : std::numeric_limits<double>::infinity());
  if (const auto given = read.object.optional("saturated"))
    saturation = given->number_or_numbers(bands, greater_than(0.0));
  const std::vector<double> white = decode_white_number(read.object, image, saturation);
  Developed developed{.reflectance = std::move(image), .mask = std::move(mask)};
  developed.deviation = developed.reflectance;
  for (std::size_t i = 0; i < developed.reflectance.pixels.size(); ++i) {
    float& pixel = developed.reflectance.pixels[i];
    if (static_cast<double>(pixel) >= saturation[i % bands])
      developed.mask.mark(i / bands, PixelFault::saturated);
    pixel = static_cast<float>(static_cast<double>(pixel) / white[i % bands]);
    developed.deviation.pixels[i] = static_cast<float>(errors[i % bands]) * std::abs(pixel);
  }
  require_reflectances(read.object.required("image"), developed.reflectance);
  return developed;
}

Developed develop_by(const Reading& read, Image image, const PixelMask& mask,
                     const std::vector<double>& errors) {
  const auto white = read.object.optional("white");
  return white && white->is_object() && white->peek("image")
             ? develop_by_image(read, std::move(image), mask)
             : develop_by_numbers(read, std::move(image), mask, errors);
}

/// Colors of a chart in the image, or in one of its own, say what the camera's are.
void correct_by_chart(const JsonInput& value, const Reading& read,
                      const std::vector<double>& stated, DecodedPhotograph& photograph) {
  const JsonObject chart = value.object({"image", "corners", "edition"});
  ChartOptions options;
  if (const auto edition = chart.optional("edition"))
    options.edition = edition->choice<ColorChartEdition>();
  if (read.channels != std::vector<std::string>{"R", "G", "B"})
    value.fail("is for images with channels R, G, B only");
  if (photograph.sensor.names != std::vector<std::string>{"R", "G", "B"} ||
      !read.object.required("sensor").is_string())
    value.fail("makes sRGB of an image: \"sensor\" must be \"srgb\"");
  Developed& developed = photograph.developed;
  Image own;
  if (const auto file = chart.optional("image"))
    own = develop_by(read, read(*file, developed.reflectance),
                     make_pixel_mask(developed.mask.width, developed.mask.height), stated)
              .reflectance;
  if (read.object.optional("parallel"))  // taken as the image is, through crossed sheets
    for (float& pixel : own.pixels) pixel *= 2.0f;
  const Image& image = own.pixels.empty() ? developed.reflectance : own;
  std::vector<Vec2> corners;
  if (const auto given = chart.optional("corners")) corners = decode_corners(*given, 4, 4);
  try {
    const ChartReading reading =
        corners.empty() ? find_color_chart(image, "the image", options)
                        : read_color_chart(image, {corners[0], corners[1], corners[2], corners[3]},
                                           "the image", options);
    if (own.pixels.empty()) leave_out_chart(reading.corners, developed.mask);
    const ColorCorrection correction =
        fit_color_correction(color_samples(reading, options.edition));
    std::array<double, 3> mean = {};  // of what is used, for the errors of the matrix
    double used = 0.0;
    for (std::size_t i = 0; i < developed.mask.faults.size(); ++i)
      if (developed.mask.faults[i] == 0) {
        ++used;
        for (std::size_t c = 0; c < 3; ++c)
          mean[c] += static_cast<double>(developed.reflectance.pixels[3 * i + c]);
      }
    for (double& channel : mean) channel /= std::max(used, 1.0);
    CorrectedImage corrected =
        corrected_colors(developed.reflectance, developed.deviation, correction.matrix);
    developed.reflectance = std::move(corrected.color);
    developed.deviation = std::move(corrected.deviation);
    const Matrix3 covariance = correction_covariance(correction, mean);
    const std::array<double, 3> color = correction.matrix * mean;
    for (std::size_t c = 0; c < 3; ++c)
      photograph.errors[c] =
          std::hypot(photograph.errors[c],
                     std::sqrt(std::max(covariance[c][c], 0.0)) / std::max(color[c], 1e-3));
    photograph.notes.push_back(printf_text(
        "colors corrected by a chart: CIEDE2000 %.2f in the mean of its patches, %.2f "
        "and at most %.2f for patches left out",
        correction.mean_error, correction.mean_left_out_error, correction.largest_left_out_error));
  } catch (const InvalidInput& error) {
    value.fail(error.what());
  }
}

/// The light on the skin over that on the white: by the square of its distance, and by how much the
/// skin is tilted towards it.
double light_over_white(const JsonObject& object, const Incidence& incidence) {
  double light = 1.0;
  if (const auto distance = object.optional("distance")) {
    const std::vector<double> both = distance->numbers(2, closed_interval(1.0, 1e5, "mm"));
    light *= std::pow(both[1] / both[0], 2);
  }
  if (const auto tilt = object.optional("tilt")) {
    if (incidence.is_diffuse) tilt->fail("needs light from one side: \"incidence\" in degrees");
    const double turned = incidence.theta - tilt->number(closed_interval(-80.0, 80.0, "deg")) *
                                                std::numbers::pi / 180.0;
    if (!(std::abs(turned) < 85.0 * std::numbers::pi / 180.0))
      tilt->refuse("must leave the light less than 85 degrees from the normal of the skin");
    light *= std::cos(turned) / std::cos(incidence.theta);
  }
  return light;
}

/// A pattern of light: its first channel, linear.
Image decode_pattern(const JsonInput& file, const PixelMask& like) {
  const Image image = load_finite(file, ColorEncoding::linear);
  if (image.width != like.width || image.height != like.height)
    file.fail("must be of the size of the image, " + std::to_string(like.width) + " x " +
              std::to_string(like.height) + ", but is " + std::to_string(image.width) + " x " +
              std::to_string(image.height));
  Image pattern = select_channels(image, {image.channels[0]});
  pattern.channels = {"Y"};
  const auto [low, high] = std::ranges::minmax(pattern.pixels);
  if (low < 0.0f || !(high > 0.0f))
    file.fail("must be light, 0 or more and somewhere more, but is from " +
              number_text(static_cast<double>(low)) + " to " +
              number_text(static_cast<double>(high)));
  return pattern;
}

}  // namespace

void leave_out_chart(const ChartCorners& corners, PixelMask& mask) {
  const Image covered = polygon_image(chart_outline(corners), mask.width, mask.height);
  constexpr float rounding = 1e-3f;  // of sums along rows
  for (std::size_t i = 0; i < covered.pixels.size(); ++i)
    if (covered.pixels[i] > rounding) mask.mark(i, PixelFault::excluded);
}

Image load_finite(const JsonInput& file, ColorEncoding encoding) {
  try {
    Image image = load_image(file.file_path(), encoding, file.memory());
    require_finite(image, file.file_path());
    return image;
  } catch (const FileError& error) {
    file.fail(error.what());
  }
}

std::vector<Vec2> decode_corners(const JsonInput& value, std::size_t fewest, std::size_t most) {
  std::vector<Vec2> corners;
  for (const JsonInput& each : value.array(fewest, most)) {
    const std::vector<double> at = each.numbers(2, closed_interval(-1e6, 1e6));
    corners.push_back({at[0], at[1]});
  }
  return corners;
}

DecodedPhotograph decode_photograph(const JsonInput& value, const Incidence& incidence) {
  const JsonObject object =
      value.object({"image", "encoding", "channels", "sensor", "error", "white", "dark", "exposure",
                    "saturated", "parallel", "leak", "chart", "light", "distance", "tilt"});
  const JsonInput file = object.required("image");
  const ColorEncoding encoding = object.required("encoding").choice<ColorEncoding>();
  Image whole = load_finite(file, encoding);
  const Reading read{object, encoding, channels_to_read(object, whole)};
  const std::size_t bands = read.channels.size();
  DecodedPhotograph photograph;
  photograph.sensor = decode_sensor(object.required("sensor"), read.channels);
  photograph.errors.assign(bands, usual_color_error);
  if (const auto error = object.optional("error"))
    photograph.errors = error->number_or_numbers(bands, closed_interval(1e-4, 0.5));
  const std::vector<double> stated = photograph.errors;
  (void)decode_polarizers(object);
  const PixelMask mask = channel_index(whole, "A") ? mask_from_image(select_channels(whole, {"A"}))
                                                   : make_pixel_mask(whole.width, whole.height);
  if (whole.channels != read.channels) whole = select_channels(whole, read.channels);
  photograph.developed = develop_by(read, std::move(whole), mask, stated);
  Developed& developed = photograph.developed;
  if (const auto parallel = object.optional("parallel")) {
    PolarizedPairOptions options;
    if (const auto leak = object.optional("leak"))
      options.leak = leak->number({.low = 0.0, .high = 0.5, .includes_high = false});
    const Developed other = develop_by(read, read(*parallel, developed.reflectance), mask, stated);
    try {
      PolarizedPair pair = separate_polarized(other, developed, options);
      developed = std::move(pair.diffuse);
    } catch (const InvalidInput& error) {
      parallel->fail(error.what());
    }
    photograph.notes.emplace_back("diffuse light is that of crossed polarizers, twice");
  }
  const double light = light_over_white(object, incidence);
  for (Image* image : {&developed.reflectance, &developed.deviation})
    for (float& pixel : image->pixels)
      pixel = static_cast<float>(static_cast<double>(pixel) / light);
  if (const auto chart = object.optional("chart"))
    correct_by_chart(*chart, read, stated, photograph);
  if (const auto pattern = object.optional("light")) {
    photograph.light = decode_pattern(*pattern, developed.mask);
    photograph.light_file = pattern->string();
  }
  developed.reflectance.channels = photograph.sensor.names;
  developed.deviation.channels = photograph.sensor.names;
  return photograph;
}

}  // namespace lamina::acquire_detail
