#include "hb/engine/exponents/rough_growth.hpp"

#include <cmath>

#include "hb/engine/exponents/radau_turn.hpp"
#include "hb/engine/exponents/small_matrix.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;

double rough_growth(const PeriodicCoefficients& of, Index num_cells) {
  const TurnMaps maps = radau_turn(of.alpha, of.beta, of.num_modes, num_cells);
  MatrixXd product = maps.cells.leftCols(maps.num_states()), next;
  double log_size = 0;
  for (Index i = 1; i < num_cells; ++i) {
    multiply_columns(maps.cells, maps.num_states() * i, product, next);
    const double size = next.cwiseAbs().maxCoeff();
    product = next / size;
    log_size += std::log(size);
  }
  return (std::log(dense::eigenvalues(product).cwiseAbs().maxCoeff()) + log_size) / two_pi;
}

}  // namespace hb
