// Floquet exponents as Python sees them.
#pragma once

#include "hb/engine/exponents/stability.hpp"
#include "tools/python/bindings.hpp"

namespace hb::python {

// Part of a result that `owner` keeps alive.
struct StabilityView {
  py::object owner;
  const Stability* stability;
};

}  // namespace hb::python
