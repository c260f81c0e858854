#include "hb/analysis/slider_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/fourier/turn_sampling.hpp"
#include "lib/linkage/kinematics.hpp"

namespace hb {

FourierSeries SliderMotion::velocity() const {
  return FourierSeries(Eigen::MatrixXcd(speed * fourier::derivative(position).c));
}

FourierSeries SliderMotion::acceleration() const {
  return FourierSeries(Eigen::MatrixXcd(speed * speed * fourier::derivative(position, 2).c));
}

std::vector<SliderMotion> slider_motions(const Linkage& linkage, double speed) {
  std::vector<int> dyads;
  for (int d = 0; d < static_cast<int>(linkage.dyads.size()); ++d)
    if (std::holds_alternative<Slider>(linkage.dyads[static_cast<std::size_t>(d)].closing)) dyads.push_back(d);
  if (dyads.empty()) return {};
  const auto slider_of = [&](int d) -> const Slider& {
    return std::get<Slider>(linkage.dyads[static_cast<std::size_t>(d)].closing);
  };
  std::vector<BodyMotion> motion;
  const auto fill = [&](Eigen::MatrixXd& samples, Eigen::Index begin, Eigen::Index step) {
    const Eigen::Index N = samples.cols();
    for (Eigen::Index j = begin; j < N; j += step) {
      motion_at(linkage, 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(N), motion);
      for (std::size_t k = 0; k < dyads.size(); ++k) {
        const Slider& slider = slider_of(dyads[k]);
        const std::complex<double> along = std::polar(1.0, slider.direction);
        const std::complex<double> from = motion[static_cast<std::size_t>(closing_index(dyads[k]))].z - slider.guide;
        samples(static_cast<Eigen::Index>(k), j) = (std::conj(along) * from).real();
      }
    }
  };
  const TurnSeries turn = sample_turn(std::vector<TurnComponent>(dyads.size()), fill, {.tolerance = 1e-15});
  // What was cut off decays from the first coefficient left out, which counts (H + 1)^order times in a derivative.
  constexpr double cut_sum = 8;
  std::vector<SliderMotion> sliders;
  for (std::size_t k = 0; k < dyads.size(); ++k) {
    SliderMotion slider{slider_of(dyads[k]).name, cut_rows(turn, static_cast<Eigen::Index>(k), 1), speed};
    const double first_left = std::max(turn.tail, 1e-15) * slider.position.c.cwiseAbs().maxCoeff(),
                 per_order = speed * static_cast<double>(slider.position.num_harmonics() + 1);
    for (int order = 0; order < 3; ++order)
      slider.errors[static_cast<std::size_t>(order)] = cut_sum * first_left * std::pow(per_order, order);
    sliders.push_back(std::move(slider));
  }
  return sliders;
}

}  // namespace hb
