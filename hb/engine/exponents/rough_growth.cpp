#include "hb/engine/exponents/rough_growth.hpp"

#include <cmath>

#include "hb/engine/exponents/cell_chain.hpp"
#include "hb/engine/exponents/radau_turn.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"

namespace hb {

using Eigen::Index;

double rough_growth(const PeriodicCoefficients& of, Index num_cells) {
  const TurnMaps maps = rough_radau_turn(of.alpha, of.beta, of.num_modes, num_cells);
  const SizedProduct product = sized_product(maps.cells);
  return (std::log(dense::eigenvalues(product.M).cwiseAbs().maxCoeff()) + product.log_size) / two_pi;
}

}  // namespace hb
