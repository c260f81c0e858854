// Growth between places where the leading exponents are a pair apart from all others, by interpolation of what is
// analytic there whether the two are locked or not: their mean growth and the half trace of their map over a turn.
// hb/engine/README.md, (B11).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "hb/engine/boundaries/growth_model.hpp"
#include "hb/engine/boundaries/leading_pair.hpp"

namespace hb {

struct PairNode {
  double x = 0;
  LeadingPair pair;
  // Turns by which the pair's exponents may have moved since the first node, as a coordinate along x.
  double turned = 0;
};

class PairModel {
 public:
  // Between x of the first two nodes; up to four more beside them, nearest first. Three or more bound anything.
  explicit PairModel(std::vector<PairNode> nodes);

  // Growth of the two at x, an estimate: the error is three times the last term of the interpolation, or 3/4 of the one
  // before, and that of the nodes; of the half trace the remainder of a cosine of as many turns at least.
  GrowthBounds leading(double x) const;
  // Besides, what the growth of the one that decays faster is at least.
  struct Bounds {
    GrowthBounds leading;
    double lowest;
  };
  Bounds bounds(double x) const;
  // Of either without errors.
  double predicted(double x) const;
  double lower(double x) const;
  // Where growth may be largest or smallest between the first two nodes: dense beside them, where the interpolation's
  // error vanishes with the distance, and where the half trace turns round or passes zero.
  std::vector<double> telling() const;

 private:
  struct Value {
    double value, error;
  };
  struct Values {
    Value mean, half_trace;
  };
  using Both = Eigen::Array2d;  // of mean growth and half trace
  // Newton's divided differences.
  std::vector<Both> terms() const;
  Values at(double x) const;
  Values bounded_at(double x) const;

  std::vector<PairNode> nodes_;
  std::vector<Both> terms_;
  double mean_error_ = 0, half_trace_error_ = 0, largest_ = 1;
};

}  // namespace hb
