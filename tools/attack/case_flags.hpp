// Flags that say which random cases an attack takes and for how long.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace hb::attack {

// --cases, --seed, and of --first, --seconds and --verbose those that `options` has members for.
template <class Options>
void add_case_flags(CLI::App& app, Options& options, const std::string& cases, const std::string& verbose = "") {
  app.add_option("--cases", options.cases, cases);
  app.add_option("--seed", options.seed, "which cases");
  if constexpr (requires { options.first; }) app.add_option("--first", options.first, "number of the first case");
  if constexpr (requires { options.seconds; }) app.add_option("--seconds", options.seconds, "stop after");
  if constexpr (requires { options.verbose; }) app.add_flag("--verbose", options.verbose, verbose);
}

}  // namespace hb::attack
