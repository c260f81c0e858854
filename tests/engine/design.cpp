#include "hb/engine/design/design.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace {

using namespace hb;
using Eigen::Vector2d;
using Eigen::VectorXd;

VectorXd vector(std::initializer_list<double> values) {
  VectorXd result(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) result(i++) = value;
  return result;
}

DesignProblem problem_of(std::initializer_list<double> lower, std::initializer_list<double> upper,
                         std::initializer_list<double> start, int num_conditions,
                         std::function<std::optional<DesignValues>(const VectorXd&)> evaluate) {
  DesignProblem problem;
  problem.lower = vector(lower);
  problem.upper = vector(upper);
  problem.start = vector(start);
  problem.num_conditions = num_conditions;
  problem.evaluate = std::move(evaluate);
  return problem;
}

constexpr DesignAlgorithm every_algorithm[] = {
    DesignAlgorithm::automatic, DesignAlgorithm::direct, DesignAlgorithm::mlsl, DesignAlgorithm::cobyla,
    DesignAlgorithm::bobyqa,    DesignAlgorithm::slsqp,  DesignAlgorithm::mma};

// Least weight of a rectangular bar w h that is stiff enough, w h^3 >= 8, and not too slender, h <= 4 w: both are
// active, w^4 = 8/64, h = 4 w, f = 4 w^2.
DesignProblem bar() {
  return problem_of({0.1, 0.1}, {10, 10}, {2, 2}, 2, [](const VectorXd& x) {
    const double w = x(0), h = x(1);
    return DesignValues{w * h, vector({1 - w * h * h * h / 8, h / (4 * w) - 1})};
  });
}
const double bar_width = std::pow(8.0 / 64.0, 0.25);

TEST(Design, FindsTheVertexOfTwoConditionsByEveryAlgorithm) {
  for (const DesignAlgorithm algorithm : every_algorithm) {
    if (algorithm == DesignAlgorithm::bobyqa) continue;  // takes no conditions
    SCOPED_TRACE(to_string(algorithm));
    DesignOptions options;
    options.algorithm = algorithm;
    options.max_evaluations = 3000;
    const DesignResult result = optimise(bar(), options);
    EXPECT_NE(result.status, DesignStatus::infeasible);
    EXPECT_NEAR(result.values.goal, 4 * bar_width * bar_width, 1e-4) << result.evidence;
    EXPECT_LE(result.values.conditions.maxCoeff(), 0);
  }
}

TEST(Design, FindsTheBottomOfACurvedValleyByBobyqaAlone) {
  // Rosenbrock's: 0 at (1, 1).
  const auto valley = [](const VectorXd& x) {
    const double a = 1 - x(0), b = x(1) - x(0) * x(0);
    return DesignValues{1 + a * a + 100 * b * b, {}};
  };
  DesignOptions options;
  options.algorithm = DesignAlgorithm::bobyqa;
  options.max_evaluations = 2000;
  const DesignResult result = optimise(problem_of({-2, -2}, {2, 2}, {-1, 1.5}, 0, valley), options);
  EXPECT_EQ(result.status, DesignStatus::optimal);
  EXPECT_NEAR(result.values.goal, 1, 1e-8) << result.evidence;
  EXPECT_EQ(result.evidence.find("COBYLA"), std::string::npos) << result.evidence;
  EXPECT_THROW((void)optimise(bar(), options), std::invalid_argument);  // conditions
  EXPECT_THROW((void)optimise(problem_of({0}, {1}, {0.5}, 0, valley), options), std::invalid_argument);
}

TEST(Design, SearchedLocallyStaysInItsValley) {
  const auto valleys = [](const VectorXd& x) { return DesignValues{2 + std::cos(7 * x(0)) + 0.1 * x(0), {}}; };
  const DesignProblem problem = problem_of({0}, {10}, {9.5}, 0, valleys);
  DesignOptions options;
  options.algorithm = DesignAlgorithm::direct;
  const DesignResult anywhere = optimise(problem, options);
  options.only_local = true;
  const DesignResult near = optimise(problem, options);
  EXPECT_NEAR(near.x(0), 21 * M_PI / 7, 0.01) << near.evidence;  // cos 7 x = -1
  EXPECT_NEAR(anywhere.x(0), M_PI / 7, 0.01) << anywhere.evidence;
}

TEST(Design, MultipliersAreWhatRelaxingAConditionGains) {
  const DesignProblem problem = bar();
  const DesignResult result = optimise(problem);
  const auto sensitivity = design_sensitivity(problem, result.x);
  ASSERT_TRUE(sensitivity);
  // Closed form: with w h^3 = 8 (1 - a), h = 4 w (1 + b):  f = w h, w^4 = (1 - a)/(8 (1 + b)^3),
  // f = 4 w^2 (1 + b) = 4 sqrt((1 - a)/8) (1 + b)^(-1/2);  -df/da = f/2, -df/db = f/2.
  const double f = 4 * bar_width * bar_width;
  EXPECT_NEAR(sensitivity->multipliers(0), f / 2, 1e-2 * f);
  EXPECT_NEAR(sensitivity->multipliers(1), f / 2, 1e-2 * f);
  EXPECT_LE(sensitivity->residual, 1e-2);
  EXPECT_NEAR(sensitivity->gradient.goal(0), 4 * bar_width, 1e-3);
}

TEST(Design, MultipliersScaleWithTheGoal) {
  const Vector2d x(bar_width, 4 * bar_width);
  const auto plain = design_sensitivity(bar(), x);
  for (const double scale : {1e-90, 1e90}) {
    DesignProblem problem = bar();
    problem.evaluate = [scale](const VectorXd& y) {
      DesignValues values = *bar().evaluate(y);
      values.goal *= scale;
      return values;
    };
    const auto scaled = design_sensitivity(problem, x);
    ASSERT_TRUE(plain && scaled);
    EXPECT_NEAR(scaled->multipliers(0) / scale, plain->multipliers(0), 1e-6);
    EXPECT_NEAR(scaled->multipliers(1) / scale, plain->multipliers(1), 1e-6);
    EXPECT_NEAR(scaled->residual, plain->residual, 1e-6);
  }
}

TEST(Design, FindsTheMinimaxBetweenTwoKinks) {
  // max(|x - 1|, |y + x|) + y^2/10: smallest at x = 1 - t, y = -1 + 2 t where both branches meet.
  const DesignProblem problem = problem_of({-3, -3}, {3, 3}, {-2, 2.5}, 0, [](const VectorXd& x) {
    return DesignValues{std::max(std::abs(x(0) - 1), std::abs(x(1) + x(0))) + x(1) * x(1) / 10, {}};
  });
  // On the ridge t = |x - 1| = |y + x| with y = -1 + 2 t: t + (1 - 2 t)^2/10 has the derivative 1 - 4 (1 - 2 t)/10 > 0
  // for t >= 0, so t = 0.
  const DesignResult result = optimise(problem);
  EXPECT_NEAR(result.values.goal, 0.1, 1e-3) << result.evidence;
}

// max(|x - a|^2, |x - b|^2): smallest halfway between, |a - b|^2/4, both parts weighing the same.
DesignProblem between_two_points() {
  const Vector2d a(1, 0.5), b(-1, 1);
  DesignProblem problem = problem_of({-3, -3}, {3, 3}, {-2, 2.5}, 0, [=](const VectorXd& x) {
    const double to_a = (x - a).squaredNorm(), to_b = (x - b).squaredNorm();
    return DesignValues{std::max(to_a, to_b), {}, vector({to_a, to_b})};
  });
  problem.num_parts = 2;
  problem.gradient = [=](const VectorXd& x) {
    DesignGradient gradient{2 * (x - a), Eigen::MatrixXd(0, 2), Eigen::MatrixXd(2, 2)};
    if ((x - b).squaredNorm() > (x - a).squaredNorm()) gradient.goal = 2 * (x - b);
    gradient.parts << 2 * (x - a).transpose(), 2 * (x - b).transpose();
    return gradient;
  };
  return problem;
}

TEST(Design, FindsTheKinkOfTheLargestPartByEveryAlgorithmWithConditions) {
  for (const DesignAlgorithm algorithm : every_algorithm) {
    if (algorithm == DesignAlgorithm::bobyqa) continue;
    SCOPED_TRACE(to_string(algorithm));
    DesignOptions options;
    options.algorithm = algorithm;
    const DesignResult result = optimise(between_two_points(), options);
    EXPECT_EQ(result.status, DesignStatus::optimal) << result.evidence;
    EXPECT_NEAR(result.values.goal, 4.25 / 4, 1e-4) << result.evidence;
  }
}

TEST(Design, SensitivityAtAKinkWeighsThePartsAndIsOneSided) {
  const DesignProblem problem = between_two_points();
  const auto sensitivity = design_sensitivity(problem, Vector2d(0, 0.75));
  ASSERT_TRUE(sensitivity);
  EXPECT_LE(sensitivity->residual, 1e-6);
  EXPECT_NEAR(sensitivity->weights(0), 0.5, 1e-6);
  EXPECT_NEAR(sensitivity->weights(1), 0.5, 1e-6);
  EXPECT_NEAR(sensitivity->upward(0), 2, 1e-6);  // away from b
  EXPECT_NEAR(sensitivity->upward(1), 0.5, 1e-6);  // away from a
}

TEST(Design, FindsTheLowestOfManyValleys) {
  const auto valleys = [](const VectorXd& x) {
    return DesignValues{std::cos(7 * x(0)) + 0.1 * (x(0) - 4.0) * (x(0) - 4.0), {}};
  };
  const DesignProblem problem = problem_of({0}, {10}, {9.5}, 0, valleys);
  double best = HUGE_VAL;
  for (int k = 0; k <= 1000000; ++k) best = std::min(best, valleys(vector({1e-5 * k})).goal);
  const DesignResult result = optimise(problem);
  EXPECT_NEAR(result.values.goal, best, 1e-6);
}

TEST(Design, GoesRoundWhereThereIsNoDesign) {
  // No design in a disc around the unconstrained minimum; the best ones are on its rim.
  const DesignProblem problem = problem_of({-2, -2}, {2, 2}, {1.5, 1.5}, 0, [](const VectorXd& x) {
    if (x.norm() < 0.5) return std::optional<DesignValues>();
    return std::optional<DesignValues>({x.squaredNorm(), {}});
  });
  const DesignResult result = optimise(problem);
  EXPECT_GE(result.x.norm(), 0.5);
  EXPECT_NEAR(result.values.goal, 0.25, 0.02);
  EXPECT_GT(result.num_missing, 0);
}

TEST(Design, ThatIsNotANumberNeverWins) {
  const DesignProblem problem = problem_of({0}, {1}, {0.9}, 1, [](const VectorXd& x) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return DesignValues{x(0) < 0.25 ? nan : x(0), vector({x(0) < 0.5 ? nan : -1.0})};
  });
  const DesignResult result = optimise(problem);
  EXPECT_GE(result.x(0), 0.5);
  EXPECT_NEAR(result.x(0), 0.5, 1e-3);
}

TEST(Design, ThatCannotBeGivesTheNearestOne) {
  // x >= 2 and x <= 1 (violations equal at x = 4/3): the least largest violation is 1/3.
  const DesignProblem problem = problem_of({0.5}, {3}, {2.8}, 2, [](const VectorXd& x) {
    return DesignValues{x(0), vector({1 - x(0) / 2, x(0) - 1})};
  });
  const DesignResult result = optimise(problem);
  EXPECT_EQ(result.status, DesignStatus::infeasible);
  EXPECT_NEAR(result.x(0), 4.0 / 3, 1e-3) << result.evidence;
  EXPECT_GT(result.values.conditions.maxCoeff(), 0);
}

TEST(Design, IsTheSameTwice) {
  for (const DesignAlgorithm algorithm : {DesignAlgorithm::automatic, DesignAlgorithm::mlsl}) {
    DesignOptions options;
    options.algorithm = algorithm;
    const DesignResult a = optimise(bar(), options), b = optimise(bar(), options);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.trials.size(), b.trials.size());
  }
}

TEST(Design, NeverAnalysesMoreThanAllowed) {
  DesignOptions options;
  options.max_evaluations = 25;
  const DesignResult result = optimise(bar(), options);
  EXPECT_LE(result.trials.size(), 25u);
  EXPECT_NE(result.status, DesignStatus::optimal);
}

TEST(Design, PassesAnExceptionOnThroughNlopt) {
  DesignProblem problem = bar();
  int calls = 0;
  problem.evaluate = [&](const VectorXd&) -> std::optional<DesignValues> {
    if (++calls == 10) throw std::domain_error("the tenth");
    return DesignValues{1.0 * calls, vector({-1.0, -1.0})};
  };
  EXPECT_THROW((void)optimise(problem), std::domain_error);
}

TEST(Design, WithWrongBoundsIsRefused) {
  DesignProblem problem = bar();
  problem.upper(1) = problem.lower(1);
  EXPECT_THROW((void)optimise(problem), std::invalid_argument);
  problem = bar();
  problem.start(0) = 11;
  EXPECT_THROW((void)optimise(problem), std::invalid_argument);
  problem = bar();
  problem.evaluate = [](const VectorXd&) { return std::optional<DesignValues>(); };
  EXPECT_THROW((void)optimise(problem), std::invalid_argument);
}

TEST(Design, NonnegativeLeastSquaresMeetsItsOptimalityConditions) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 50; ++round) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(6, 4, [&] { return normal(random); });
    const VectorXd b = VectorXd::NullaryExpr(6, [&] { return normal(random); });
    const VectorXd x = nonnegative_least_squares(A, b), slope = A.transpose() * (b - A * x);
    for (int i = 0; i < 4; ++i) {
      EXPECT_GE(x(i), 0);
      EXPECT_LE(slope(i), 1e-10);
      EXPECT_NEAR(slope(i) * x(i), 0, 1e-10);
    }
  }
}

}  // namespace
