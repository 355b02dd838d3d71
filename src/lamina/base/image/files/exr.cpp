// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <set>
#include <stdexcept>
#include <utility>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/color_space.h"
#include "lamina/base/image/cryptomatte.h"
#include "lamina/base/image/files/image_frame.h"
#include "lamina/base/image/files/internal/codec.h"
#include "lamina/base/image/files/internal/color_statement.h"
#include "lamina/base/io/file_bytes.h"

namespace lamina {
namespace {

/// Bytes in memory as a file of OpenEXR's.
class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(std::span<const std::byte> bytes) : IStream("image"), bytes_(bytes) {}

  bool read(char* to, int count) override {
    const std::size_t wanted = static_cast<std::size_t>(std::max(count, 0));
    if (position_ > bytes_.size() || wanted > bytes_.size() - position_)
      throw std::runtime_error("it ends too early");
    std::memcpy(to, bytes_.data() + position_, wanted);
    position_ += wanted;
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : OStream("image") {}

  void write(const char* from, int count) override {
    const std::size_t size = static_cast<std::size_t>(count);
    if (bytes.size() < position_ + size) bytes.resize(position_ + size);
    std::memcpy(bytes.data() + position_, from, size);
    position_ += size;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }

  std::vector<std::byte> bytes;

 private:
  std::size_t position_ = 0;
};

constexpr int version_and_magic_size = 8;

/// Walks over the attributes of all headers, so that no length in them reaches beyond the file:
/// OpenEXR takes memory for an attribute before it reads it. It also keeps 300 bytes and more for
/// an attribute or a channel of 12 bytes.
void check_attribute_lengths(const EncodedImage& file, bool is_multipart) {
  const auto bytes = file.bytes;
  std::size_t at = version_and_magic_size;
  const auto byte = [&]() {
    if (at >= bytes.size()) fail_to_decode(file, "EXR", "it ends within the header");
    return std::to_integer<unsigned char>(bytes[at++]);
  };
  const auto skip_text = [&]() {
    std::size_t length = 0;
    while (byte() != 0) ++length;
    return length;
  };
  for (bool is_first = true; is_first || is_multipart; is_first = false) {
    bool is_empty = true;
    while (skip_text() > 0) {  // the name
      is_empty = false;
      skip_text();  // the type
      std::uint32_t length = 0;
      for (int shift = 0; shift < 32; shift += 8) length |= std::uint32_t{byte()} << shift;
      if (length > bytes.size() - at) fail_to_decode(file, "EXR", "it ends within the header");
      at += length;
    }
    if (is_empty) break;
  }
  constexpr std::size_t growth = 32;
  MemoryBudget for_header = file.memory;
  take_memory(for_header, at, growth, file.name + ": the header");
}

/// The header of the first part. @throws FileError for what is not read, such as deep images.
Imf::Header read_header(const EncodedImage& file) {
  if (file.bytes.size() < version_and_magic_size)
    fail_to_decode(file, "EXR", "it ends within the header");
  int version = 0;
  for (std::size_t i = 0; i < 4; ++i)
    version |= std::to_integer<int>(file.bytes[4 + i]) << (8 * static_cast<int>(i));
  if (Imf::isNonImage(version)) fail_to_decode(file, "EXR", "it holds a deep image");
  check_attribute_lengths(file, Imf::isMultiPart(version));
  MemoryInput stream(file.bytes);
  stream.seekg(version_and_magic_size);
  Imf::Header header;
  header.readFrom(stream, version);
  header.sanityCheck(Imf::isTiled(version));
  if (header.hasTileDescription()) {
    constexpr unsigned longest = 1u << 14;
    const Imf::TileDescription& tile = header.tileDescription();
    if (tile.xSize > longest || tile.ySize > longest)
      fail_to_decode(file, "EXR",
                     "it claims tiles of " + std::to_string(tile.xSize) + " x " +
                         std::to_string(tile.ySize) + " pixels");
  }
  return header;
}

struct Window {
  std::int64_t x, y, width, height;
};

Window window_of(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, std::int64_t{box.max.x} - box.min.x + 1,
          std::int64_t{box.max.y} - box.min.y + 1};
}

/// How many rows are compressed together.
std::size_t rows_together(const Imf::Header& header) {
  switch (header.compression()) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
      return 1;
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
      return 32;
    default:
      return 256;
  }
}

/// What OpenEXR holds beside the image: a row of tiles as it copies from, the place of each row in
/// the file, and a tile or some rows in the forms that they take while they are unpacked.
std::size_t decoder_bytes(const EncodedImage& file, const Imf::Header& header, const Window& data) {
  std::size_t pixel = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel)
    pixel += channel.channel().type == Imf::HALF ? 2 : 4;
  const auto width = static_cast<std::size_t>(data.width);
  const auto height = static_cast<std::size_t>(data.height);
  const bool is_tiled = header.hasTileDescription();
  const Imf::TileDescription tile = is_tiled ? header.tileDescription() : Imf::TileDescription();
  const std::size_t rows = is_tiled ? tile.ySize : std::min(height, rows_together(header));
  const std::size_t piece_width = is_tiled ? tile.xSize : width;
  constexpr std::size_t forms = 6;
  return checked_sum(file.name,
                     {checked_product(file.name, {piece_width, rows, pixel, forms}),
                      is_tiled ? checked_product(file.name, {width + tile.xSize, rows, pixel}) : 0,
                      checked_product(file.name, {height, sizeof(std::uint64_t), 2})});
}

/// The part of `data` inside `display`; 0 where there is no data.
Image cropped(const Image& data, const Window& from, const Window& display) {
  Image image =
      make_image(static_cast<int>(display.width), static_cast<int>(display.height), data.channels);
  const std::int64_t left = std::max(from.x, display.x);
  const std::int64_t right = std::min(from.x + from.width, display.x + display.width);
  const std::int64_t top = std::max(from.y, display.y);
  const std::int64_t bottom = std::min(from.y + from.height, display.y + display.height);
  if (left >= right) return image;
  const auto count =
      static_cast<std::ptrdiff_t>(right - left) * static_cast<std::ptrdiff_t>(data.channel_count());
  for (std::int64_t y = top; y < bottom; ++y) {
    const float* row = data.at(static_cast<int>(left - from.x), static_cast<int>(y - from.y));
    std::copy(row, row + count,
              image.at(static_cast<int>(left - display.x), static_cast<int>(y - display.y)));
  }
  return image;
}

Image read_pixels(const EncodedImage& file, const Imf::Header& header) {
  std::vector<std::string> names;
  const Imf::ChannelList& channels = header.channels();
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1)
      fail_to_decode(file, "EXR",
                     std::string("its channel ") + channel.name() +
                         " has fewer samples than pixels (luminance and chroma)");
    names.emplace_back(channel.name());
  }
  const Window data = window_of(header.dataWindow());
  const Window display = window_of(header.displayWindow());
  const auto channel_count = static_cast<std::int64_t>(names.size());
  require_plausible_size(file, "EXR", data.width, data.height, channel_count);
  require_plausible_size(file, "EXR", display.width, display.height, channel_count);

  const bool is_whole = data.x == display.x && data.y == display.y && data.width == display.width &&
                        data.height == display.height;
  const auto data_bytes =
      static_cast<std::size_t>(data.width * data.height * channel_count) * sizeof(float);
  take_image_memory(file, static_cast<std::size_t>(display.width),
                    static_cast<std::size_t>(display.height), names.size(),
                    decoder_bytes(file, header, data) + (is_whole ? 0 : data_bytes));
  Image image = make_image(static_cast<int>(data.width), static_cast<int>(data.height), names);
  Imf::FrameBuffer buffer;
  const std::size_t pixel_bytes = names.size() * sizeof(float);
  for (std::size_t c = 0; c < names.size(); ++c)
    buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, image.pixels.data() + c,
                                             header.dataWindow(), pixel_bytes,
                                             pixel_bytes * static_cast<std::size_t>(data.width)));
  MemoryInput stream(file.bytes);
  Imf::InputFile input(stream, 0);
  if (input.header().dataWindow() != header.dataWindow() ||
      !(input.header().channels() == channels))
    fail_to_decode(file, "EXR", "its first part is not a flat image");
  input.setFrameBuffer(buffer);
  input.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
  if (is_whole) return image;
  return cropped(image, data, display);
}

/// OpenEXR says nothing of lines whose compression found no memory, nor of a table that it could
/// not write: such lines have no place in the table.
/// @throws std::bad_alloc
void require_complete(std::span<const std::byte> bytes) {
  MemoryInput stream(bytes);
  if (!Imf::InputFile(stream, 0).isComplete()) throw std::bad_alloc();
}

RgbPrimaries::Xy xy_of(const Imath::V2f& xy) {
  return {static_cast<double>(xy.x), static_cast<double>(xy.y)};
}

Imath::V2f to_file(const RgbPrimaries::Xy& xy) {
  return {static_cast<float>(xy[0]), static_cast<float>(xy[1])};
}

Imf::Chromaticities to_file(const RgbPrimaries& primaries) {
  return {to_file(primaries.red), to_file(primaries.green), to_file(primaries.blue),
          to_file(primaries.white)};
}

RgbPrimaries primaries_of(const Imf::Chromaticities& given) {
  return {xy_of(given.red), xy_of(given.green), xy_of(given.blue), xy_of(given.white)};
}

/// The colors of a file in Rec.709. Those beyond its triangle lose what is negative.
Image in_rec709(Image image, const EncodedImage& file, const RgbPrimaries& primaries) {
  const RgbPrimaries rec709 = rec709_primaries();
  if (are_alike(primaries, rec709)) return image;
  try {
    return converted_colors(std::move(image), rgb_conversion(primaries, rec709), Negative::none);
  } catch (const InvalidInput& error) {
    fail_to_decode(file, "EXR", error.what());
  }
}

/// @param space  that the colors of the image are of
std::vector<std::byte> encode(const Image& image, ExrPrecision precision,
                              std::span<const ImageNote> notes, RgbSpace space,
                              const ImageFrame& frame) {
  if (image.width < 1 || image.height < 1 || image.channels.empty())
    throw InvalidInput("image: an EXR file needs at least one pixel and one channel");
  if (std::set(image.channels.begin(), image.channels.end()).size() != image.channels.size())
    throw InvalidInput("image: channel names must differ, but two are equal");
  const auto is_half = [&](const std::string& channel) {
    return precision == ExrPrecision::half && !is_cryptomatte(channel);
  };
  std::vector<half> halves;
  if (precision == ExrPrecision::half) {
    halves.resize(image.pixels.size());
    std::ranges::transform(image.pixels, halves.begin(), [](float v) {
      constexpr float largest = 65504.0f;  // of half; infinities and NaN are kept
      return half(std::isfinite(v) ? std::clamp(v, -largest, largest) : v);
    });
  }
  Imf::Header header(image.width, image.height);
  if (frame.width > 0) {
    header.displayWindow().max = {frame.width - 1, frame.height - 1};
    header.dataWindow() = {{frame.x, frame.y},
                           {frame.x + image.width - 1, frame.y + image.height - 1}};
  }
  header.compression() = Imf::ZIP_COMPRESSION;
  if (has_colors(image)) Imf::addChromaticities(header, to_file(primaries_of(space)));
  for (const ImageNote& note : notes) header.insert(note.name, Imf::StringAttribute(note.text));
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    const Imf::PixelType type = is_half(image.channels[c]) ? Imf::HALF : Imf::FLOAT;
    const std::size_t size = type == Imf::HALF ? sizeof(half) : sizeof(float);
    const char* pixels = type == Imf::HALF ? reinterpret_cast<const char*>(halves.data())
                                           : reinterpret_cast<const char*>(image.pixels.data());
    header.channels().insert(image.channels[c], Imf::Channel(type));
    buffer.insert(
        image.channels[c],
        Imf::Slice::Make(type, pixels + c * size, header.dataWindow(), size * image.channel_count(),
                         size * image.channel_count() * static_cast<std::size_t>(image.width)));
  }
  MemoryOutput stream;
  {
    Imf::OutputFile output(stream, header, 0);
    output.setFrameBuffer(buffer);
    output.writePixels(image.height);
  }  // the table of line positions is written here
  require_complete(stream.bytes);
  return std::move(stream.bytes);
}

/// @param space  that the colors, linear Rec.709, are turned into
std::vector<std::byte> encode_in(const Image& image, ExrPrecision precision,
                                 std::span<const ImageNote> notes, RgbSpace space,
                                 const ImageFrame& frame) {
  if (space == RgbSpace::rec709) return encode(image, precision, notes, space, frame);
  const Matrix3 conversion = rgb_conversion(rec709_primaries(), primaries_of(space));
  return encode(converted_colors(image, conversion), precision, notes, space, frame);
}

}  // namespace

Image decode_exr(const EncodedImage& file) {
  try {
    const Imf::Header header = read_header(file);
    if (header.hasType() && header.type().starts_with("deep"))
      fail_to_decode(file, "EXR", "it holds a deep image");
    Image image = read_pixels(file, header);
    if (const auto stated = stated_encoding(file.encoding))
      return in_rec709(decoded_colors(std::move(image), stated->curve), file, stated->primaries);
    if (!follows_statement(file.encoding) || !Imf::hasChromaticities(header)) return image;
    return in_rec709(std::move(image), file, primaries_of(Imf::chromaticities(header)));
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    fail_to_decode(file, "EXR", error.what());
  }
}

std::vector<std::byte> encode_exr(const Image& image, ExrPrecision precision,
                                  std::span<const ImageNote> notes, RgbSpace space) {
  return encode_in(image, precision, notes, space, {});
}

void save_exr(const Image& image, const std::filesystem::path& file, ExrPrecision precision,
              std::span<const ImageNote> notes, RgbSpace space, const ImageFrame& frame) {
  write_file_bytes(file, encode_in(image, precision, notes, space, frame));
}

}  // namespace lamina
