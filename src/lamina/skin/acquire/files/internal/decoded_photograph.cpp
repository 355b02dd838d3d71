// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/files/internal/decoded_photograph.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/skin/lookup/skin_lookup.h"

namespace lamina::acquire_detail {
namespace {

constexpr std::size_t most_channels = 512;
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

/// Numbers of a white, or the card that has them.
void decode_white_number(const JsonObject& object, PhotographDescription& photograph) {
  const std::size_t bands = photograph.image.channel_count();
  const auto given = object.optional("white");
  if (!given) {
    photograph.white = std::vector(bands, 1.0);
    return;
  }
  if (!given->is_object()) {
    photograph.white = given->number_or_numbers(bands, greater_than(0.0));
    return;
  }
  const double past = light_past(decode_polarizers(object));
  if (const auto level = given->peek("level")) {
    const JsonObject white = given->object({"level", "polarizers"});
    std::vector<double> levels =
        white.required("level").number_or_numbers(bands, greater_than(0.0));
    for (double& each : levels) each /= past;
    photograph.white = std::move(levels);
    return;
  }
  const JsonObject white = given->object({"card", "reflectance", "polarizers"});
  const JsonInput value = white.required("card");
  PhotographDescription::Card card;
  card.place = value.where();
  card.corners = decode_corners(value, 3, 100);
  card.reflectance =
      white.required("reflectance")
          .number_or_numbers(bands, {.low = 0.0, .high = 2.0, .includes_low = false});
  if (past == 1.0 && photograph.parallel)
    white.required("polarizers")
        .fail("must be \"crossed\" or \"parallel\": the card lies in the image, behind its sheets");
  for (double& each : card.reflectance) each *= past;
  photograph.white = std::move(card);
}

double decode_exposure(const JsonObject& object) {
  const auto given = object.optional("exposure");
  return given ? given->number(greater_than(0.0)) : 1.0;
}

PhotographDescription::White decode_white_image(const JsonInput& given, const Reading& read,
                                                const Image& like) {
  const JsonObject object =
      given.object({"image", "reflectance", "exposure", "count", "polarizers"});
  PhotographDescription::White white;
  white.place = given.where();
  white.image = read(object.required("image"), like);
  const std::size_t bands = like.channel_count();
  if (const auto reflectance = object.optional("reflectance"))
    white.reflectance =
        reflectance->number_or_numbers(bands, {.low = 0.0, .high = 2.0, .includes_low = false});
  const double past = light_past(decode_polarizers(read.object));
  if (past != 1.0) {
    white.reflectance.resize(bands, 1.0);
    for (double& each : white.reflectance) each *= past;
  }
  white.exposure_ratio = decode_exposure(object) / decode_exposure(read.object);
  if (const auto count = object.optional("count"))
    white.count = static_cast<int>(count->integer(1, 10000));
  return white;
}

/// The image's numbers of white and without light, and from which on it is saturated.
void decode_calibration(const Reading& read, PhotographDescription& photograph) {
  const std::size_t bands = photograph.image.channel_count();
  const auto saturated = read.object.optional("saturated");
  const auto white = read.object.optional("white");
  if (white && white->is_object() && white->peek("image")) {
    photograph.white = decode_white_image(*white, read, photograph.image);
    if (saturated) photograph.saturation = {saturated->number(greater_than(0.0))};
  } else {
    const auto stated = stated_encoding(read.encoding);
    const bool is_of_displays =
        read.encoding == ColorEncoding::srgb || (stated && !is_linear(stated->curve));
    photograph.saturation.assign(bands,
                                 is_of_displays ? 1.0 : std::numeric_limits<double>::infinity());
    if (saturated) photograph.saturation = saturated->number_or_numbers(bands, greater_than(0.0));
    decode_white_number(read.object, photograph);
  }
  if (const auto dark = read.object.optional("dark")) {
    if (dark->is_number())
      photograph.dark = dark->number();
    else
      photograph.dark = read(*dark, photograph.image);
  }
}

PhotographDescription::Chart decode_chart(const JsonInput& value, const Reading& read,
                                          const DecodedPhotograph& decoded) {
  const JsonObject object = value.object({"image", "corners", "edition"});
  PhotographDescription::Chart chart{.place = value.where()};
  if (const auto edition = object.optional("edition"))
    chart.edition = edition->choice<ColorChartEdition>();
  if (read.channels != std::vector<std::string>{"R", "G", "B"})
    value.fail("is for images with channels R, G, B only");
  if (decoded.sensor.names != std::vector<std::string>{"R", "G", "B"} ||
      !read.object.required("sensor").is_string())
    value.fail("makes sRGB of an image: \"sensor\" must be \"srgb\"");
  if (const auto file = object.optional("image"))
    chart.image = read(*file, decoded.photograph.image);
  if (const auto given = object.optional("corners")) chart.corners = decode_corners(*given, 4, 4);
  return chart;
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
  DecodedPhotograph decoded;
  PhotographDescription& photograph = decoded.photograph;
  photograph.place = file.where();
  photograph.mask = channel_index(whole, "A") ? mask_from_image(select_channels(whole, {"A"}))
                                              : make_pixel_mask(whole.width, whole.height);
  decoded.sensor = decode_sensor(object.required("sensor"), read.channels);
  photograph.errors.assign(bands, usual_color_error);
  if (const auto error = object.optional("error"))
    photograph.errors = error->number_or_numbers(bands, closed_interval(1e-4, 0.5));
  (void)decode_polarizers(object);
  photograph.image =
      whole.channels == read.channels ? std::move(whole) : select_channels(whole, read.channels);
  if (const auto parallel = object.optional("parallel")) {
    PolarizedPairOptions options;
    if (const auto leak = object.optional("leak"))
      options.leak = leak->number({.low = 0.0, .high = 0.5, .includes_high = false});
    Image other = read(*parallel, photograph.image);
    photograph.parallel = {parallel->where(), std::move(other), options};
  }
  decode_calibration(read, photograph);
  photograph.light = light_over_white(object, incidence);
  if (const auto chart = object.optional("chart"))
    photograph.chart = decode_chart(*chart, read, decoded);
  if (const auto pattern = object.optional("light")) {
    decoded.light = decode_pattern(*pattern, photograph.mask);
    decoded.light_file = pattern->string();
  }
  return decoded;
}

}  // namespace lamina::acquire_detail
