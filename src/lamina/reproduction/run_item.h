// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/reproduction/item.h"

namespace lamina {

enum class Verdict {
  agrees,           ///< all numbers and features do, and there are numbers
  agrees_in_shape,  ///< all features do
  differs,
  not_made,  ///< what it needs is not there
};

template <>
inline constexpr auto enum_names<Verdict> =
    std::to_array<EnumName<Verdict>>({{"agrees", Verdict::agrees},
                                      {"agrees_in_shape", Verdict::agrees_in_shape},
                                      {"differs", Verdict::differs},
                                      {"not_made", Verdict::not_made}});

struct CheckedNumber {
  double value = 0.0;
  bool holds = false;
};

struct CheckedFeature {
  bool holds = false;
  std::optional<double> measure;
};

/// Results of an item.
struct ReproductionResult {
  ReproductionItem item;
  Verdict verdict = Verdict::not_made;
  std::string why_not_made;
  std::vector<CheckedNumber> numbers;           ///< [item.numbers]
  std::vector<CheckedFeature> features;         ///< [item.features]
  Plot plot;                                    ///< without panels if the item has none
  std::vector<std::vector<std::string>> cells;  ///< [item.table.rows][column], with names of rows
  std::filesystem::path folder;                 ///< where the runs have left their files
  double seconds = 0.0;
};

/// Items were not made, or are worse than they were; what was made is kept.
class ReproductionFailed : public Error {
 public:
  using Error::Error;
};

/// How the verdict follows from the checks. An item whose numbers miss and whose features hold
/// agrees in shape.
[[nodiscard]] Verdict judge(const ReproductionResult& result);

/// Runs lamina with arguments in a folder, outside of which it may not write, by
/// LAMINA_WRITE_FOLDER; its result as JSON text.
/// @throws Error with what it says if it fails.
using RunLamina = std::function<std::string(const std::vector<std::string>& arguments,
                                            const std::filesystem::path& folder)>;

/// Makes an item: writes its files, runs its commands, draws and judges. `{sources}` in commands is
/// the folder of lamina's sources, where what an item needs is looked for.
///
/// @param folder  of its own, made here; its pictures and numbers.csv stay there
/// @throws InvalidInput naming the item where a command or an expression of it is wrong; whatever
///         `run` throws; WriteError.
[[nodiscard]] ReproductionResult make_reproduction(const ReproductionItem& item,
                                                   const std::filesystem::path& folder,
                                                   const std::filesystem::path& sources,
                                                   const RunLamina& run);

}  // namespace lamina
