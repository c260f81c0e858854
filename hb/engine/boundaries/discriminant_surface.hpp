// The discriminant of one mode over the whole rectangle of a map: patches found by halving, each with a checked error.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hb/engine/boundaries/curve_point.hpp"
#include "hb/engine/boundaries/discriminant_patch.hpp"
#include "hb/engine/boundaries/part.hpp"
#include "hb/engine/exponents/discriminant.hpp"

namespace hb {

class DiscriminantSurface {
 public:
  struct Request {
    ParameterBox box;
    std::array<bool, 2> varies = {true, true};  // whether the system depends on x and on y
    std::size_t most_evaluations = 0;
    PartsOf parts;
  };

  // Empty where the system has several modes or is not there everywhere, where its damping is negative at some places,
  // or where the discriminant needs more evaluations than allowed.
  [[nodiscard]] static std::optional<DiscriminantSurface> over(const MapSystemAt& at, const Request& request);

  [[nodiscard]] const std::vector<DiscriminantPatch>& patches() const { return patches_; }
  [[nodiscard]] DiscriminantValue at(double x, double y) const;
  // No damping anywhere.
  [[nodiscard]] bool undamped() const { return undamped_; }
  // How a disturbance behaves whose multiplier over the shortest period is real, of that sign.
  [[nodiscard]] BoundaryKind kind(bool positive) const {
    return positive || divisor_ % 2 == 0 ? BoundaryKind::plus_one : BoundaryKind::minus_one;
  }
  // Of the turn, rad per unit time.
  [[nodiscard]] double speed_of(const DiscriminantValue& value) const { return value.speed / double(divisor_); }
  // Computed from the system, not interpolated; empty where there is none.
  [[nodiscard]] std::optional<Discriminant> exact(const ScaledSystem& system) const;

 private:
  std::vector<DiscriminantPatch> patches_;
  bool undamped_ = false;
  Eigen::Index divisor_ = 1;
};

}  // namespace hb
