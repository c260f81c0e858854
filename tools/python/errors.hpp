// From the errors of the library and of the command to the exceptions of the package (hb/errors.py): see errors.cpp.
#pragma once

#include <string>

#include "tools/python/bindings.hpp"

namespace hb::python {

// A word of the command line as the name of an argument: "--tol" as "tol".
[[nodiscard]] std::string as_argument(std::string text);

}  // namespace hb::python
