#include "tools/command/theory_flags.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <bit>

#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/work/interrupts.hpp"

namespace hb::tools {

void add_theory_flags(CLI::App& app, TheoryFlags& flags) {
  app.add_option("--theory", flags.theory, "linear, or nonlinear: the motion without linearisation, all rods together")
      ->type_name("linear|nonlinear");
  app.add_option("--period", flags.period,
                 "with --theory nonlinear: motions of N turns, which leave the others by period doubling")
      ->type_name("N");
}

bool is_nonlinear(const TheoryFlags& flags) {
  if (flags.theory != "linear" && flags.theory != "nonlinear")
    throw UsageError(fmt::format("--theory: found \"{}\", allowed: linear, nonlinear", flags.theory));
  if (flags.theory == "linear" && !flags.period.empty())
    throw UsageError(
        fmt::format("--period: found {} with the linear theory, allowed: with --theory nonlinear", flags.period));
  return flags.theory == "nonlinear";
}

void add_linear_theory_flag(CLI::App& app, std::string& theory) {
  app.add_option("--theory", theory, "linear, the only one here")->type_name("linear");
}

void require_linear(const std::string& theory, const std::string& why_not) {
  if (theory != "linear")
    throw UsageError(fmt::format("--theory: found \"{}\", allowed: linear ({})", theory, why_not));
}

int turns_of(const TheoryFlags& flags) {
  if (flags.period.empty()) return 1;
  constexpr const char* allowed =
      "1, 2, 4, 8, 16, 32 or 64: motions of more than one turn are found by period doublings";
  const int turns = integer_flag("--period", flags.period, 1, 64, allowed);
  if (!std::has_single_bit(static_cast<unsigned>(turns)))
    throw UsageError(fmt::format("--period: found {}, allowed: {}", flags.period, allowed));
  return turns;
}

std::function<bool()> stop_of() { return time_is_up; }

void say_time_limit(const std::string& limit, const std::function<bool()>& stop, std::vector<std::string>& shortfalls) {
  if (stop()) shortfalls.push_back(fmt::format("ended by --time-limit {} before the answer was complete", limit));
}

}  // namespace hb::tools
