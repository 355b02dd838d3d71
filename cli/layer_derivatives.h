// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "console.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/layer_derivatives.h"

// How derivatives by what layers are made of are written, for whatever they are of.

namespace lamina::cli {

/// The derivatives of one number by one quantity of a layer; or a list of them.
using DerivativeJson =
    std::function<JsonOutput(std::size_t layer, double LayerDerivatives::*derivative)>;

/// [by what][layer], of each what `value` says.
[[nodiscard]] JsonOutput layer_derivatives_json(std::size_t layers, const DerivativeJson& value);

/// A number in one band, and its derivatives, [layer].
struct DifferentiatedNumber {
  double value = 0.0;
  const std::vector<LayerDerivatives>* derivatives = nullptr;
};

/// A row for each quantity of each layer: what one percent more of it changes, in percent of the
/// number, [band]. Rows without any change are left out, all of them if the number is 0.
[[nodiscard]] std::string layer_derivatives_text(const std::string& name, const Material& material,
                                                 const std::vector<LayerStack>& stacks,
                                                 const std::vector<DifferentiatedNumber>& bands);

/// The head of such rows, at the start of a line.
[[nodiscard]] std::string layer_derivatives_head(const std::string& of_what,
                                                 const Material& material);

}  // namespace lamina::cli
