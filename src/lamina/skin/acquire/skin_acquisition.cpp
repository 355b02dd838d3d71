// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/skin_acquisition.h"

#include <string>
#include <utility>
#include <vector>

#include "lamina/skin/lookup/skin_lookup.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"

namespace lamina {

AcquisitionPlan plan_acquisition(Capture& capture, LateralLight lateral) {
  const bool is_texture = capture.reflectance.channels == std::vector<std::string>{"R", "G", "B"} &&
                          capture.lights.empty();
  AcquisitionPlan plan;
  plan.has_transport = lateral == LateralLight::automatic ? capture.mm_per_pixel && !is_texture
                                                          : lateral == LateralLight::transport;
  plan.has_table = !plan.has_transport && capture.population && capture.lights.empty() &&
                   capture.reflectance.channel_count() == 3;
  if (!plan.has_table && !capture.has_stated_numbers)
    std::erase_if(capture.numbers, [](const SkinFitNumber& number) {
      return number.parameter.name.ends_with("_scale") || number.parameter.name == "saturation";
    });
  return plan;
}

SkinAcquisition acquire_skin(const Capture& capture, const AcquisitionPlan& plan,
                             PatchAcquisitionOptions options, const std::optional<DiskCache>& cache,
                             const Progress& progress) {
  const auto made = table_of(capture, part_of(progress, 0.0, 0.1));
  const SkinReflectanceTable& table = *made;
  SkinAcquisition result;
  if (plan.has_table) {
    const std::vector<BandMisfit> misfit = misfit_of_pixels(capture, table);
    const std::vector<double> growth = error_growth_of(misfit);
    result.skin =
        acquire_pixels(capture, lookup_of(capture, table, growth, part_of(progress, 0.1, 0.7)),
                       part_of(progress, 0.7, 0.9));
    result.skin.chi_squared = chi_squared_of(misfit);
    result.skin.error_growth = growth;
  } else {
    options.has_transport = plan.has_transport;
    options.table = made;
    result.skin = acquire_patch(capture, options, cache, part_of(progress, 0.1, 0.9));
  }
  // Not asked to stop: the best so far is kept.
  result.check = check_acquisition(capture, result.skin, table);
  add_gain_errors(capture, result.check, result.skin);
  result.notes = notes_of_misfit(capture, result.skin, result.check);
  return result;
}

}  // namespace lamina
