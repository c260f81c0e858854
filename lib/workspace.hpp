// Memory that a thread keeps for one place of the code, `thread_local Workspace kept;`: work that is done again and
// again, as at every speed of a sweep, takes it from the system once. The numbers are those of whoever asked last.
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace hb {

class Workspace {
 public:
  // Not initialised. More than 8 MB are given back when less is asked for.
  Eigen::Map<Eigen::MatrixXd> matrix(Eigen::Index rows, Eigen::Index columns) {
    constexpr Eigen::Index most_kept = 1 << 20;
    const Eigen::Index size = rows * columns;
    if (size > block_.size() || (block_.size() > most_kept && size <= most_kept)) block_.resize(size);
    return {block_.data(), rows, columns};
  }

 private:
  Eigen::VectorXd block_;
};

}  // namespace hb
