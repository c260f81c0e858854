#include "tools/command/version.hpp"

namespace hb::tools {

const char* version() { return HB_VERSION; }

}  // namespace hb::tools
