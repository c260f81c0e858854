#include "tools/report/mechanism_motion.hpp"

#include <nlohmann/json.hpp>
#include <numbers>

#include "lib/exact/exact_model.hpp"
#include "lib/linkage/kinematics.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/json.hpp"

namespace hb::tools {

namespace {

// Series over the period of frames at equally spaced angles, one for each body.
std::vector<Json> frame_series(const std::vector<std::vector<BodyMotion>>& frames, ByteBlock& block) {
  const std::size_t bodies = frames.front().size();
  Eigen::MatrixXd samples(static_cast<Eigen::Index>(4 * bodies), static_cast<Eigen::Index>(frames.size()));
  for (std::size_t j = 0; j < frames.size(); ++j)
    for (std::size_t b = 0; b < bodies; ++b) {
      const BodyMotion& frame = frames[j][b];
      samples.col(static_cast<Eigen::Index>(j)).segment<4>(static_cast<Eigen::Index>(4 * b)) << frame.z.real(),
          frame.z.imag(), frame.e.real(), frame.e.imag();
    }
  const FourierSeries all = fourier::analyse(samples);
  std::vector<Json> series;
  for (std::size_t b = 0; b < bodies; ++b)
    series.push_back(
        block.series(FourierSeries(Eigen::MatrixXcd(all.c.middleRows(static_cast<Eigen::Index>(4 * b), 4))), 1e-6));
  return series;
}

}  // namespace

Json motion_json(const Linkage& linkage, ByteBlock& block) {
  constexpr std::size_t num_angles = 1024;
  const int bodies = linkage.num_bodies();
  std::vector<std::vector<BodyMotion>> frames(num_angles);
  for (std::size_t j = 0; j < num_angles; ++j)
    motion_at(linkage, 2 * std::numbers::pi * static_cast<double>(j) / num_angles, frames[j]);
  std::vector<Json> series = frame_series(frames, block);
  Json json;
  json["bodies"] = Json::array();
  const std::vector<TracedPoint> points = traced_points(linkage);
  for (int b = 0; b < bodies; ++b) {
    const Body* body = body_at(linkage, b);
    Json entry = {{"name", body_name(linkage, b)}};
    if (body == nullptr) {
      entry["slider"] = true;
    } else {
      entry["length"] = body->length;
      entry["elastic"] = body->elastic.has_value();
    }
    entry["frame"] = std::move(series[static_cast<std::size_t>(b)]);
    for (const TracedPoint& point : points)
      if (point.body == b)
        entry["points"].push_back(
            {{"name", point.name}, {"at", {point.point.real(), point.point.imag()}}, {"fixed", point.fixed}});
    json["bodies"].push_back(std::move(entry));
  }
  for (const Dyad& dyad : linkage.dyads)
    if (const auto* slider = std::get_if<Slider>(&dyad.closing))
      json["guides"].push_back(
          {{"at", {slider->guide.real(), slider->guide.imag()}}, {"direction", slider->direction}});
  return json;
}

Json bent_frames_json(const SceneModel& model, const NonlinearResult& motion, ByteBlock& block) {
  std::vector<ExactModel::Rod> modes;
  std::vector<FourierSeries> q;
  for (const NonlinearRod& rod : motion.rods) {
    modes.push_back({rod.link, rod.q.num_components()});
    q.push_back(rod.q);
  }
  if (q.empty()) return nullptr;
  const ExactModel exact(*model.linkage(), modes);
  Eigen::Index num_angles = 512 * motion.turns;
  while (num_angles < 4 * motion.motion.q.num_harmonics()) num_angles *= 2;
  const ExactModel::Forces all = exact.forces(motion.speed, CrankAngles(*model.linkage(), num_angles, motion.turns),
                                              ritz_samples(q, motion.speed, num_angles, motion.turns));
  if (all.breakdown) return nullptr;
  return frame_series(all.motion, block);
}

}  // namespace hb::tools
