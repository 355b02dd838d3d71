// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Mean and standard deviation of renders of one scene with different seeds: the references of this
// folder.
//
//   for seed in $(seq 32); do
//     lamina render diffuse.json --seed $seed -o renders/$seed.exr
//   done
//   image_reference diffuse.exr renders/*.exr

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"

namespace lamina {
namespace {

/// Channels R, G, B: mean of the renders; deviation.R, .G, .B: standard deviation of one.
Image image_reference(const std::vector<std::string>& files) {
  if (files.size() < 2) throw InvalidInput("a deviation takes two renders or more");
  Image result;
  std::vector<double> sum, sum_of_squares;
  for (const std::string& file : files) {
    const Image render = select_channels(load_image(file), {"R", "G", "B"});
    if (sum.empty()) {
      result = make_image(render.width, render.height,
                          {"R", "G", "B", "deviation.R", "deviation.G", "deviation.B"});
      sum.resize(render.pixels.size());
      sum_of_squares.resize(render.pixels.size());
    }
    if (render.pixels.size() != sum.size()) throw InvalidInput(file + " has another size");
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const auto value = static_cast<double>(render.pixels[i]);
      sum[i] += value;
      sum_of_squares[i] += value * value;
    }
  }
  const auto count = static_cast<double>(files.size());
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double mean = sum[i] / count;
    float* pixel = result.pixels.data() + i / 3 * 6 + i % 3;
    pixel[0] = static_cast<float>(mean);
    const double variance = (sum_of_squares[i] - count * mean * mean) / (count - 1.0);
    pixel[3] = static_cast<float>(std::sqrt(std::max(variance, 0.0)));
  }
  return result;
}

}  // namespace
}  // namespace lamina

int main(int count, char** arguments) {
  try {
    if (count < 2) throw lamina::InvalidInput("usage: image_reference OUT.exr RENDER.exr ...");
    lamina::save_exr(lamina::image_reference({arguments + 2, arguments + count}), arguments[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "image_reference: %s\n", error.what());
    return 1;
  }
}
