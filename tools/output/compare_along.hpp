// Two sweeps side by side, from their documents (sweep_json): over the range that both have.
#pragma once

#include "tools/output/compare_output.hpp"

namespace hb::tools {

// Of a sweep, and not of one speed.
[[nodiscard]] bool is_along(const ComparedSide& side);
// Throws UsageError where they go along different numbers, or have no range in common.
void require_comparable(const ComparedSide& a, const ComparedSide& b);

// The largest, or of a safety the smallest, of the points of each side, and where.
struct ComparedAlong {
  ComparedQuantity quantity;
  std::optional<double> at_a, at_b;
};
[[nodiscard]] std::vector<ComparedAlong> compared_along(const ComparedSide& a, const ComparedSide& b);

[[nodiscard]] std::string compare_along_table(const ComparedSide& a, const ComparedSide& b);
[[nodiscard]] nlohmann::ordered_json compare_along_json(const ComparedSide& a, const ComparedSide& b);
// "UNSTABLE at 12 of 291 points because of AB", "stable"; empty where the document has none.
[[nodiscard]] std::string along_verdict(const ComparedSide& side);
// "crank speed [rpm]", "AB.J".
[[nodiscard]] std::string along_label(const ComparedSide& side);

// Curves of one side, ascending: of a rod deflection, growth rate and stress; of the machine largest bearing force,
// shaking force and rms torque.
struct AlongCurves {
  std::string name;  // of the rod; "machine"
  std::vector<std::string> labels;  // of columns 2, 3, ...
  CsvFile a, b;
};
[[nodiscard]] std::vector<AlongCurves> along_curves(const ComparedSide& a, const ComparedSide& b);

}  // namespace hb::tools
