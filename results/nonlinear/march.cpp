// What the mechanism does where no stable periodic motion is known: the exact model with one mode of each rod, marched
// over time from several states at rest. Usage: march SCENE FROM TO STEP, speeds in rpm; a row for each speed and
// state.
#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <exception>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "lib/dense.hpp"
#include "lib/exact/exact_model.hpp"
#include "lib/scene/scene.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int steps_per_turn = 120, settling_turns = 120, recorded_turns = 24, most_turns = 12;
constexpr double periodic = 1e-3;  // states that many turns apart differ by less, of the largest q

struct State {
  VectorXd q, v;
};

class March {
 public:
  March(const hb::ExactModel& model, double speed)
      : model_(model), speed_(speed), dt_(2 * std::numbers::pi / speed / steps_per_turn) {
    for (int j = 0; j < 2 * steps_per_turn; ++j)
      angles_.emplace_back(model.linkage(), VectorXd::Constant(1, std::numbers::pi * j / steps_per_turn));
  }

  // One turn by the classical Runge-Kutta method of order four; false where the model ends.
  bool turn(State& y, VectorXd& largest) {
    for (int s = 0; s < steps_per_turn && !end_; ++s) {
      const State k1{y.v, acceleration(2 * s, y)}, y2 = moved(y, k1, dt_ / 2);
      const State k2{y2.v, acceleration(2 * s + 1, y2)}, y3 = moved(y, k2, dt_ / 2);
      const State k3{y3.v, acceleration(2 * s + 1, y3)}, y4 = moved(y, k3, dt_);
      const State k4{y4.v, acceleration(2 * s + 2, y4)};
      y.q += dt_ / 6 * (k1.q + 2 * k2.q + 2 * k3.q + k4.q);
      y.v += dt_ / 6 * (k1.v + 2 * k2.v + 2 * k3.v + k4.v);
      largest = largest.cwiseMax(y.q.cwiseAbs());
    }
    return !end_;
  }

  std::string why() const { return hb::describe(*end_, model_.linkage()); }

 private:
  static State moved(const State& y, const State& rate, double dt) { return {y.q + dt * rate.q, y.v + dt * rate.v}; }

  // r is linear in q_tt.
  VectorXd acceleration(int half_step, const State& y) {
    const Index n = y.q.size();
    const hb::ExactResidual at =
        model_.residual(speed_, angles_[static_cast<std::size_t>(half_step % (2 * steps_per_turn))],
                        {y.q, y.v, VectorXd::Zero(n)}, true);
    if (at.breakdown && !end_) end_ = at.breakdown;
    if (end_) return VectorXd::Zero(n);
    return -hb::dense::Lu<double>(MatrixXd(at.by_q2.reshaped(n, n))).solve(VectorXd(at.r.col(0)));
  }

  const hb::ExactModel& model_;
  double speed_, dt_;
  std::vector<hb::CrankAngles> angles_;
  std::optional<hb::ExactBreakdown> end_;
};

std::string outcome(const hb::ExactModel& model, double speed, double start) {
  const Index n = model.num_modes();
  March march(model, speed);
  State y{VectorXd::Constant(n, start), VectorXd::Zero(n)};
  VectorXd largest = VectorXd::Zero(n);
  std::vector<VectorXd> states;
  for (int t = 0; t < settling_turns + recorded_turns; ++t) {
    if (t == settling_turns) largest.setZero();
    if (t >= settling_turns) {
      states.emplace_back(2 * n);
      states.back() << y.q, y.v / speed;
    }
    if (!march.turn(y, largest)) return fmt::format("ends in turn {}: {}", t + 1, march.why());
  }
  std::string text = "largest |q|:";
  for (Index i = 0; i < n; ++i) text += fmt::format(" {:.2f}", largest(i));
  for (int T = 1; T <= most_turns; ++T) {
    double apart = 0;
    for (std::size_t k = 0; k + static_cast<std::size_t>(T) < states.size(); ++k)
      apart = std::max(apart, (states[k + static_cast<std::size_t>(T)] - states[k]).cwiseAbs().maxCoeff());
    if (apart < periodic * largest.maxCoeff()) return text + fmt::format(", repeats after {} turns", T);
  }
  return text + fmt::format(", does not repeat within {} turns", most_turns);
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 5) throw std::invalid_argument("usage: march SCENE FROM TO STEP");
  const hb::Scene scene = hb::read_scene(arguments[1]);
  const auto& linkage = std::get<hb::Linkage>(scene.model);
  std::vector<hb::ExactModel::Rod> rods;
  for (const int link : hb::elastic_links(linkage)) rods.push_back({link, 1});
  const hb::ExactModel model(linkage, rods);
  const double to = std::atof(arguments[3]), step = std::atof(arguments[4]);
  fmt::print("rpm  q at rest [{}]\n", scene.units.length);
  for (double rpm = std::atof(arguments[2]); rpm <= to; rpm += step)
    for (const double start : {0.0, 5.0, -5.0, 15.0, -15.0})
      fmt::print("{:<6g} {:>3g}  {}\n", rpm, start, outcome(model, hb::speed_from_rpm(rpm, scene.units), start));
} catch (const std::exception& error) {
  fmt::print(stderr, "march: {}\n", error.what());
  return 1;
}
