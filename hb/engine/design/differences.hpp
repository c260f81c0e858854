// First derivatives by differences.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace hb {

using OptionalVector = std::optional<Eigen::VectorXd>;

// df_r/dx_i at x: central differences, one-sided (of second order too) where a bound is nearer than the step. Error
// about step^2, and the noise of f over the step. Empty where f is empty or not finite at a point needed.
[[nodiscard]] std::optional<Eigen::MatrixXd> difference_jacobian(
    const std::function<OptionalVector(const Eigen::VectorXd& x)>& f, const Eigen::VectorXd& x,
    const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, const Eigen::VectorXd& step);

}  // namespace hb
