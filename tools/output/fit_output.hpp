// Damping fitted to a measurement: table, document, CSV.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "hb/analysis/damping_fit.hpp"
#include "lib/scene/scene.hpp"
#include "tools/output/csv_output.hpp"

namespace hb::tools {

struct Measured {
  bool is_peak = false;  // else a decay
  std::string file, quantity;  // quantity: name of the column with its unit, or nothing
  Eigen::VectorXd at, value;  // times in s, or frequencies in rad/s
};

struct FittedDamping {
  std::string rod;
  int mode = 1;
  double scene_frequency = 0;  // Hz, of that mode at rest by the scene
  DampingFit fit;  // per s
};

[[nodiscard]] double scene_frequency(const Body& link, int mode, const Units& units);
// "0.0123 +/- 0.0004": digits as the standard error leaves.
[[nodiscard]] std::string with_bar(double value, double error);

[[nodiscard]] std::string fit_table(const Scene& scene, const Measured& measured, const FittedDamping& fitted);
[[nodiscard]] nlohmann::ordered_json fit_json(const Scene& scene, const Measured& measured,
                                              const FittedDamping& fitted);
// Place, measured, fitted.
[[nodiscard]] CsvFile fit_csv(const Scene& scene, const Measured& measured, const FittedDamping& fitted);

}  // namespace hb::tools
