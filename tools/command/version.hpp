// The version of the program, as in `hb --version`.
#pragma once

namespace hb::tools {

[[nodiscard]] const char* version();

}  // namespace hb::tools
