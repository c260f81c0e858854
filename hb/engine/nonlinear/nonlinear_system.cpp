#include "hb/engine/nonlinear/nonlinear_system.hpp"

#include <stdexcept>

namespace hb {

void validate(const NonlinearSystem& system) {
  if (system.num_unknowns < 1) throw std::invalid_argument("NonlinearSystem: num_unknowns must be at least 1");
  if (!system.speed) throw std::invalid_argument("NonlinearSystem: no function for the speed");
  if (!system.evaluate) throw std::invalid_argument("NonlinearSystem: no function for the residual");
}

}  // namespace hb
