// What the subcommands of `hb` share: exit codes, errors and their registration.
#pragma once

#include "tools/work/errors.hpp"

namespace CLI {
class App;
}

namespace hb::tools {

enum ExitCode {
  exit_ok = 0,
  exit_failed = 1,  // `hb check` found a disagreement, or an internal error
  exit_wrong_input = 2,  // scene, flags or output folder
  exit_not_reached = 3,  // a result, marked: the tolerance was not reached
  exit_no_pictures = 4,  // data complete, pictures missing
};

// Each adds one subcommand; running it stores the exit code in `status`, which outlives the parse.
void add_new_command(CLI::App& app, int& status);
void add_scene_command(CLI::App& app, int& status);
void add_steady_command(CLI::App& app, int& status);
void add_sweep_command(CLI::App& app, int& status);
void add_map_command(CLI::App& app, int& status);
void add_check_command(CLI::App& app, int& status);
void add_bench_command(CLI::App& app, int& status);
void add_tune_command(CLI::App& app, int& status);
void add_report_command(CLI::App& app, int& status);
void add_fit_command(CLI::App& app, int& status);

}  // namespace hb::tools
