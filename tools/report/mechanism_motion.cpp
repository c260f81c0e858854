#include "tools/report/mechanism_motion.hpp"

#include <nlohmann/json.hpp>
#include <numbers>

#include "lib/linkage/kinematics.hpp"
#include "tools/output/csv_output.hpp"

namespace hb::tools {

using Json = nlohmann::ordered_json;

Json motion_json(const Linkage& linkage, ByteBlock& block) {
  constexpr Eigen::Index num_angles = 1024;
  const int bodies = linkage.num_bodies();
  Eigen::MatrixXd samples(4 * bodies, num_angles);
  std::vector<BodyMotion> frames;
  for (Eigen::Index j = 0; j < num_angles; ++j) {
    motion_at(linkage, 2 * std::numbers::pi * static_cast<double>(j) / num_angles, frames);
    for (int b = 0; b < bodies; ++b) {
      const BodyMotion& frame = frames[static_cast<std::size_t>(b)];
      samples.col(j).segment<4>(4 * b) << frame.z.real(), frame.z.imag(), frame.e.real(), frame.e.imag();
    }
  }
  const FourierSeries all = fourier::analyse(samples);
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
    entry["frame"] = block.series(FourierSeries(Eigen::MatrixXcd(all.c.middleRows(4 * b, 4))), 1e-6);
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

}  // namespace hb::tools
