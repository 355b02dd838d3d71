// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/diffusion_kernels.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "lamina/solve/scattering/profile/hankel.h"
#include "lamina/solve/scattering/profile/internal/correlation_kernel.h"
#include "literal/diffusion_skin.h"

namespace lamina {
namespace {

/// Runs once for each instruction set of this processor.
void on_each_target(const std::function<void()>& test) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    test();
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(DiffusionKernels, SpectrumOfAStackIsItsResponseAtEachFrequency) {
  std::vector<LayerStack> stacks = reference::donner_jensen_skin();
  const auto layer = [](double sigma_a, double sigma_s, double ior, double thickness) {
    return Layer{.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .ior = ior},
                 .thickness = thickness};
  };
  stacks.push_back(LayerStack({layer(0.0, 3.0, 1.4, 2.0)}, 1.0, 1.3));
  stacks.push_back(LayerStack({layer(0.1, 3.0, 1.4, 0.2), layer(0.0, 9.0, 1.5, 4.0)}));  // thin top
  stacks.push_back(LayerStack({layer(0.1, 3.0, 1.4, 0.2)}));
  stacks.push_back(LayerStack({layer(0.5, 30.0, 1.4, 1.0)}, 1.0, 1.0, {.reflectance = 0.7}));
  stacks.push_back(LayerStack({layer(50.0, 1.0, 1.4, 10.0)}));
  std::vector<double> frequencies;
  for (int i = 0; i < 101; ++i) frequencies.push_back(std::pow(10.0, -6.0 + 0.1 * i));
  std::vector<std::pair<LayerStack, Interreflections>> cases;
  for (const LayerStack& stack : stacks)
    for (const auto& each : enum_names<Interreflections>) cases.emplace_back(stack, each.value);
  on_each_target([&] {
    for (const auto& [stack, interreflections] : cases) {
      const LayeredDiffusion model =
          make_layered_diffusion(stack, {.interreflections = interreflections});
      const StackSpectrum spectrum = stack_spectrum(model, frequencies);
      ASSERT_EQ(spectrum.reflection_above.size(), frequencies.size());
      for (std::size_t j = 0; j < frequencies.size(); ++j) {
        const LayerResponse exact = response(model, frequencies[j]);
        // Rounding of the exponents costs x exp(-x) * 2^-53 each.
        EXPECT_NEAR(spectrum.reflection_above[j], exact.reflection_above,
                    1e-14 * exact.reflection_above + 1e-15);
        EXPECT_NEAR(spectrum.transmission_down[j], exact.transmission_down,
                    1e-14 * exact.transmission_down + 1e-15);
      }
    }
  });
}

TEST(DiffusionKernels, SmallFrequenciesWithoutAbsorptionKeepTheirDigits) {
  const LayerStack slab({{.medium = {.sigma_s = 3.0, .ior = 1.4}, .thickness = 2.0}});
  const LayeredDiffusion model = make_layered_diffusion(slab);
  on_each_target([&] {
    for (const double k : {1e-14, 1e-9, 1e-5}) {
      const StackSpectrum spectrum = stack_spectrum(model, std::vector{k});
      EXPECT_NEAR(spectrum.reflection_above[0] + spectrum.transmission_down[0], 1.0, 1e-8);
      EXPECT_NEAR(spectrum.transmission_down[0], response(model, k).transmission_down, 1e-14);
    }
  });
}

TEST(DiffusionKernels, CorrelationIsTheSumOfProducts) {
  std::vector<double> kernel, rows;
  for (int i = 0; i < 57; ++i) kernel.push_back(std::sin(1.0 + i));
  constexpr std::size_t channels = 5, k_size = 9, r_size = 7, r_stride = 3, k_stride = 5;
  for (std::size_t i = 0; i < k_size * channels; ++i)
    rows.push_back(std::cos(static_cast<double>(i)));
  on_each_target([&] {
    const auto sums = detail::correlate(kernel, r_stride, k_stride, rows, channels, r_size);
    ASSERT_EQ(sums.size(), r_size * channels);
    for (std::size_t i = 0; i < r_size; ++i)
      for (std::size_t c = 0; c < channels; ++c) {
        double sum = 0.0;
        for (std::size_t j = 0; j < k_size; ++j)
          if (i * r_stride + j * k_stride < kernel.size())
            sum += kernel[i * r_stride + j * k_stride] * rows[j * channels + c];
        EXPECT_NEAR(sums[i * channels + c], sum, 1e-14);
      }
  });
}

}  // namespace
}  // namespace lamina
