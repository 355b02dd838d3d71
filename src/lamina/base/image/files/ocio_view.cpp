// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/ocio_view.h"

#include "lamina/base/core/error.h"

#ifdef LAMINA_OCIO
#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "lamina/base/core/parallel.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/base/spectrum/rgb_space.h"
#include "lamina/base/spectrum/srgb.h"
#endif

namespace lamina {

#ifdef LAMINA_OCIO

namespace ocio = OCIO_NAMESPACE;

struct OcioView::Processor {
  std::string display, view;
  Matrix3 to_source{};  ///< from linear Rec.709
  ocio::ConstCPUProcessorRcPtr cpu;
};

namespace {

/// The name of a config's space of Rec.709's primaries and linear light; names are compared without
/// regard to case.
std::string rec709_space(const ocio::ConstConfigRcPtr& config) {
  for (const char* name :
       {"lin_rec709", "lin_rec709_srgb", "lin_srgb", "Linear Rec.709 (sRGB)", "Linear Rec.709",
        "Linear BT.709", "Utility - Linear - Rec.709", "Utility - Linear - sRGB", "Linear"})
    if (const ocio::ConstColorSpaceRcPtr space = config->getColorSpace(name))
      return space->getName();
  return "";
}

/// The wanted one of some names; the given one where none is wanted.
std::string choose(const std::string& wanted, const std::string& by_default,
                   const std::vector<std::string>& names, const std::string& what) {
  if (wanted.empty()) return by_default;
  if (std::ranges::find(names, wanted) != names.end()) return wanted;
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  const std::vector<std::string_view> known(names.begin(), names.end());
  throw InvalidInput(what + " must be one of " + list + ", but is " + wanted +
                     did_you_mean(wanted, known));
}

/// Matrices would spread NaN and infinity over the other channels.
double bounded(double light) {
  constexpr double most = 65504.0;  // that half holds, for which tables of configs are made
  return std::isnan(light) ? 0.0 : std::clamp(light, -most, most);
}

std::string in_one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text;
}

}  // namespace

OcioView::OcioView(const OcioChoice& choice) : processor_(std::make_unique<Processor>()) {
  const std::string& file = choice.config;
  // OpenColorIO would wait for a pipe; what is missing it tells itself.
  if (std::error_code ignored; std::filesystem::exists(file, ignored)) require_regular_file(file);
  try {
    const ocio::ConstConfigRcPtr config = ocio::Config::CreateFromFile(file.c_str());
    config->validate();
    std::vector<std::string> displays, views;
    for (int i = 0; i < config->getNumDisplays(); ++i) displays.emplace_back(config->getDisplay(i));
    processor_->display =
        choose(choice.display, config->getDefaultDisplay(), displays, file + ": the display");
    const char* display = processor_->display.c_str();
    for (int i = 0; i < config->getNumViews(display); ++i)
      views.emplace_back(config->getView(display, i));
    processor_->view = choose(choice.view, config->getDefaultView(display), views,
                              file + ": the view of " + processor_->display);
    std::string source = rec709_space(config);
    const RgbPrimaries rec709 = rec709_primaries();
    processor_->to_source = rgb_conversion(rec709, rec709);
    if (source.empty()) {
      source = ocio::ROLE_INTERCHANGE_SCENE;
      if (!config->hasRole(source.c_str()))
        throw InvalidInput(file +
                           ": has no linear Rec.709; one of its spaces must have the alias "
                           "lin_rec709, or the role aces_interchange");
      processor_->to_source = rgb_conversion(rec709, aces2065_primaries());
    }
    const ocio::DisplayViewTransformRcPtr transform = ocio::DisplayViewTransform::Create();
    transform->setSrc(source.c_str());
    transform->setDisplay(display);
    transform->setView(processor_->view.c_str());
    processor_->cpu = config->getProcessor(transform)->getDefaultCPUProcessor();
  } catch (const ocio::Exception& error) {
    throw FileError(file + ": cannot be read by OpenColorIO: " + in_one_line(error.what()));
  }
}

const std::string& OcioView::display() const { return processor_->display; }
const std::string& OcioView::view() const { return processor_->view; }

Image OcioView::see(const Image& image, double exposure) const {
  const bool is_grey = !channel_index(image, "R") && channel_index(image, "Y");
  std::vector<std::string> names =
      is_grey ? std::vector<std::string>{"Y", "Y", "Y"} : std::vector<std::string>{"R", "G", "B"};
  if (channel_index(image, "A")) names.emplace_back("A");
  Image result = select_channels(image, names);
  const std::size_t channels = names.size();
  const auto width = static_cast<std::size_t>(image.width);
  result.channels[0] = "R";
  result.channels[1] = "G";
  result.channels[2] = "B";
  const double scale = std::exp2(exposure);
  parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t y) {
    float* row = result.at(0, static_cast<int>(y));
    std::vector<float> light(3 * width);
    for (std::size_t x = 0; x < width; ++x) {
      std::array<double, 3> color{};
      for (std::size_t c = 0; c < 3; ++c)
        color[c] = bounded(scale * static_cast<double>(row[x * channels + c]));
      color = processor_->to_source * color;
      for (std::size_t c = 0; c < 3; ++c) light[3 * x + c] = static_cast<float>(color[c]);
    }
    ocio::PackedImageDesc pixels(light.data(), image.width, 1, 3);
    processor_->cpu->apply(pixels);
    for (std::size_t x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        const double code = static_cast<double>(light[3 * x + c]);
        row[x * channels + c] =
            static_cast<float>(srgb_decode(code > 0.0 ? std::min(code, 1.0) : 0.0));
      }
  });
  return result;
}

#else

struct OcioView::Processor {
  std::string none;
};

OcioView::OcioView(const OcioChoice&) {
  throw InvalidInput("views of OpenColorIO need lamina built with it (Debian: libopencolorio-dev)");
}

const std::string& OcioView::display() const { return processor_->none; }
const std::string& OcioView::view() const { return processor_->none; }
Image OcioView::see(const Image& image, double) const { return image; }

#endif

OcioView::~OcioView() = default;
OcioView::OcioView(OcioView&&) noexcept = default;
OcioView& OcioView::operator=(OcioView&&) noexcept = default;

}  // namespace lamina
