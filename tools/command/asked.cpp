#include "tools/command/asked.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/command/speed_flags.hpp"

namespace hb::tools {
namespace {

std::variant<int, AutoModes> modes_flag(const std::string& text) {
  if (text == "auto") return AutoModes{};
  return integer_flag("--modes", text, 1, max_modes, fmt::format("an integer 1 to {}, or auto", max_modes));
}

Only only_flag(const std::string& text, bool growth_alone) {
  std::vector<std::string> allowed = {"steady", "stability", "reactions", "shape"};
  if (growth_alone) allowed.insert(allowed.begin() + 2, {"growth", "verdict"});
  const std::vector<std::string> names = list_flag("--only", text);
  for (const std::string& name : names)
    if (std::ranges::find(allowed, name) == allowed.end())
      refuse_flag("--only", name,
                  fmt::format("{}, several joined by commas{}", fmt::join(allowed, ", "), meant(name, allowed)));
  return only_of(names);
}

}  // namespace

std::string in_flags(const RequestError& error) {
  // Other fields (a metric such as stress:AB) are texts of the command line already.
  static const std::map<std::string, std::string> flag_of = {{"rods", "--rods"},
                                                             {"modes", "--modes"},
                                                             {"band", "--band"},
                                                             {"decay", "--decay"},
                                                             {"peak", "--peak"},
                                                             {"tolerance", "--tol"},
                                                             {"rpm", "--rpm"},
                                                             {"omega", "--omega"},
                                                             {"only", "--only"},
                                                             {"vary", "--vary"},
                                                             {"keep", "--keep"},
                                                             {"minimise", "--minimise"},
                                                             {"maximise", "--maximise"},
                                                             {"height", "--height"},
                                                             {"theory", "--theory"},
                                                             {"x", "--x"},
                                                             {"y", "--y"},
                                                             {"damping_range", "--damping-range"},
                                                             {"boundary_tolerance", "--boundary-tol"},
                                                             {"integrator", "--integrator"},
                                                             {"march", "--march"},
                                                             {"case_limit", "--case-limit"}};
  const auto flag = flag_of.find(error.field);
  std::string text = flag == flag_of.end() ? error.field : flag->second;
  if (!text.empty()) text += ": ";
  for (const char c : error.sentence) text += c == '@' ? std::string("--") : std::string(1, c);
  return text;
}

std::vector<Override> overrides(const CommonFlags& flags) {
  std::vector<Override> result;
  for (const std::string& text : flags.set) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      refuse_flag("--set", text, "PATH=VALUE, as in AB.J=60");
    }
    result.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return result;
}

Request asked_request(const CommonFlags& flags, const Scene& scene) {
  Request result;
  if (!flags.modes.empty()) result.modes = modes_flag(flags.modes);
  if (!flags.tolerance.empty())
    result.tolerance = number_flag("--tol", flags.tolerance, 1e-14, 0.1, "a number from 1e-14 to 0.1");
  if (!flags.rods.empty()) result.rods = list_flag("--rods", flags.rods);
  if (!flags.only.empty()) result.only = only_flag(flags.only, flags.growth_alone);
  if (std::holds_alternative<HillSystem>(scene.model) && !result.only.steady && !result.only.stability) {
    refuse_flag("--only", flags.only, "steady, stability: a [hill] scene has no joints and no shape");
  }
  if (!flags.steady_method.empty()) {
    result.steady_method = choice_flag<SteadyMethod>("--steady-method", flags.steady_method,
                                                     {{"automatic", SteadyMethod::automatic},
                                                      {"direct", SteadyMethod::direct},
                                                      {"iterative", SteadyMethod::iterative}});
  }
  if (!flags.bound.empty()) {
    result.bound = choice_flag<SteadyBound>("--bound", flags.bound,
                                            {{"estimated", SteadyBound::estimated}, {"proved", SteadyBound::proved}});
  }
  if (!flags.stability_method.empty()) {
    result.stability_method = choice_flag<StabilityMethod>("--stability-method", flags.stability_method,
                                                           {{"automatic", StabilityMethod::automatic},
                                                            {"hill", StabilityMethod::hill},
                                                            {"slaving", StabilityMethod::slaving},
                                                            {"propagation", StabilityMethod::propagation},
                                                            {"determinant", StabilityMethod::determinant},
                                                            {"bound", StabilityMethod::bound}});
  }
  return result;
}

Settings settings(const CommonFlags& flags, const Scene& scene) {
  return settings_of(asked_request(flags, scene), scene);
}

void set_speed(Request& request, const SpeedRange& speed) {
  (speed.in_rpm ? request.rpm : request.omega) = speed.speeds.from;
}

std::vector<BandRequest> bands_of(const std::vector<std::string>& texts) {
  std::vector<BandRequest> bands;
  for (const std::string& text : texts) bands.push_back(parse_band(text));
  return bands;
}

}  // namespace hb::tools
