#include "tools/command/sweep_flags.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "hb/analysis/along.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/work/interrupts.hpp"

namespace hb::tools {

void add_sweep_flags(CLI::App& command, SweepFlags& flags) {
  add_scene_flags(command, flags);
  add_analysis_flags(command, flags);
  allow_growth_alone(command, flags);
  command.add_flag("--no-search", flags.no_search, "the points alone: no bands, boundaries or peaks between them");
  add_band_flag(command, flags.bands);
  flags.label_axes = "x";
  add_html_flag(command, flags);
  command
      .add_option("--x", flags.x,
                  "sweep this scene number instead of the speed, as in AB.J=30:60:1 or AB.J=30:60:x31 (31 points)")
      ->type_name("PATH=A:B:STEP|A:B:xN");
  add_theory_flags(command, flags.theory);
  command
      .add_option("--start", flags.start,
                  "with --theory nonlinear: follow branches from this motion as well, a steady.json of hb steady")
      ->type_name("FILE");
  add_measured_flag(command, flags.measured, "along what is swept");
  command.add_flag("--resume", flags.resume, "go on where an interrupted run into the same --out stopped");
  command.add_flag("--restart", flags.restart, "throw away what an interrupted run into the same --out left");
}

std::vector<BandRequest> bands_of(const std::vector<std::string>& texts, const TheoryFlags& theory) {
  if (!texts.empty() && is_nonlinear(theory))
    throw UsageError(
        "--band: found beside --theory nonlinear, allowed with the linear theory, and with hb steady; or run again "
        "with "
        "--set");
  return bands_of(texts);
}

std::optional<NonlinearSweepOptions> branches_of(const SweepFlags& flags) {
  const bool nonlinear = is_nonlinear(flags.theory);
  NonlinearSweepOptions asked;
  asked.turns = turns_of(flags.theory);
  asked.stop = early_end(flags.out.has_value());
  if (!nonlinear && !flags.start.empty())
    throw UsageError(
        fmt::format("--start: found {} with the linear theory, allowed: with --theory nonlinear", flags.start.front()));
  return nonlinear ? std::optional(asked) : std::nullopt;
}

}  // namespace hb::tools
