// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace lamina {

/// The rows of a CSV file of the optional reference data, without comments and header; empty if
/// there is no such file. Fields without a number are 0.
inline std::vector<std::vector<double>> shared_table(const std::string& name) {
  std::ifstream stream(std::string(LAMINA_SHARED_DATA) + "/" + name);
  std::vector<std::vector<double>> rows;
  bool has_header = false;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with('#')) continue;
    if (!has_header) {
      has_header = true;
      continue;
    }
    std::vector<double>& row = rows.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');)
      row.push_back(field.empty() ? 0.0 : std::stod(field));
  }
  return rows;
}

/// Linear interpolation of the column of a table, whose first column ascends.
inline double interpolate_column(const std::vector<std::vector<double>>& rows, double x,
                                 std::size_t column) {
  std::size_t i = 1;
  while (i + 1 < rows.size() && rows[i][0] < x) ++i;
  const double t = (x - rows[i - 1][0]) / (rows[i][0] - rows[i - 1][0]);
  return (1.0 - t) * rows[i - 1][column] + t * rows[i][column];
}

}  // namespace lamina
