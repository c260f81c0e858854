// The theory error beside the true change on held-out random linkages: within a tenth where the change is below 2 %.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/linear_answer.hpp"
#include "tests/support/random_linkage.hpp"

namespace hb {
namespace {

constexpr Eigen::Index gate_modes = 2;

template <class Change>
void change_elastic(Linkage& linkage, const Change& change) {
  for (Dyad& dyad : linkage.dyads) {
    if (dyad.coupler.elastic) change(*dyad.coupler.elastic);
    if (auto* rocker = std::get_if<Rocker>(&dyad.closing); rocker && rocker->body.elastic)
      change(*rocker->body.elastic);
  }
}

// Four-bars with elastic coupler, rocker and both, slider-cranks, six-link mechanisms: the first seven kinds, stiffened
// by up to 100 so that the changes reach from nothing to beyond the theory.
std::vector<RandomLinkage> stiffened(std::uint64_t seed) {
  Random random(seed + 1000);
  std::vector<RandomLinkage> all = random_linkages(7, seed + 500);
  for (RandomLinkage& each : all) {
    const double stiffer = random.log_uniform(1, 100);
    change_elastic(each.linkage, [&](Elastic& elastic) { elastic.youngs_modulus *= stiffer; });
  }
  return all;
}

enum class Without { nothing, gas_force, gravity, damping };

void leave_out(Linkage& linkage, Without what) {
  if (what == Without::gravity) linkage.gravity = 0;
  if (what == Without::damping)
    change_elastic(linkage, [](Elastic& e) { e.internal_damping = e.damping_x = e.damping_y = 0; });
  if (what == Without::gas_force)
    for (Dyad& dyad : linkage.dyads)
      if (auto* slider = std::get_if<Slider>(&dyad.closing)) slider->force = FourierSeries(1, 0);
}

TEST(TheoryErrorGate, IsWithinATenthOfTheTrueChangeWhereThatIsBelowTwoPercent) {
  constexpr double gate = 0.02, least = 1e-6;  // below: next to the accuracy of the motions
  int judged = 0, close_to_the_gate = 0;
  double worst = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed)
    for (RandomLinkage& each : stiffened(seed)) {
      SCOPED_TRACE(each.kind + ", seed " + std::to_string(seed));
      leave_out(each.linkage, static_cast<Without>(seed % 4));
      const LinearAnswer answer = linear_answer(each.linkage, each.speed, gate_modes);
      const TheoryErrors errors = theory_errors(answer.model, each.speed, answer.rods());
      if (!errors.rods[0].q) continue;
      const auto changes = true_changes(answer, each.speed);
      // Where a rod is beyond the theory, those that it moves are too.
      if (!changes || std::ranges::max(*changes) > theory_error_limit) continue;
      for (std::size_t r = 0; r < changes->size(); ++r) {
        const double change = (*changes)[r];
        if (!(change < gate && change > least)) continue;
        EXPECT_NEAR(*errors.rods[r].q, change, 0.1 * change) << "rod " << r;
        worst = std::max(worst, std::abs(*errors.rods[r].q / change - 1));
        ++judged;
        close_to_the_gate += change > 0.1 * gate;
      }
    }
  EXPECT_GE(judged, 60);
  EXPECT_GE(close_to_the_gate, 10);
  RecordProperty("judged", judged);
  RecordProperty("worst", std::to_string(worst));
}

// Rods whose first correction, amplified by a sharp resonance, is several times or a quarter larger than the change.
TEST(TheoryErrorGate, SecondOrderIsFollowedWhereTheFirstCorrectionIsAmplified) {
  const struct {
    std::uint64_t seed;
    std::size_t number, rod;
    double first, change;
  } cases[] = {{8, 1, 0, 0.0301, 0.00468},    {31, 0, 0, 1.52e-4, 1.274e-4},  {34, 5, 1, 0.01066, 0.00606},
               {40017, 1, 0, 0.0294, 0.0239}, {40017, 2, 0, 0.0745, 0.00469}, {40034, 2, 0, 0.0667, 0.0358}};
  for (const auto& c : cases) {
    SCOPED_TRACE(std::to_string(c.seed) + ", linkage " + std::to_string(c.number));
    const RandomLinkage each = stiffened(c.seed)[c.number];
    const LinearAnswer answer = linear_answer(each.linkage, each.speed, gate_modes);
    const TheoryErrors errors = theory_errors(answer.model, each.speed, answer.rods());
    const auto changes = true_changes(answer, each.speed);
    ASSERT_TRUE(errors.rods[c.rod].q && changes);
    EXPECT_NEAR((*changes)[c.rod], c.change, 0.01 * c.change);
    EXPECT_GT(std::abs(c.first / c.change - 1), 0.15);
    EXPECT_NEAR(*errors.rods[c.rod].q, (*changes)[c.rod], 0.05 * c.change);
  }
}

}  // namespace
}  // namespace hb
