// Products at nodes against sums one by one: the same leading bits, the rest within the bound.
#include "hb/engine/steady/split_products.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using hb::steady::Products;
using hb::steady::SampledProducts;
using hb::steady::Split;
using Real = long double;

// Numbers at random that fall by exp(-decay k).
Split series(std::mt19937& random, Eigen::Index H, double decay, int bits = SampledProducts::bits) {
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<Real> re(static_cast<std::size_t>(H + 1)), im(re.size());
  for (std::size_t k = 0; k < re.size(); ++k) {
    const Real size = std::exp(-static_cast<Real>(decay) * static_cast<Real>(k));
    re[k] =
        size * static_cast<Real>(number(random)) * (1 + static_cast<Real>(1e-17) * static_cast<Real>(number(random)));
    im[k] = k == 0 ? 0 : size * static_cast<Real>(number(random));
  }
  return hb::steady::split(re, im, bits);
}

TEST(SplitProducts, AtNodesAreThoseOfSums) {
  std::mt19937 random(7);
  struct Case {
    Eigen::Index P, H;
    double decay;
    int bits;
  };
  for (const auto& [P, H, decay, bits] : {Case{200, 140, 0.1, SampledProducts::bits},
                                          {400, 900, 0.05, SampledProducts::bits},
                                          {1500, 1100, 0.01, 15},
                                          {2047, 3000, 0.02, 15}}) {
    const Split c = series(random, P, decay, bits), x = series(random, H, decay, bits);
    Products sums(H + P), nodes(H + P);
    sums.multiply(c, P, P, x, H);
    SampledProducts at_nodes({x}, H + P);
    const std::optional<double> error = at_nodes.multiply(c, 0, nodes);
    ASSERT_TRUE(error) << P;
    EXPECT_TRUE((sums.exact_re == nodes.exact_re).all()) << P;
    EXPECT_TRUE((sums.exact_im == nodes.exact_im).all()) << P;
    const double off =
        std::max((sums.rest_re - nodes.rest_re).abs().maxCoeff(), (sums.rest_im - nodes.rest_im).abs().maxCoeff());
    EXPECT_LE(off, *error) << P;
    EXPECT_GT(off, 0) << P;
    EXPECT_LE(*error, 1e-15) << P;
  }
}

// White series that long leave no room for exact rounding: none is claimed.
TEST(SplitProducts, AreNotClaimedToBeExactWhereTheyMayNotBe) {
  std::mt19937 random(8);
  const Eigen::Index H = 30000;
  const Split c = series(random, H, 0), x = series(random, H, 0);
  Products nodes(2 * H);
  EXPECT_FALSE(SampledProducts({x}, 2 * H).multiply(c, 0, nodes));
}

}  // namespace
