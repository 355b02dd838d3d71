// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/error.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/exchange/medium_fit/half_space_mixture.h"
#include "lamina/exchange/misfit_json.h"

namespace lamina::detail {

ExportedMaterial write_mixture(const ExportInput& input) {
  const HomogeneousFit& fit = *input.fit;
  if (fit.is_thin())
    throw InvalidInput("mixture: the material must be thick, but " + input.material.name +
                       " lets light through");
  const HalfSpaceMixture mixture =
      fit_half_space_mixture(*input.light, fit, input.options.progress);
  ExportedMaterial result{.misfits = mixture.misfits};
  JsonOutput json = head_json(input, "mixture");
  json["meaning"] =
      "Where a path enters, choose medium i with the probability weights[channel] of its channel "
      "(of "
      "several channels at once: by their mean, weighted), and walk in that one medium until the "
      "path "
      "leaves. Coefficients are in 1/mm; times mm_per_unit in inverse scene units.";
  json["g"] = fit.g();
  json["ior"] = fit.ior();
  json["ior_outside"] = fit.ior_above;
  json["roughness"] = fit.top.roughness;
  JsonOutput media = JsonOutput::array();
  for (std::size_t k = 0; k < mixture.media.size(); ++k) {
    std::vector<double> sigma_a, sigma_s, albedos;
    for (const Medium& medium : mixture.media[k]) {
      sigma_a.push_back(medium.sigma_a);
      sigma_s.push_back(medium.sigma_s);
      albedos.push_back(albedo(medium));
    }
    media.push_back({{"weights", mixture.weights[k]},
                     {"sigma_a", sigma_a},
                     {"sigma_s", sigma_s},
                     {"albedo", albedos}});
  }
  json["media"] = std::move(media);
  json["misfit"] = misfit_json(mixture.misfits);
  json["misfit_of_one_medium"] = misfit_json(fit.misfits);
  result.files.push_back({input.stem + "_mixture.json", json.text(1) + "\n"});
  return result;
}

}  // namespace lamina::detail
