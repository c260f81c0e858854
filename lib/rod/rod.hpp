// The elastic link: coefficients f0..f4 of the beam equation (3.3) in powers of Omega, Ritz matrices (3.8)-(3.13), and
// from Ritz coordinates back to deflection and bending moment.
#pragma once

#include <array>
#include <functional>

#include "lib/hill_system.hpp"
#include "lib/linkage/joint_forces.hpp"
#include "lib/linkage/kinematics.hpp"
#include "lib/linkage/linkage.hpp"

namespace hb {

// f_k(tau; Omega) = f_k^(0) + Omega f_k^(1) + Omega^2 f_k^(2), k = 0..4; f[p] has the five components f0..f4.
struct RodCoefficients {
  std::array<FourierSeries, 3> f;
};

// f_k^(p) at one crank angle: column p, row k. `forces` are the rigid forces of the three powers (balance of
// rigid_loads), which give the axial force in f4.
[[nodiscard]] Eigen::Matrix<double, 5, 3> rod_coefficients_at(const Linkage& linkage,
                                                              const std::vector<BodyMotion>& motion,
                                                              const std::array<MechanismForces, 3>& forces, int link);

// Everything of a linkage that does not know the speed: Fourier series of f0..f4 of its elastic links.
struct LinkageCoefficients {
  std::vector<int> links;  // body numbers of the elastic links
  std::vector<RodCoefficients> rods;  // one per link
  Eigen::Index num_samples = 0;  // of the crank angle that were needed
  double tail = 0;  // largest coefficient left out, relative to the largest of its kind
  // The coefficients have decayed, to rounding or below 1e-10. If not, the linkage comes so near a dead centre that
  // num_samples do not show its motion: nothing computed from the coefficients is worth anything.
  bool resolved = true;
};

// Samples one turn with N = 64, 128, ... points until the Fourier coefficients have decayed to rounding (`tolerance`
// relative, per f_k^(p)) or N = 2^14 (twice what the slider forces need, if that is more), and cuts what is below
// rounding. Precondition: find_obstruction() is empty.
[[nodiscard]] LinkageCoefficients linkage_coefficients(const Linkage& linkage, double tolerance = 1e-16);

// M, B, C, h of (3.8)-(3.13) with I = num_modes terms, divided by EJ as in the paper. With shear 2 I unknowns, of which
// shear.hpp makes q.
[[nodiscard]] HillSystem ritz_system(const Body& link, const RodCoefficients& rod, Eigen::Index num_modes);

// Largest deflection w(x,t) and bending moment EJ (w'' + alpha_c w''_t is stress-related; here EJ w'') over rod and
// turn. With shear the section's rotation stands for w' in the moment. q here and below: q_1..q_I, with shear too.
struct RodPeak {
  double max_abs = 0;
  double x = 0;  // from joint 0
  double crank_angle = 0;  // rad
};

struct RodShape {
  RodPeak deflection, bending_moment;
};

// True maxima over (x, tau) of w and EJ w'', kept modes plus the quasi-static tail: modes beyond I follow their load
// (f0, f1 and the coupling to the kept modes) without inertia, (1 + alpha_c d/dt) w'''' = p, summed in closed form.
[[nodiscard]] RodShape rod_shape(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q);
// The first of them alone.
[[nodiscard]] RodPeak largest_deflection(const Body& link, const RodCoefficients& rod, double speed,
                                         const FourierSeries& q);

// w and EJ w'' at x_j (columns) and tau (rows of the result are x, columns tau), tail included; for pictures and tests.
struct RodField {
  Eigen::MatrixXd w, bending_moment;  // num_x x num_samples, x from 0 to l, tau_j = 2 pi j/num_samples
};
[[nodiscard]] RodField rod_field(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                                 const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Index num_samples);
// Its bending moment at any places: what depends on time alone is computed once.
using MomentAlong = std::function<Eigen::MatrixXd(const Eigen::Ref<const Eigen::VectorXd>& x)>;
[[nodiscard]] MomentAlong bending_moment_along(const Body& link, const RodCoefficients& rod, double speed,
                                               const FourierSeries& q, Eigen::Index num_samples);

}  // namespace hb
