// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/diffusion_kernels.h"

#include <algorithm>
#include <cassert>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lamina/solve/scattering/diffusion/diffusion_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>

#ifndef LAMINA_DIFFUSION_KERNELS_TYPES
#define LAMINA_DIFFUSION_KERNELS_TYPES
namespace lamina {

/// A layer as the kernel takes it. Where `table` is set, its response at each k is there: R+, T+,
/// R-, T- one after the other.
struct KernelLayer {
  Multipole layer;
  bool is_half_space;
  const double* table;
};

}  // namespace lamina
#endif

HWY_BEFORE_NAMESPACE();
namespace lamina::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

/// exp(-x) and 1 - exp(-x), both to the last digits.
struct Decay {
  V rest, lost;
};

/// For x >= 0; beyond 230 as at 230, so that products of three do not slow down as subnormals.
/// exp(f) - 1 is its Taylor series for |f| <= ln(2) / 2, whose next term is below 2^-57 of it.
HWY_INLINE Decay decay(V x) {
  const D d;
  const hn::RebindToUnsigned<D> bits;
  const V shifter = hn::Set(d, 0x1.8p52);  // the sum's low bits are the nearest integer
  x = hn::Min(x, hn::Set(d, 230.0));
  const V shifted = hn::NegMulAdd(x, hn::Set(d, 1.4426950408889634), shifter);
  const V n = hn::Sub(shifted, shifter);
  V f = hn::NegMulAdd(n, hn::Set(d, 0x1.62e42fefa3800p-1), hn::Neg(x));  // ln 2 in two parts
  f = hn::NegMulAdd(n, hn::Set(d, 0x1.ef35793c76730p-45), f);
  constexpr double factorials[] = {6227020800.0, 479001600.0, 39916800.0, 3628800.0, 362880.0,
                                   40320.0,      5040.0,      720.0,      120.0,     24.0,
                                   6.0,          2.0,         1.0};
  V series = hn::Zero(d);
  for (const double factorial : factorials)
    series = hn::MulAdd(series, f, hn::Set(d, 1.0 / factorial));
  series = hn::Mul(series, f);
  const V power =
      hn::BitCast(d, hn::ShiftLeft<52>(hn::Add(hn::BitCast(bits, shifted), hn::Set(bits, 1023))));
  return {hn::MulAdd(power, series, power),
          hn::NegMulAdd(power, series, hn::Sub(hn::Set(d, 1.0), power))};
}

struct Response {
  V reflection_above, transmission_down, reflection_below, transmission_up;
};

/// `response` of a layer that is not thin, of multipole.cpp. All parts of 1 - exp are sums of
/// positive terms, 1 - ab = (1 - a) + a (1 - b), so that nothing cancels where s is small.
HWY_INLINE Response point_response(const Multipole& layer, V s) {
  const D d;
  const V one = hn::Set(d, 1.0);
  const auto over = [&](double z) { return hn::Mul(s, hn::Set(d, z)); };
  const Decay up = decay(over(layer.source_depth));                      // source to top
  const Decay down = decay(over(layer.thickness - layer.source_depth));  // source to bottom
  const Decay top = decay(over(2.0 * layer.z_b_top)), bottom = decay(over(2.0 * layer.z_b_bottom));
  const V up2 = hn::Mul(up.rest, up.rest), down2 = hn::Mul(down.rest, down.rest);
  const V up2_lost = hn::MulAdd(up.lost, up.rest, up.lost);
  const V down2_lost = hn::MulAdd(down.lost, down.rest, down.lost);
  const V down_bottom = hn::MulAdd(down2, bottom.lost, down2_lost);
  const V up_top = hn::MulAdd(up2, top.lost, up2_lost);
  const V down_top = hn::MulAdd(down2, top.lost, down2_lost);
  const V up_bottom = hn::MulAdd(up2, bottom.lost, up2_lost);
  const V all = hn::MulAdd(hn::Mul(down2, bottom.rest), up_top, down_bottom);
  const V scale = hn::Div(hn::Set(d, 0.5 * layer.albedo_prime), all);
  const V out_top = hn::Mul(scale, hn::Add(one, top.rest));
  const V out_bottom = hn::Mul(scale, hn::Add(one, bottom.rest));
  return {hn::Mul(hn::Mul(out_top, up.rest), down_bottom),
          hn::Mul(hn::Mul(out_bottom, down.rest), up_top),
          hn::Mul(hn::Mul(out_bottom, up.rest), down_top),
          hn::Mul(hn::Mul(out_top, down.rest), up_bottom)};
}

/// From the ground upward; `size` is a multiple of 8, and so are the distances in tables.
void stack_responses(std::span<const KernelLayer> layers, const LayerResponse& ground,
                     Interreflections interreflections, std::span<const double> k,
                     double* reflection, double* transmission) {
  const D d;
  const V one = hn::Set(d, 1.0);
  for (std::size_t j = 0; j < k.size(); j += hn::Lanes(d)) {
    const V at = hn::LoadU(d, k.data() + j), k2 = hn::Mul(at, at);
    V R = hn::Set(d, ground.reflection_above), T = hn::Set(d, ground.transmission_down);
    for (std::size_t i = layers.size(); i-- > 0;) {
      const auto& [layer, is_half_space, table] = layers[i];
      const V s = hn::Sqrt(hn::Add(k2, hn::Set(d, layer.sigma_tr * layer.sigma_tr)));
      if (is_half_space) {
        const Decay up = decay(hn::Mul(s, hn::Set(d, layer.source_depth)));
        const Decay top = decay(hn::Mul(s, hn::Set(d, 2.0 * layer.z_b_top)));
        const V half = hn::Mul(hn::Set(d, 0.5 * layer.albedo_prime), up.rest);
        R = hn::MulAdd(half, top.rest, half);
        T = hn::Zero(d);
        continue;
      }
      const Response r = table == nullptr
                             ? point_response(layer, s)
                             : Response{hn::LoadU(d, table + j), hn::LoadU(d, table + k.size() + j),
                                        hn::LoadU(d, table + 2 * k.size() + j),
                                        hn::LoadU(d, table + 3 * k.size() + j)};
      const V through =  // down, with the reflections between this layer and what is beneath
          interreflections == Interreflections::none
              ? r.transmission_down
              : hn::Div(r.transmission_down, hn::NegMulAdd(r.reflection_below, R, one));
      R = hn::MulAdd(hn::Mul(through, R), r.transmission_up, r.reflection_above);
      T = hn::Mul(through, T);
    }
    hn::StoreU(R, d, reflection + j);
    hn::StoreU(T, d, transmission + j);
  }
}

}  // namespace lamina::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lamina {
namespace {

constexpr std::size_t widest = 8;  // doubles in the widest vector

std::size_t padded(std::size_t size) { return (size + widest - 1) / widest * widest; }

/// The scalar response at each k, for thin layers.
std::vector<double> response_table(const Multipole& layer, std::span<const double> k) {
  std::vector<double> table(4 * k.size());
  for (std::size_t j = 0; j < k.size(); ++j) {
    const LayerResponse r = response(layer, k[j]);
    table[j] = r.reflection_above;
    table[k.size() + j] = r.transmission_down;
    table[2 * k.size() + j] = r.reflection_below;
    table[3 * k.size() + j] = r.transmission_up;
  }
  return table;
}

}  // namespace

HWY_EXPORT(stack_responses);

StackSpectrum stack_spectrum(const LayeredDiffusion& model, std::span<const double> k) {
  assert(!k.empty());
  std::vector<double> all_k(k.begin(), k.end());
  all_k.resize(padded(k.size()), k.back());
  std::vector<std::vector<double>> tables;
  tables.reserve(model.layers.size());
  std::vector<KernelLayer> layers;
  for (const Multipole& layer : model.layers) {
    const bool is_half_space = layer.thickness == std::numeric_limits<double>::infinity();
    const double* table = nullptr;
    if (!is_half_space && is_thin(layer))
      table = tables.emplace_back(response_table(layer, all_k)).data();
    layers.push_back({layer, is_half_space, table});
  }
  StackSpectrum spectrum{std::vector<double>(all_k.size()), std::vector<double>(all_k.size())};
  HWY_DYNAMIC_DISPATCH(stack_responses)
  (layers, ground_response(model), model.interreflections, all_k, spectrum.reflection_above.data(),
   spectrum.transmission_down.data());
  spectrum.reflection_above.resize(k.size());
  spectrum.transmission_down.resize(k.size());
  return spectrum;
}

}  // namespace lamina
#endif
