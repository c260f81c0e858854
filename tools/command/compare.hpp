// The subcommand of compare.cpp.
#pragma once

namespace CLI {
class App;
}

namespace hb::tools {

void add_compare_command(CLI::App& app, int& status);

}  // namespace hb::tools
