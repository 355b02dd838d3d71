// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "base/image/icc_profiles.h"

#include <lcms2.h>

namespace lamina {
namespace {

constexpr cmsCIExyY d65{0.3127, 0.3290, 1.0};

std::vector<std::byte> taken(cmsHPROFILE profile) {
  cmsUInt32Number size = 0;
  cmsSaveProfileToMem(profile, nullptr, &size);
  std::vector<std::byte> bytes(size);
  cmsSaveProfileToMem(profile, bytes.data(), &size);
  cmsCloseProfile(profile);
  return bytes;
}

cmsToneCurve* curve_of(double exponent) {
  // Source: IEC 61966-2-1
  const std::array<cmsFloat64Number, 5> srgb = {2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92,
                                                0.04045};
  return exponent > 0.0 ? cmsBuildGamma(nullptr, exponent)
                        : cmsBuildParametricToneCurve(nullptr, 4, srgb.data());
}

struct TableTransform {
  cmsHTRANSFORM transform;
};

cmsInt32Number sample(const cmsUInt16Number in[], cmsUInt16Number out[], void* user) {
  cmsDoTransform(static_cast<TableTransform*>(user)->transform, in, out, 1);
  return 1;
}

}  // namespace

std::vector<std::byte> rgb_profile(const std::array<double, 6>& xy, double exponent) {
  const cmsCIExyYTRIPLE primaries{{xy[0], xy[1], 1.0}, {xy[2], xy[3], 1.0}, {xy[4], xy[5], 1.0}};
  cmsToneCurve* const curve = curve_of(exponent);
  std::array<cmsToneCurve*, 3> curves = {curve, curve, curve};
  cmsHPROFILE profile = cmsCreateRGBProfile(&d65, &primaries, curves.data());
  cmsFreeToneCurve(curve);
  return taken(profile);
}

std::vector<std::byte> p3_profile(double exponent) {
  return rgb_profile({0.680, 0.320, 0.265, 0.690, 0.150, 0.060}, exponent);
}

std::vector<std::byte> grey_profile(double exponent) {
  cmsToneCurve* const curve = curve_of(exponent);
  cmsHPROFILE profile = cmsCreateGrayProfile(cmsD50_xyY(), curve);
  cmsFreeToneCurve(curve);
  return taken(profile);
}

std::vector<std::byte> lab_profile() { return taken(cmsCreateLab4Profile(nullptr)); }

std::vector<std::byte> table_profile(const std::vector<std::byte>& like) {
  cmsHPROFILE from = cmsOpenProfileFromMem(like.data(), static_cast<cmsUInt32Number>(like.size()));
  cmsHPROFILE lab = cmsCreateLab4Profile(nullptr);
  TableTransform table{cmsCreateTransform(from, TYPE_RGB_16, lab, TYPE_Lab_16,
                                          INTENT_RELATIVE_COLORIMETRIC, cmsFLAGS_NOOPTIMIZE)};
  cmsHPROFILE profile = cmsCreateProfilePlaceholder(nullptr);
  cmsSetProfileVersion(profile, 4.3);
  cmsSetDeviceClass(profile, cmsSigInputClass);
  cmsSetColorSpace(profile, cmsSigRgbData);
  cmsSetPCS(profile, cmsSigLabData);
  cmsWriteTag(profile, cmsSigMediaWhitePointTag, cmsD50_XYZ());
  cmsPipeline* pipeline = cmsPipelineAlloc(nullptr, 3, 3);
  cmsStage* stage = cmsStageAllocCLut16bit(nullptr, 33, 3, 3, nullptr);
  cmsStageSampleCLut16bit(stage, sample, &table, 0);
  cmsPipelineInsertStage(pipeline, cmsAT_END, cmsStageAllocToneCurves(nullptr, 3, nullptr));
  cmsPipelineInsertStage(pipeline, cmsAT_END, stage);
  cmsPipelineInsertStage(pipeline, cmsAT_END, cmsStageAllocToneCurves(nullptr, 3, nullptr));
  cmsWriteTag(profile, cmsSigAToB0Tag, pipeline);
  cmsWriteTag(profile, cmsSigAToB1Tag, pipeline);
  cmsPipelineFree(pipeline);
  cmsDeleteTransform(table.transform);
  cmsCloseProfile(lab);
  cmsCloseProfile(from);
  return taken(profile);
}

}  // namespace lamina
