#include "hb/engine/boundaries/cluster_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <vector>

namespace hb {
namespace {

using cplx = std::complex<double>;

ClusterModel model_of(const std::function<std::vector<cplx>(double)>& exponents, std::array<double, 4> places) {
  std::vector<ClusterNode> nodes;
  for (const double x : places) {
    const std::vector<cplx> s = exponents(x);
    nodes.push_back(cluster_node(x, s, std::vector<double>(s.size(), 1e-15)));
  }
  return ClusterModel(std::move(nodes));
}

// Three that pass each other without exciting each other, in any order and half a turn apart from where they began.
TEST(ClusterModel, ExponentsThatPassEachOtherDoNotGrow) {
  const auto exponents = [](double x) {
    std::vector<cplx> s = {{0, 0.49 + 0.2 * x}, {0, -0.5 - 0.1 * x}, {0, -0.49 + 0.05 * x}};
    if (x > 0.5) std::swap(s[0], s[2]);
    for (cplx& one : s) one -= cplx(0, std::round(one.imag()));
    return s;
  };
  const ClusterModel model = model_of(exponents, {0.2, 0.4, 0, 0.6});
  for (const double x : {0.21, 0.25, 0.31, 0.39}) {
    EXPECT_LE(model(x, 1e-12).growth, 1e-12) << x;
    EXPECT_GT(model(x, 1e-12).apart, 1e-3) << x;
  }
}

// Q = kappa^2 - (x - x0)^2 of two, a third one beside them: between places outside the band.
TEST(ClusterModel, FindsTheBandOfTwoBesideAThird) {
  const double kappa = 3e-4, x0 = 0.301;
  const auto exponents = [&](double x) {
    const cplx root = std::sqrt(cplx(kappa * kappa - (x - x0) * (x - x0)));
    return std::vector<cplx>{cplx(0, 0.1) + root, cplx(0, 0.1) - root, cplx(0, 0.11 + 0.4 * (x - 0.3))};
  };
  const ClusterModel model = model_of(exponents, {0.3005, 0.3015, 0.3, 0.302});
  EXPECT_GE(model(x0, 1e-12).growth, kappa);
  EXPECT_LE(model(x0, 1e-12).growth, 3 * kappa);
  EXPECT_LE(model(0.30051, 1e-12).growth, 1e-12);
}

// Three at one place at all places: no disc has a size, and nothing is told from growth.
TEST(ClusterModel, WhatIsNotToldApartIsNotToldNotToGrow) {
  const auto exponents = [](double x) { return std::vector<cplx>(3, cplx(0, 0.1 * x)); };
  const ClusterModel model = model_of(exponents, {0.34, 0.36, 0.32, 0.38});
  EXPECT_GT(model(0.35, 0).growth, 0);
}

// Damped, two on top of each other: not known apart, but known to decay.
TEST(ClusterModel, ExponentsThatCoincideAndDecayAreToldToDecay) {
  const auto exponents = [](double x) {
    return std::vector<cplx>{{-0.01, 0.2 * x}, {-0.01, 0.3 * x - 0.035}, {-0.012, 0.1 * x + 0.02}};
  };
  const ClusterModel model = model_of(exponents, {0.34, 0.36, 0.32, 0.38});
  EXPECT_LE(model(0.35, 1e-9).growth, 1e-9);
  EXPECT_GT(model(0.35, -0.0099).growth, -0.0099);
}

}  // namespace
}  // namespace hb
