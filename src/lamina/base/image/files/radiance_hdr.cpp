// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/image/files/internal/codec.h"
#include "lamina/base/image/files/internal/color_statement.h"

namespace lamina {
namespace {

using Rgbe = std::array<unsigned char, 4>;

/// Reads a Radiance picture from its first byte to its last. Source: [Ward1991], and the file
/// formats of Radiance, "Picture File Format (.hdr suffix)".
class HdrReader {
 public:
  explicit HdrReader(const EncodedImage& file) : file_(file) {}

  Image read() {
    read_header();
    read_size();
    require_plausible_size(file_, "Radiance HDR", width_, height_, 3);
    const auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
    take_image_memory(file_, width, height, 3, checked_product(file_.name, {width, sizeof(Rgbe)}));
    Image image = make_image(static_cast<int>(width_), static_cast<int>(height_), {"R", "G", "B"});
    std::vector<Rgbe> row(width);
    for (int y = 0; y < image.height; ++y) {
      read_row(row);
      float* to = image.at(0, y);
      for (const Rgbe& pixel : row)
        for (std::size_t c = 0; c < 3; ++c) *to++ = linear(pixel, c);
    }
    return ColorReading(file_, "Radiance HDR", said_, false, true).in_rec709(std::move(image));
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    fail_to_decode(file_, "Radiance HDR", why);
  }

  unsigned char next() {
    if (position_ == file_.bytes.size()) fail("it ends too early");
    return std::to_integer<unsigned char>(file_.bytes[position_++]);
  }

  std::string line() {
    constexpr std::size_t longest = 4096;
    std::string text;
    for (unsigned char c = next(); c != '\n'; c = next()) {
      if (text.size() == longest) fail("a line of its header must not have more than 4096 bytes");
      text.push_back(static_cast<char>(c));
    }
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }

  void read_header() {
    (void)line();  // "#?RADIANCE" or another program's name
    for (std::string text = line(); !text.empty(); text = line()) {
      if (text.starts_with("FORMAT=") && text != "FORMAT=32-bit_rle_rgbe")
        fail("its format must be 32-bit_rle_rgbe, but is " + text.substr(7));
      if (text.starts_with("EXPOSURE=")) {  // radiance times all of these is what is stored
        exposure_ *= number(std::string_view(text).substr(9));
        if (!(exposure_ > 1e-30 && exposure_ < 1e30))
          fail("its exposure must be a positive number, but is " + text.substr(9));
      }
      if (text.starts_with("PRIMARIES=")) read_primaries(std::string_view(text).substr(10));
    }
  }

  /// x and y of red, green, blue and white.
  void read_primaries(std::string_view text) {
    std::array<double, 8> xy{};
    for (double& value : xy) {
      while (text.starts_with(' ') || text.starts_with('\t')) text.remove_prefix(1);
      const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (code != std::errc()) fail("its primaries must be eight numbers");
      text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    }
    said_.encoding = RgbEncoding{.primaries = {.red = {xy[0], xy[1]},
                                               .green = {xy[2], xy[3]},
                                               .blue = {xy[4], xy[5]},
                                               .white = {xy[6], xy[7]}},
                                 .curve = {}};
  }

  /// 0 where there is none.
  static double number(std::string_view text) {
    while (text.starts_with(' ')) text.remove_prefix(1);
    double value = 0.0;
    (void)std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  }

  static std::optional<std::int64_t> whole(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
  }

  void read_size() {
    const std::string text = line();
    const std::size_t x = text.find(" +X ");
    const auto height = text.starts_with("-Y ") && x != std::string::npos
                            ? whole(std::string_view(text).substr(3, x - 3))
                            : std::nullopt;
    const auto width = height ? whole(std::string_view(text).substr(x + 4)) : std::nullopt;
    if (!width) fail("its size must read -Y HEIGHT +X WIDTH, from the top left, but reads " + text);
    width_ = *width, height_ = *height;
  }

  void read_row(std::vector<Rgbe>& row) {
    const bool may_have_runs = row.size() >= 8 && row.size() < 32768;
    const Rgbe first = {next(), next(), next(), next()};
    if (may_have_runs && first[0] == 2 && first[1] == 2 && first[2] < 128)
      return read_runs(row, first[2] * 256U + first[3]);
    read_flat(row, first);
  }

  /// The four numbers of all pixels, one after another.
  void read_runs(std::vector<Rgbe>& row, std::size_t width) {
    if (width != row.size())
      fail("a row must have " + std::to_string(row.size()) + " pixels, but has " +
           std::to_string(width));
    for (std::size_t c = 0; c < 4; ++c)
      for (std::size_t x = 0; x < row.size();) {
        const unsigned char code = next();
        const std::size_t count = code > 128 ? code - 128U : code;
        if (count == 0 || count > row.size() - x) fail("a run must end within its row");
        if (code > 128) {
          const unsigned char value = next();
          for (std::size_t i = 0; i < count; ++i) row[x++][c] = value;
        } else {
          for (std::size_t i = 0; i < count; ++i) row[x++][c] = next();
        }
      }
  }

  /// Pixel by pixel; (1, 1, 1, n) repeats the one before, and again with n << 8, ...
  void read_flat(std::vector<Rgbe>& row, Rgbe pixel) {
    int shift = 0;
    for (std::size_t x = 0; x < row.size();) {
      if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
        const std::size_t count = shift < 24 ? static_cast<std::size_t>(pixel[3]) << shift : 0;
        if (x == 0 || count == 0 || count > row.size() - x) fail("a run must end within its row");
        for (std::size_t i = 0; i < count; ++i, ++x) row[x] = row[x - 1];
        shift += 8;
      } else {
        row[x++] = pixel;
        shift = 0;
      }
      if (x < row.size()) pixel = {next(), next(), next(), next()};
    }
  }

  /// The middle of the numbers that were rounded down to this one, as Radiance takes it.
  [[nodiscard]] float linear(const Rgbe& pixel, std::size_t channel) const {
    if (pixel[3] == 0) return 0.0F;
    const double value = std::ldexp(pixel[channel] + 0.5, pixel[3] - (128 + 8));
    return static_cast<float>(value / exposure_);
  }

  const EncodedImage& file_;
  std::size_t position_ = 0;
  std::int64_t width_ = 0, height_ = 0;
  double exposure_ = 1.0;
  ColorStatement said_;
};

}  // namespace

Image decode_radiance_hdr(const EncodedImage& file) { return HdrReader(file).read(); }

}  // namespace lamina
