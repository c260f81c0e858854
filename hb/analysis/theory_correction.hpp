// What the linear model leaves out at a motion, by the exact one, and what the linear rods answer to it: (T1),
// README.md here.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "hb/analysis/theory_error.hpp"
#include "hb/engine/steady/rough_state.hpp"

namespace hb {

struct Corrections {
  std::vector<FourierSeries> dq;  // of each rod
  std::optional<ExactBreakdown> breakdown;
  std::optional<std::size_t> singular;  // this rod has no periodic solution
};

// Of all rods at one speed; what corrections share is kept from one to the next.
class TheoryCorrection {
 public:
  // Model and rods stay where they are. `tolerance` is the smallest that is asked for.
  TheoryCorrection(const ExactModel& model, double speed, std::span<const LinearRod> rods, double tolerance);

  const ExactModel& model() const { return model_; }
  double speed() const { return speed_; }
  std::span<const LinearRod> rods() const { return rods_; }

  // The last harmonic of the rods' stiffness, that of their first modes, above this part of the largest one.
  [[nodiscard]] Eigen::Index stiffness_harmonics(double relative) const;

  // At q, whose harmonics the angles tell apart; dq without harmonics below a tenth of `tolerance`.
  [[nodiscard]] Corrections at(const CrankAngles& angles, const std::vector<FourierSeries>& q, double tolerance);

 private:
  // A linear rod without what shear adds: the exact model has none.
  struct Compared {
    Eigen::MatrixXd M, B;
    FourierSeries C, h;
    Eigen::MatrixXd C_there, h_there;  // at the angles asked for last, N x components

    Eigen::MatrixXd residual(const Eigen::MatrixXd& q, const Eigen::MatrixXd& q1, const Eigen::MatrixXd& q2);
  };

  // The linear rod's answer to the load on q given by samples; empty at resonance.
  std::optional<FourierSeries> answer(std::size_t rod, const Eigen::MatrixXd& samples, double tolerance);

  const ExactModel& model_;
  double speed_;
  std::span<const LinearRod> rods_;
  std::vector<Compared> compared_;
  std::vector<RoughSolver> answers_;
};

}  // namespace hb
