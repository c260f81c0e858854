// --theory and --period: for the subcommands that know the motion without linearisation.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hb::tools {

struct TheoryFlags {
  std::string theory = "linear", period;
};

void add_theory_flags(CLI::App& app, TheoryFlags& flags);

// Throws UsageError for another word, and for a period beside the linear theory.
[[nodiscard]] bool is_nonlinear(const TheoryFlags& flags);
// Turns of --period; 1 where it was not given.
[[nodiscard]] int turns_of(const TheoryFlags& flags);

}  // namespace hb::tools
