#include "tools/command/theory_flags.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>

#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"

namespace hb::tools {

void add_theory_flags(CLI::App& app, TheoryFlags& flags) {
  app.add_option("--theory", flags.theory, "linear, or nonlinear: the motion without linearisation, all rods together")
      ->type_name("linear|nonlinear");
  app.add_option("--period", flags.period,
                 "with --theory nonlinear: motions of N turns, which leave the others by period doubling")
      ->type_name("N");
  app.add_option("--time-limit", flags.time_limit,
                 "with --theory nonlinear: the command ends after so many seconds with what is there (status 3)")
      ->type_name("SECONDS");
}

bool is_nonlinear(const TheoryFlags& flags) {
  if (flags.theory != "linear" && flags.theory != "nonlinear")
    throw UsageError(fmt::format("--theory: found \"{}\", allowed: linear, nonlinear", flags.theory));
  if (flags.theory == "linear" && !flags.period.empty())
    throw UsageError(
        fmt::format("--period: found {} with the linear theory, allowed: with --theory nonlinear", flags.period));
  if (flags.theory == "linear" && !flags.time_limit.empty())
    throw UsageError(fmt::format("--time-limit: found {} with the linear theory, allowed: with --theory nonlinear",
                                 flags.time_limit));
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
  return integer_flag("--period", flags.period, 1, 64, "a whole number of turns from 1 to 64");
}

std::function<bool()> stop_of(const TheoryFlags& flags) {
  if (flags.time_limit.empty()) return {};
  const double seconds = number_flag("--time-limit", flags.time_limit, 1e-3, 1e6, "seconds from 0.001 to 1000000");
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  return [end] { return std::chrono::steady_clock::now() >= end; };
}

void say_time_limit(const TheoryFlags& flags, const std::function<bool()>& stop,
                    std::vector<std::string>& shortfalls) {
  if (stop && stop()) shortfalls.push_back(fmt::format("ended by --time-limit {}", flags.time_limit));
}

}  // namespace hb::tools
