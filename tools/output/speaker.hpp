// Who speaks on standard error.
#pragma once

#include <string>

namespace hb::tools {

// "hb steady" once the subcommand is known, "hb" before. Sentences on standard error begin with it and a colon.
[[nodiscard]] const std::string& speaker();
void speak_as(const std::string& subcommand);  // empty: none; before there are threads

}  // namespace hb::tools
