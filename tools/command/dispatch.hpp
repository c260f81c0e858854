// The command line as a whole: the subcommands, and the sentences and exit codes that exceptions become.
#pragma once

#include <string>

namespace hb::tools {

// "hb steady: WHAT" on standard error, see speaker.hpp; gives `status`.
int say(int status, const std::string& what);

// The exit code of the subcommand, or that of what is wrong.
[[nodiscard]] int run(int argc, char** argv);

}  // namespace hb::tools
