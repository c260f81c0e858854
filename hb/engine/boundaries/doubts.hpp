// Whether the verdict may change between two places that have one verdict, by all their exponents:
// hb/engine/README.md, "Bands between two stable places", "Gaps between two unstable places".
#pragma once

#include <vector>

#include "hb/engine/boundaries/encounters.hpp"
#include "hb/engine/boundaries/growth_model.hpp"
#include "hb/engine/boundaries/locks.hpp"
#include "hb/engine/boundaries/place_models.hpp"

namespace hb {

// Refers to its arguments.
class Doubts {
 public:
  Doubts(const Places& places, const StrandCoupling& coupling)
      : places_(places), coupling_(coupling), encounters_(coupling), locks_(coupling) {}

  // NaN: it does not; otherwise where to look. Both places stable, or both unstable.
  double while_stable(const Place& p, const Place& q) const;
  double while_unstable(const Place& p, const Place& q) const;

 private:
  double least_growth(const Place& p, const Place& q) const;
  double beside_centre(const Place& p, const Place& q, double centre, double doubtful) const;
  double in_crowds(const Place& p, const Place& q, const std::vector<Meeting>& meetings, double told) const;
  bool level(const Place& p, const Place& q, double least) const;
  bool level_lock(const Place& p, const Place& q) const;
  std::vector<GrowthModel> models_of_growth(const Place& p, const Place& q) const;

  const Places& places_;
  const StrandCoupling& coupling_;
  Encounters encounters_;
  Locks locks_;
};

}  // namespace hb
