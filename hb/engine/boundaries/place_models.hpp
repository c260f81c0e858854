// The places that are known along a line, and the models of growth that those about an interval make.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "hb/engine/boundaries/cluster_model.hpp"
#include "hb/engine/boundaries/growth_model.hpp"
#include "hb/engine/boundaries/place.hpp"
#include "hb/engine/boundaries/separate_pair.hpp"

namespace hb {

using Places = std::map<double, Place>;  // by x

// p, q and up to one more on either side or two on one.
[[nodiscard]] std::vector<const Place*> window(const Places& places, const Place& p, const Place& q);

// p, q and up to two more on either side at which the same is apart from the other exponents; empty if it is not at
// both.
[[nodiscard]] std::vector<const Place*> apart_beside(const Places& places, const Place& p, const Place& q, Apart what);

// Of strand k of p, of two strands of it, and of k with the strand that is nearest; empty where the places do not agree
// on one.
[[nodiscard]] std::optional<GrowthModel> single_model(const Places& places, const Place& p, std::size_t k,
                                                      const Place& q);
[[nodiscard]] std::optional<GrowthModel> pair_model(const Places& places, const Place& p, std::size_t a, std::size_t b,
                                                    const Place& q);
[[nodiscard]] std::optional<ClusterModel> cluster_model(const Places& places, const Place& p,
                                                        const std::vector<std::size_t>& strands, const Place& q);
[[nodiscard]] std::optional<GrowthModel> partner_model(const Places& places, const Place& p, std::size_t k,
                                                       const Place& q);

}  // namespace hb
