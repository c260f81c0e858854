// Finds a motion of the exact model at one speed: on the branch that comes from low speed, or from a motion near it.
// Used inside nonlinear_steady.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "hb/analysis/nonlinear/nonlinear_steady.hpp"
#include "hb/analysis/theory_error.hpp"
#include "hb/engine/nonlinear/continuation.hpp"
#include "lib/exact/exact_model.hpp"

namespace hb {

// Of the motions at single speeds.
constexpr double least_motion_tolerance = 1e-9;
// Exponents depend on accelerations: their tolerance, of the larger of growth and speed, over that of the motion.
constexpr double exponent_share = 100;

class MotionFinder {
 public:
  // Writes what it finds into `result`: motion, search, why, followed_from, folds, last_speed, others.
  MotionFinder(const SceneModel& model, double speed, double tolerance, const NonlinearOptions& options,
               NonlinearResult& result);

  // A motion of as many turns as asked for at the speed, or why there is none.
  void find();
  // The motion that Newton's method finds from `near`, all rods one above the other.
  void find_from(const FourierSeries& near);
  // Motions that Newton's method finds from elsewhere and that are not the one found.
  void look_for_others();
  // The same motion with half as many harmonics again.
  [[nodiscard]] std::optional<PeriodicMotion> with_more_harmonics() const;
  // The same motion with more modes of every rod, from this one; by rod.
  [[nodiscard]] std::optional<std::vector<FourierSeries>> with_more_modes() const;

  const ExactModel& exact() const { return *exact_; }
  const NonlinearSystem& system() const { return system_; }
  double tolerance() const { return motion_options_.tolerance; }

 private:
  std::shared_ptr<const ExactModel> with_modes(const std::vector<Eigen::Index>& modes) const;
  bool stopped() const { return options_.stop && options_.stop(); }
  // All rods' linear responses; empty where one has none.
  FourierSeries linear_answer(double speed) const;
  TheoryErrors linear_errors(double speed) const;
  bool weakly_bent(double speed) const;
  // The highest speed up to which the rods are weakly bent, at most the one asked for.
  std::optional<double> starting_speed() const;
  bool usable(const PeriodicMotion& motion, double at);
  ContinuationOptions continuation(double from) const;
  void follow(const PeriodicMotion& first, double from);
  // Those before a point.
  void count_folds(const Branch& branch, std::size_t point);
  const BranchPoint* passage_of(const Branch& branch) const;
  // Doublings on the way to the speed; then those beyond it.
  void follow_doublings(const Branch& to_speed, ContinuationOptions options);
  // A motion of twice, four times ... as many turns on a branch that leaves this one.
  bool doubled(const Branch& branch, const ContinuationOptions& options);
  bool at_speed(const BranchPoint& point) const { return std::abs(point.motion.speed - speed_) <= 1e-12 * speed_; }
  void no_way(const Branch& branch);
  double rpm(double speed) const { return rpm_from_speed(speed, model_.scene.units); }
  void note_last(const Branch& branch);
  // Largest |q_i| by rod and mode.
  RodPeaks sizes(const FourierSeries& q) const;
  void add_other(const PeriodicMotion& motion);

  const SceneModel& model_;
  double speed_;
  const NonlinearOptions& options_;
  NonlinearResult& result_;
  std::vector<Eigen::Index> modes_;
  std::shared_ptr<const ExactModel> exact_;
  NonlinearSystem system_;
  MotionOptions motion_options_;
};

// A motion of this model at this speed once more with more modes of every rod; by rod. Empty where none is found.
[[nodiscard]] std::optional<std::vector<FourierSeries>> motion_with_more_modes(const ExactModel& exact, double speed,
                                                                               const PeriodicMotion& motion,
                                                                               MotionOptions options);

// Rows of the rods one above the other.
[[nodiscard]] FourierSeries stacked(const std::vector<FourierSeries>& q);

}  // namespace hb
