#include "tools/output/fit_output.hpp"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "tools/output/scene_report.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double turn = 2 * std::numbers::pi;
// Left over by one mode, of the measurement; and of the frequency, above which the mode is likely another.
constexpr double bad_fit = 0.3, other_mode = 0.2;

std::vector<std::string> fit_warnings(const Measured& measured, const FittedDamping& fitted) {
  std::vector<std::string> warnings;
  const double frequency = fitted.fit.frequency / turn;
  if (!(fitted.fit.residual <= bad_fit))
    warnings.push_back(
        fmt::format("{}: one mode leaves {:.2g} % of the measurement over: more than one vibrates, or it is "
                    "not a {}",
                    measured.file, 100 * fitted.fit.residual, measured.is_peak ? "peak" : "decay"));
  const auto like_scene = [&](double f) { return std::abs(f / fitted.scene_frequency - 1) <= other_mode; };
  if (like_scene(1000 * frequency) || like_scene(frequency / 1000))
    warnings.push_back(
        fmt::format("{}: {:.4g} Hz were measured, 1000 times {} than in the scene: is the file's first "
                    "column in {}? (its first line may say \"{}\")",
                    fitted.rod, frequency, like_scene(1000 * frequency) ? "less" : "more",
                    measured.is_peak ? "another unit" : "ms", measured.is_peak ? "speed [kHz]" : "time [ms]"));
  else if (!like_scene(frequency))
    warnings.push_back(
        fmt::format("{}: {:.4g} Hz were measured, the scene has mode {} at {:.4g} Hz: another mode, or another "
                    "support than pins at both ends?",
                    fitted.rod, frequency, fitted.mode, fitted.scene_frequency));
  return warnings;
}

std::string key_text(const FittedDamping& fitted) {
  return fitted.mode == 1
             ? fmt::format("damping_ratio = {:.4g}", fitted.fit.ratio)
             : fmt::format("damping_ratio = {{ mode = {}, ratio = {:.4g} }}", fitted.mode, fitted.fit.ratio);
}

}  // namespace

double scene_frequency(const Body& link, int mode, const Units& units) {
  return natural_frequencies(link, mode).back() / (turn * units.time_in_s);
}

std::string with_bar(double value, double error) {
  if (!std::isfinite(error)) return fmt::format("{:.4g}, error not known", value);
  return fmt::format("{:.{}g} +/- {:.1g}", value, std::min(8, trusted_digits(value, error)), error);
}

std::string fit_table(const Scene& scene, const Measured& measured, const FittedDamping& fitted) {
  const double frequency = fitted.fit.frequency / turn;
  std::string text =
      fmt::format("{}: damping of {}, mode {}, from {} values of a {} ({})\n", scene_name(scene), fitted.rod,
                  fitted.mode, measured.at.size(), measured.is_peak ? "resonance peak" : "decay", measured.file);
  text += fmt::format("  frequency         {} Hz; the scene has {:.5g} Hz, {:.2g} % {}\n",
                      with_bar(frequency, fitted.fit.frequency_error / turn), fitted.scene_frequency,
                      100 * std::abs(fitted.scene_frequency / frequency - 1),
                      fitted.scene_frequency > frequency ? "higher" : "lower");
  text += fmt::format("  damping ratio     {}\n", with_bar(fitted.fit.ratio, fitted.fit.ratio_error));
  text += fmt::format("  left over         {:.2g} % of the measurement, root of the mean squares\n",
                      100 * fitted.fit.residual);
  text += fmt::format("  in the scene      {} in the elastic table of {}, in place of its damping now\n",
                      key_text(fitted), fitted.rod);
  for (const std::string& warning : fit_warnings(measured, fitted)) text += fmt::format("WARNING: {}\n", warning);
  return text;
}

Json fit_json(const Scene& scene, const Measured& measured, const FittedDamping& fitted) {
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  Json json = {{"title", scene.title},
               {"rod", fitted.rod},
               {"mode", fitted.mode},
               {"measured", measured.is_peak ? "peak" : "decay"},
               {"file", measured.file},
               {"values", measured.at.size()},
               {"frequency", fitted.fit.frequency / turn},
               {"frequency_error", number(fitted.fit.frequency_error / turn)},
               {"scene_frequency", fitted.scene_frequency},
               {"damping_ratio", fitted.fit.ratio},
               {"damping_ratio_error", number(fitted.fit.ratio_error)},
               {"residual", fitted.fit.residual}};
  const std::vector<std::string> warnings = fit_warnings(measured, fitted);
  if (!warnings.empty()) json["warnings"] = warnings;
  return json;
}

CsvFile fit_csv(const Scene& scene, const Measured& measured, const FittedDamping& fitted) {
  CsvFile file;
  file.name = "fit.csv";
  file.comment = {fmt::format("{}: {}, mode {}, measured and fitted", scene_name(scene), fitted.rod, fitted.mode)};
  const std::string quantity = measured.quantity.empty() ? "value" : measured.quantity;
  file.columns = {measured.is_peak ? "frequency [Hz]" : "time [s]", "measured " + quantity, "fitted " + quantity};
  file.rows.resize(measured.at.size(), 3);
  file.rows << (measured.is_peak ? 1 / turn : 1.0) * measured.at, measured.value, fitted.fit.fitted;
  return file;
}

}  // namespace hb::tools
