// The largest value of a function over an interval: found from samples, then by bounded search around every sample that
// may belong to it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace hb {

struct WorstCase {
  double x = 0;
  double value = 0;  // NaN if the function is NaN anywhere that was looked at
};

struct WorstCaseOptions {
  double tolerance = 1e-7;  // of x, relative: about its square in the value where that is smooth
  // Local maxima among the samples lower than this part of the way from the smallest to the largest are left out.
  double contest = 0.5;
};

// `x` ascending, at least one; `values` are f(x). A peak narrower than the distance of its neighbours is found if a
// sample stands on its slope.
[[nodiscard]] WorstCase worst_case(const std::function<double(double)>& f, const std::vector<double>& x,
                                   const std::vector<double>& values, const WorstCaseOptions& options = {});

// The local maximum over a box of several variables that begins at `x` (BOBYQA of NLopt), from two variables on; `x`
// itself where nothing larger is found. f: NaN or -infinity where it does not exist.
struct WorstPoint {
  Eigen::VectorXd x;
  double value = 0;
};
[[nodiscard]] WorstPoint worst_point(const std::function<double(const Eigen::VectorXd&)>& f, const Eigen::VectorXd& x,
                                     const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

}  // namespace hb
