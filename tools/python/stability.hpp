// Floquet exponents as Python sees them.
#pragma once

#include <memory>

#include "hb/engine/exponents/stability.hpp"
#include "tools/python/bindings.hpp"

namespace hb::python {

// Part of a result that `owner` keeps alive, or one of its own.
struct StabilityView {
  py::object owner;
  const Stability* stability;
  std::unique_ptr<const Stability> own = {};
  double time_in_s = 1;  // the unit of time
};

}  // namespace hb::python
