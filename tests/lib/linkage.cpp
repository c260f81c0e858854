#include "lib/linkage/linkage.hpp"

#include <gtest/gtest.h>

#include "tests/support/six_link.hpp"

namespace {

using namespace hb;

TEST(Linkage, BodiesAreNumberedCrankThenCouplerAndRockerOfEachDyad) {
  const Linkage six = six_link::linkage();
  ASSERT_EQ(six.num_bodies(), 5);
  const char* names[] = {"crank", "AB", "O2BC", "CD", "O3D"};
  for (int b = 0; b < 5; ++b) {
    EXPECT_EQ(body_name(six, b), names[b]);
    ASSERT_NE(body_at(six, b), nullptr);
    EXPECT_EQ(body_at(six, b)->name, names[b]);
  }
  EXPECT_EQ(body_name(six, coupler_index(1)), "CD");
  EXPECT_EQ(body_name(six, closing_index(1)), "O3D");
}

TEST(Linkage, SliderHasANameAndNoBody) {
  Linkage linkage = six_link::linkage();
  Slider piston;
  piston.name = "piston";
  linkage.dyads[1].closing = piston;
  EXPECT_EQ(body_at(linkage, 4), nullptr);
  EXPECT_EQ(body_name(linkage, 4), "piston");
}

TEST(Linkage, ElasticLinksAreListedInOrderRockersToo) {
  Linkage linkage = six_link::linkage();
  EXPECT_EQ(elastic_links(linkage), (std::vector<int>{1, 3}));
  std::get<Rocker>(linkage.dyads[1].closing).body.elastic = linkage.dyads[0].coupler.elastic;
  linkage.dyads[0].coupler.elastic.reset();
  EXPECT_EQ(elastic_links(linkage), (std::vector<int>{3, 4}));
}

}  // namespace
