#include "hb/analysis/frame_forces.hpp"

#include <algorithm>
#include <numbers>

#include "lib/fourier/turn_sampling.hpp"
#include "lib/linkage/balance.hpp"

namespace hb {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

double cross(Complex a, Complex b) { return (std::conj(a) * b).imag(); }

// Force and moment about `origin` of one body's load.
Eigen::Vector3d about(const BodyLoad& load, Complex joint0, Complex origin) {
  return {load.force.real(), load.force.imag(), load.moment + cross(joint0 - origin, load.force)};
}

}  // namespace

// Joints cancel in the sum over all bodies: what they ask of pivots, guides and motor is
//     G = sum of load,   M = sum of load.moment + (z - O) x load.force,
// a slider's applied force F, taken off its load there, being given back to the frame:  -(G + F),  -(M + (z - O) x F).
FrameForces frame_forces(const Linkage& linkage, double speed, const std::vector<LinkResponse>& responses) {
  constexpr int force_group = 0, moment_group = 1;
  const std::vector<TurnComponent> components = {{force_group, 1}, {force_group, 1}, {moment_group, 1},
                                                 {force_group, 1}, {force_group, 1}, {moment_group, 1}};
  const Complex origin = linkage.crank.pivot;
  std::vector<BodyMotion> motion;
  std::array<std::vector<BodyLoad>, 3> powers;
  const auto fill = [&](Eigen::MatrixXd& samples, Index begin, Index step) {
    const Index N = samples.cols();
    const Eigen::MatrixXd applied = slider_force_samples(linkage, N);
    const std::vector<DeflectionSamples> deflections = deflection_samples(linkage, responses, N);
    for (Index j = begin; j < N; j += step) {
      motion_at(linkage, 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(N), motion);
      rigid_loads(linkage, motion, applied.col(j), powers);
      Eigen::Vector3d rigid = Eigen::Vector3d::Zero();
      double power = 1;
      for (const std::vector<BodyLoad>& loads : powers) {
        for (std::size_t b = 0; b < loads.size(); ++b) rigid -= power * about(loads[b], motion[b].z, origin);
        power *= speed;
      }
      for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
        const auto* slider = std::get_if<Slider>(&linkage.dyads[d].closing);
        if (slider == nullptr) continue;
        const Complex force = applied(static_cast<Index>(d), j) * std::polar(1.0, slider->direction);
        rigid -= about({force, 0}, motion[static_cast<std::size_t>(closing_index(static_cast<int>(d)))].z, origin);
      }
      Eigen::Vector3d elastic = rigid;
      for (const DeflectionSamples& rod : deflections)
        elastic -= about(deflection_load(linkage, motion, rod.link, speed, rod.integrals.col(j)),
                         motion[static_cast<std::size_t>(rod.link)].z, origin);
      samples.col(j).head<3>() = rigid;
      samples.col(j).tail<3>() = elastic;
    }
  };
  Index H = slider_force_harmonics(linkage);
  for (const LinkResponse& response : responses) H = std::max(H, response.q.num_harmonics());
  TurnSamplingOptions options{.tolerance = 1e-13};
  while (options.first < 2 * H + 2) options.first *= 2;
  options.last = std::max(options.last, 2 * options.first);
  const TurnSeries turn = sample_turn(components, fill, options);
  return {cut_rows(turn, 0, 3), cut_rows(turn, 3, 3)};
}

}  // namespace hb
