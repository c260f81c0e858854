// The mechanism with elastic links of any deflection: planar, inextensible, pinned at both ends, Euler-Bernoulli with
// rotary inertia; crank prescribed, all other bodies rigid and moving as the closure with the bent links' chords
// demands. All rods are coupled through the geometry. Linearised at q = 0 this is the model of rod.hpp.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lib/linkage/joint_forces.hpp"
#include "lib/linkage/linkage.hpp"

namespace hb {

class Lanes;
namespace exact {
template <class T>
struct BentMechanism;
}

// Crank angles at which the model is evaluated, with what depends on them alone.
struct CrankAngles {
  Eigen::VectorXd tau;  // rad
  Eigen::VectorXcd direction;  // e^{i tau}
  Eigen::MatrixXd slider_forces;  // dyads x N

  CrankAngles(const Linkage& linkage, Eigen::VectorXd crank_angles);
  // N equally spaced over `num_turns` turns, from 0.
  CrankAngles(const Linkage& linkage, Eigen::Index num_samples, int num_turns = 1);

  Eigen::Index size() const { return tau.size(); }
  CrankAngles part(Eigen::Index begin, Eigen::Index count) const;

 private:
  CrankAngles() = default;
};

// Where the model ends: the first angle at which a rod's slope |w'| reaches 1, or a dyad with the bent chords does not
// close.
struct ExactBreakdown {
  enum class Kind { slope, open } kind = Kind::slope;
  int body = 0;  // the rod; the dyad's coupler
  double crank_angle = 0;  // rad
  double slope = 0;  // |w'| reached
};

// Ritz coordinates of all rods, one above the other in the order of ExactModel::rods, and their derivatives in time;
// n x N.
struct RitzSamples {
  Eigen::MatrixXd q, q1, q2;
};

struct ExactResidual {
  // r_i, n x N, scaled as the linear model: r = M q'' + B q' + C q - h to first order in q.
  Eigen::MatrixXd r;
  // dr_i/dq_k, dr_i/dq'_k, dr_i/dq''_k, row i + n k; n*n x N. Empty unless asked for.
  Eigen::MatrixXd by_q, by_q1, by_q2;
  Eigen::MatrixXd by_speed;  // dr_i/dOmega at the same angles and q, q', q''; n x N
  std::optional<ExactBreakdown> breakdown;  // then all else is empty
};

class ExactModel {
 public:
  struct Rod {
    int link = 0;  // body number
    Eigen::Index num_modes = 0;
  };

  // All elastic links of the linkage, in the order of elastic_links; num_points = 0: as many points along each rod as
  // rod_quadrature.hpp says. Throws std::invalid_argument if the rods are not those, or without modes.
  ExactModel(Linkage linkage, std::vector<Rod> rods, Eigen::Index num_points = 0);
  ~ExactModel();
  ExactModel(ExactModel&&) noexcept;
  ExactModel& operator=(ExactModel&&) noexcept;

  const Linkage& linkage() const;
  const std::vector<Rod>& rods() const;
  Eigen::Index num_modes() const;  // n, of all rods
  Eigen::Index first_mode(std::size_t rod) const;  // row of the rod's q_1
  // r_i EJ l/2 of rod r is a generalised force: work per q_i.
  double force_per_residual(std::size_t rod) const;

  // Of each rod the largest |dX/dc''| over the turn with straight rods: the mass that it drives along itself.
  std::vector<double> driven_masses() const;

  // Speed in rad per unit time. Any periodic or other motion; it need not solve the equations.
  [[nodiscard]] ExactResidual residual(double speed, const CrankAngles& angles, const RitzSamples& motion,
                                       bool derivatives = false) const;
  // The derivatives by q, q', q'' alone; r and by_speed are empty.
  [[nodiscard]] ExactResidual linearised(double speed, const CrankAngles& angles, const RitzSamples& motion) const;

  // Forces at every angle that this motion needs, and the frames they are resolved in.
  struct Forces {
    std::vector<MechanismForces> forces;
    std::vector<std::vector<BodyMotion>> motion;  // [angle][body], derivatives in time; e of a bent link: its chord
    std::optional<ExactBreakdown> breakdown;
  };
  [[nodiscard]] Forces forces(double speed, const CrankAngles& angles, const RitzSamples& motion) const;
  // The same as it is computed: visit(first angle, how many, the mechanism with one of them in each lane).
  using Visit = std::function<void(Eigen::Index, Eigen::Index, const exact::BentMechanism<Lanes>&)>;
  [[nodiscard]] std::optional<ExactBreakdown> visit_forces(double speed, const CrankAngles& angles,
                                                           const RitzSamples& motion, const Visit& visit) const;

  struct Impl;

 private:
  std::unique_ptr<const Impl> impl_;
};

// Samples over the turns of `angles` of series whose harmonic n is n/num_turns of the crank's, with derivatives in
// time.
[[nodiscard]] RitzSamples ritz_samples(std::span<const FourierSeries> q, double speed, Eigen::Index num_samples,
                                       int num_turns = 1);

// "AB: slope 1.03 at crank angle 81.2 deg; the rod would be folded"
[[nodiscard]] std::string describe(const ExactBreakdown& breakdown, const Linkage& linkage);

}  // namespace hb
