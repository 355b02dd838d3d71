// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/internal/icc_transform.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/spectrum/color.h"

#ifdef LAMINA_ICC
#include <lcms2.h>
#include <lcms2_plugin.h>
#endif

namespace lamina {

#ifdef LAMINA_ICC

struct IccTransform::Handles {
  cmsContext context = nullptr;
  cmsHTRANSFORM transform = nullptr;

  Handles() = default;
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
  ~Handles() {
    if (transform) cmsDeleteTransform(transform);
    if (context) cmsDeleteContext(context);
  }
};

namespace {

// A damaged profile may claim tables of any size: LittleCMS takes no more at once than this.
constexpr cmsUInt32Number most_icc_bytes = 1u << 26;

void* take_for_icc(cmsContext, cmsUInt32Number size) {
  return size <= most_icc_bytes ? std::malloc(size) : nullptr;
}

void release_for_icc(cmsContext, void* memory) { std::free(memory); }

void* take_more_for_icc(cmsContext, void* memory, cmsUInt32Number size) {
  return size <= most_icc_bytes ? std::realloc(memory, size) : nullptr;
}

cmsPluginMemHandler icc_memory() {
  cmsPluginMemHandler plugin{};
  plugin.base = {cmsPluginMagicNumber, 2060, cmsPluginMemHandlerSig, nullptr};
  plugin.MallocPtr = take_for_icc;
  plugin.FreePtr = release_for_icc;
  plugin.ReallocPtr = take_more_for_icc;
  return plugin;
}

struct CloseProfile {
  void operator()(void* profile) const { cmsCloseProfile(profile); }
};
using Profile = std::unique_ptr<void, CloseProfile>;

/// Linear light of Rec.709's primaries under D65, which LittleCMS adapts by Bradford's transform.
Profile linear_rec709_profile(cmsContext context) {
  const RgbPrimaries rec709 = rec709_primaries();
  const auto xyY = [](const RgbPrimaries::Xy& xy) { return cmsCIExyY{xy[0], xy[1], 1.0}; };
  const cmsCIExyY white = xyY(rec709.white);
  const cmsCIExyYTRIPLE primaries{xyY(rec709.red), xyY(rec709.green), xyY(rec709.blue)};
  cmsToneCurve* const light = cmsBuildGamma(context, 1.0);
  if (!light) return nullptr;
  std::array<cmsToneCurve*, 3> curves = {light, light, light};
  Profile profile(cmsCreateRGBProfileTHR(context, &white, &primaries, curves.data()));
  cmsFreeToneCurve(light);
  return profile;
}

/// "RGB", "CMYK", "Lab" and so on.
std::string name_of_colors(cmsColorSpaceSignature colors) {
  std::string name;
  for (int shift = 24; shift >= 0; shift -= 8) {
    const auto letter = static_cast<char>((static_cast<std::uint32_t>(colors) >> shift) & 255u);
    if (letter > 32 && letter < 127) name += letter;
  }
  return name.empty() ? "unknown colors" : name;
}

bool has_linear_curves(cmsHPROFILE profile, bool is_grey) {
  const auto is_light = [&](cmsTagSignature tag) {
    const auto* curve = static_cast<const cmsToneCurve*>(cmsReadTag(profile, tag));
    return curve && cmsIsToneCurveLinear(curve);
  };
  if (is_grey) return is_light(cmsSigGrayTRCTag);
  return cmsIsMatrixShaper(profile) && is_light(cmsSigRedTRCTag) && is_light(cmsSigGreenTRCTag) &&
         is_light(cmsSigBlueTRCTag);
}

}  // namespace

IccTransform::IccTransform(std::span<const std::byte> profile, bool is_grey)
    : handles_(std::make_unique<Handles>()), is_grey_(is_grey) {
  cmsPluginMemHandler memory = icc_memory();
  handles_->context = cmsCreateContext(&memory, nullptr);
  if (!handles_->context) throw std::bad_alloc();
  cmsSetLogErrorHandlerTHR(handles_->context, [](cmsContext, cmsUInt32Number, const char*) {});
  const Profile from(cmsOpenProfileFromMemTHR(handles_->context, profile.data(),
                                              static_cast<cmsUInt32Number>(profile.size())));
  if (!from) throw InvalidInput("is damaged");
  const cmsProfileClassSignature kind = cmsGetDeviceClass(from.get());
  if (kind == cmsSigLinkClass || kind == cmsSigAbstractClass || kind == cmsSigNamedColorClass)
    throw InvalidInput("is of no device or color space");
  const cmsColorSpaceSignature colors = cmsGetColorSpace(from.get());
  has_grey_profile_ = colors == cmsSigGrayData;
  if (!(colors == cmsSigRgbData || (has_grey_profile_ && is_grey)))
    throw InvalidInput("is of " + name_of_colors(colors) + ", but the pixels are " +
                       (is_grey ? "grey" : "RGB"));
  takes_light_ = has_linear_curves(from.get(), has_grey_profile_);
  const Profile to = linear_rec709_profile(handles_->context);
  if (!to) throw std::bad_alloc();
  handles_->transform = cmsCreateTransformTHR(
      handles_->context, from.get(), has_grey_profile_ ? TYPE_GRAY_FLT : TYPE_RGB_FLT, to.get(),
      TYPE_RGB_FLT, INTENT_RELATIVE_COLORIMETRIC, cmsFLAGS_NOOPTIMIZE | cmsFLAGS_NOCACHE);
  if (!handles_->transform) throw InvalidInput("is damaged");
}

void IccTransform::apply(Image& image) const {
  const std::size_t channels = image.channel_count(), colors = is_grey_ ? 1 : 3;
  const auto width = static_cast<std::size_t>(image.width);
  parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t y) {
    float* const row = image.at(0, static_cast<int>(y));
    std::vector<float> numbers((has_grey_profile_ ? 1 : 3) * width), light(3 * width);
    for (std::size_t x = 0; x < width; ++x)
      for (std::size_t c = 0; c < (has_grey_profile_ ? 1 : 3); ++c)
        numbers[(has_grey_profile_ ? 1 : 3) * x + c] = row[x * channels + (is_grey_ ? 0 : c)];
    cmsDoTransform(handles_->transform, numbers.data(), light.data(),
                   static_cast<cmsUInt32Number>(width));
    for (std::size_t x = 0; x < width; ++x)
      for (std::size_t c = 0; c < colors; ++c)
        row[x * channels + c] = light[3 * x + (is_grey_ ? 1 : c)];
  });
}

#else

struct IccTransform::Handles {};

IccTransform::IccTransform(std::span<const std::byte>, bool) {
  throw InvalidInput(
      "cannot be followed, for which lamina must be built with LittleCMS (Debian: liblcms2-dev)");
}

void IccTransform::apply(Image&) const {}

#endif

IccTransform::~IccTransform() = default;

}  // namespace lamina
