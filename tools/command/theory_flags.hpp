// --theory, --period and --time-limit: for the subcommands that know the motion without linearisation.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hb::tools {

struct TheoryFlags {
  std::string theory = "linear", period, time_limit;
};

void add_theory_flags(CLI::App& app, TheoryFlags& flags);

// Throws UsageError for another word, and for a period or time limit beside the linear theory.
[[nodiscard]] bool is_nonlinear(const TheoryFlags& flags);
// --theory where the linear theory is the only one; `why_not` ends the refusal of the other.
void add_linear_theory_flag(CLI::App& app, std::string& theory);
void require_linear(const std::string& theory, const std::string& why_not);

// Turns of --period; 1 where it was not given.
[[nodiscard]] int turns_of(const TheoryFlags& flags);
// True once the seconds of --time-limit have passed since this call; empty where it was not given.
[[nodiscard]] std::function<bool()> stop_of(const TheoryFlags& flags);
// "--time-limit ended ..." where `stop` has come true.
void say_time_limit(const TheoryFlags& flags, const std::function<bool()>& stop, std::vector<std::string>& shortfalls);

}  // namespace hb::tools
