// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "lamina/base/io/json_output.h"

// Nodes of shading networks with their parameters, as the scene files of renderers write them.

namespace lamina::detail {

/// One of a list of names, for files that write its place in it.
struct NodeChoice {
  std::string name;
  int place = 0;  ///< from 0
};

/// A color of three equal channels.
struct NodeGray {
  double value = 0.0;
};

struct NodeParameter {
  std::string name;
  std::variant<bool, double, NodeGray, NodeChoice, std::vector<double>> value;
};

struct ShadingNode {
  std::string type;  ///< "standard_surface", "PxrSurface"
  std::string name;  ///< of letters, digits, _ and -
  std::vector<NodeParameter> parameters;
};

/// "node": its type, then the parameters by their names; gray ones as one number.
[[nodiscard]] JsonOutput node_json(const ShadingNode& node);

/// A node of Arnold's scene files, .ass.
/// Source: [Arnold7], Arnold scene source.
[[nodiscard]] std::string arnold_text(const ShadingNode& node);

/// A Bxdf of RenderMan's RIB.
/// Source: [RISpec], binding of RIB: a type and a name, then the values in brackets.
[[nodiscard]] std::string rib_text(const ShadingNode& node);

}  // namespace lamina::detail
