#include "tools/report/place_curves.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tools/output/json.hpp"
#include "tools/output/nonlinear_output.hpp"
#include "tools/report/mechanism_motion.hpp"
#include "tools/report/stress_field.hpp"

namespace hb::tools {
namespace {

const RodModel* rod_model(const SceneModel& model, const std::string& name) {
  const auto rod = std::ranges::find(model.rods, name, &RodModel::name);
  return rod == model.rods.end() ? nullptr : &*rod;
}

// w' of the modes kept, at places x and N angles.
Eigen::MatrixXd slopes(const FourierSeries& q, double length, const Eigen::VectorXd& x, Eigen::Index N) {
  const Eigen::MatrixXd samples = fourier::synthesise(q, N);
  Eigen::MatrixXd cosines(x.size(), samples.rows());
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    const double k = static_cast<double>(i + 1) * std::numbers::pi / length;
    cosines.col(i) = k * (k * x.array()).cos();
  }
  return cosines * samples;
}

// Smallest, then largest bending moment over the turn at equally spaced places: EJ w'', and EJ kappa = EJ w''/cos psi,
// sin psi = w', of the bent rod.
std::vector<double> moment_envelope(const SceneModel& model, const RodModel& rod, double speed, const FourierSeries& q,
                                    bool bent) {
  constexpr Eigen::Index places = 41;
  const Body& link = *body_at(*model.linkage(), rod.link);
  const RodCoefficients& coefficients = model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)];
  const Eigen::Index N = fourier::fast_length(std::max<Eigen::Index>(96, 4 * q.num_harmonics()));
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(places, 0, link.length);
  Eigen::MatrixXd moment = rod_field(link, coefficients, speed, q, x, N).bending_moment;
  if (bent) moment.array() /= (1 - slopes(q, link.length, x, N).array().square()).sqrt();
  const Eigen::VectorXd low = moment.rowwise().minCoeff(), high = moment.rowwise().maxCoeff();
  std::vector<double> values(low.begin(), low.end());
  values.insert(values.end(), high.begin(), high.end());
  return values;
}

bool is_known(const RodResult& rod) {
  return rod.reported && rod.steady && rod.steady->status != SteadyStatus::singular &&
         rod.steady->q.num_harmonics() >= 0;
}

}  // namespace

Json place_curves(const ReportPlace& place, ByteBlock& block) {
  const bool bent = place.motion.has_value();
  const int turns = bent ? place.motion->turns : 1;
  const SpeedResult shown = bent ? as_speed_result(*place.motion) : place.result;
  Json entry;
  entry["rods"] = Json::object();
  for (const RodResult& rod : shown.rods) {
    if (!is_known(rod)) continue;
    Json own;
    own["q"] = block.series(rod.steady->q);
    // Coefficients of the rod are series over one turn.
    const RodModel* model = rod_model(*place.model, rod.name);
    if (place.model->linkage() && model && rod.shape && turns == 1) {
      own["moment"] = block.floats(moment_envelope(*place.model, *model, shown.speed, rod.steady->q, bent));
      // The axial force of the bent motion is not that of the rigid mechanism.
      if (!bent && rod.stress && rod.stress->height_known)
        own["stress"] = stress_field(*body_at(*place.model->linkage(), rod.link),
                                     place.model->coefficients.rods[static_cast<std::size_t>(model->coefficients)],
                                     shown.speed, rod.steady->q, block);
    }
    const auto linear = std::ranges::find(place.result.rods, rod.name, &RodResult::name);
    if (bent && linear != place.result.rods.end() && is_known(*linear)) own["linear"] = block.series(linear->steady->q);
    entry["rods"][rod.name] = std::move(own);
  }
  if (shown.forces) {
    for (const JointForce& joint : shown.forces->joints) entry["joints"][joint.name] = block.series(joint.elastic);
    entry["torque"] = block.series(shown.forces->torque);
  }
  if (bent)
    if (Json frames = bent_frames_json(*place.model, *place.motion, block); !frames.is_null())
      entry["frames"] = std::move(frames);
  return entry;
}

}  // namespace hb::tools
