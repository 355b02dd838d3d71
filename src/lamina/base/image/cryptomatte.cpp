// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/cryptomatte.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdio>
#include <map>

#include "lamina/base/io/json_output.h"

namespace lamina {
namespace {

constexpr std::size_t ranks = 6;

std::string hexadecimal(std::uint32_t value) {
  std::array<char, 9> text{};
  std::snprintf(text.data(), text.size(), "%08x", value);
  return text.data();
}

}  // namespace

std::uint32_t cryptomatte_hash(std::string_view name) {
  constexpr std::uint32_t c1 = 0xcc9e2d51, c2 = 0x1b873593;
  const auto byte = [&](std::size_t i) {
    return std::uint32_t{static_cast<unsigned char>(name[i])};
  };
  std::uint32_t h = 0;
  const std::size_t blocks = name.size() / 4;
  for (std::size_t i = 0; i < 4 * blocks; i += 4) {
    const std::uint32_t k = byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24;
    h = std::rotl(h ^ std::rotl(k * c1, 15) * c2, 13) * 5 + 0xe6546b64;
  }
  std::uint32_t k = 0;
  for (std::size_t i = name.size(); i-- > 4 * blocks;) k = k << 8 | byte(i);
  h ^= std::rotl(k * c1, 15) * c2;
  h ^= static_cast<std::uint32_t>(name.size());
  h = (h ^ h >> 16) * 0x85ebca6b;
  h = (h ^ h >> 13) * 0xc2b2ae35;
  return h ^ h >> 16;
}

float cryptomatte_value(std::uint32_t hash) {
  const std::uint32_t exponent = hash >> 23 & 255;
  return std::bit_cast<float>(exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash);
}

bool is_cryptomatte(std::string_view channel) { return channel.starts_with("Crypto"); }

std::vector<ImageNote> add_cryptomatte(Image& image, std::string_view layer,
                                       std::span<const std::string> names,
                                       std::span<const std::vector<MatteShare>> shares) {
  const std::size_t before = image.channel_count();
  std::vector<std::string> channels = image.channels;
  for (std::size_t pair = 0; pair < ranks / 2; ++pair)
    for (const char part : {'R', 'G', 'B', 'A'})
      channels.push_back(std::string(layer) + "0" + std::to_string(pair) + "." + part);
  std::vector<float> ids;
  JsonOutput manifest = JsonOutput::object();
  for (const std::string& name : names) {
    const std::uint32_t hash = cryptomatte_hash(name);
    ids.push_back(cryptomatte_value(hash));
    manifest[name] = hexadecimal(std::bit_cast<std::uint32_t>(ids.back()));
  }
  Image result = make_image(image.width, image.height, std::move(channels));
  const std::size_t pixels = shares.size();
  assert(pixels * before == image.pixels.size());
  for (std::size_t i = 0; i < pixels; ++i) {
    float* to = result.pixels.data() + i * result.channel_count();
    std::copy_n(image.pixels.data() + i * before, before, to);
    std::vector<std::pair<float, float>> found;  // ID, coverage
    for (const MatteShare& share : shares[i]) {
      const float id = ids[share.thing];
      const auto same = std::ranges::find(found, id, &std::pair<float, float>::first);
      if (same == found.end())
        found.emplace_back(id, share.cover);
      else
        same->second += share.cover;
    }
    std::ranges::stable_sort(found, std::ranges::greater(), &std::pair<float, float>::second);
    to += before;
    for (std::size_t r = 0; r < std::min(ranks, found.size()); ++r) {
      *to++ = found[r].first;
      *to++ = found[r].second;
    }
  }
  image = std::move(result);
  const std::string key = "cryptomatte/" + hexadecimal(cryptomatte_hash(layer)).substr(0, 7) + "/";
  return {{key + "name", std::string(layer)},
          {key + "hash", "MurmurHash3_32"},
          {key + "conversion", "uint32_to_float32"},
          {key + "manifest", manifest.text()}};
}

}  // namespace lamina
