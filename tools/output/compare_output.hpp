// Two steady answers side by side, from their documents (steady_json): in units of their own, as two scenes may differ.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/output/csv_output.hpp"

namespace hb::tools {

struct ComparedSide {
  std::string source;  // as given: a scene or a folder
  nlohmann::ordered_json document;
};

struct ComparedQuantity {
  std::string of, name, unit;  // "AB", "deflection", "mm"
  std::optional<double> a, b, error_a, error_b;  // errors absolute, of the computation

  // (b - a)/|a|; empty where one is missing or a is 0.
  [[nodiscard]] std::optional<double> change() const;
  // No further apart than both errors.
  [[nodiscard]] bool same() const;
};

// Factors from the units of a document to mm, N, N m, MPa, Hz, W.
struct ComparedFactors {
  double length = 1, force = 1, moment = 1, stress = 1, frequency = 1, power = 1;
  std::string length_unit, rate_unit;
};

// From the document's units.
[[nodiscard]] ComparedFactors compared_factors(const nlohmann::ordered_json& document);
[[nodiscard]] nlohmann::ordered_json compared_json(const ComparedQuantity& quantity);
// A line of the table without its end.
[[nodiscard]] std::string compared_row(const ComparedQuantity& quantity);

// Lengths in mm, forces in N, moments in N m, stresses in MPa; of a [hill] scene without units.
[[nodiscard]] std::vector<ComparedQuantity> compared_quantities(const ComparedSide& a, const ComparedSide& b);

[[nodiscard]] std::string compare_table(const ComparedSide& a, const ComparedSide& b);
// Those of both sides, a line each; what both have once.
[[nodiscard]] std::string compared_warnings(const ComparedSide& a, const ComparedSide& b);
[[nodiscard]] nlohmann::ordered_json compare_json(const ComparedSide& a, const ComparedSide& b);
// "stable", "UNSTABLE because of AB"; empty where the document has none.
[[nodiscard]] std::string side_verdict(const ComparedSide& side);
// q_1 of both over the turn, one file for each rod that both have.
[[nodiscard]] std::vector<CsvFile> compare_csvs(const ComparedSide& a, const ComparedSide& b);

}  // namespace hb::tools
