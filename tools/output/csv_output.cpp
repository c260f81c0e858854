#include "tools/output/csv_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "lib/linkage/kinematics.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/printable.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

constexpr Eigen::Index samples_per_turn = 360;
constexpr Eigen::Index shape_points = 101;  // along the rod

// Points of a table over the turn: a multiple of 360, at least six per period of the highest harmonic.
Eigen::Index table_samples(Eigen::Index num_harmonics) {
  return samples_per_turn * ((6 * num_harmonics + samples_per_turn - 1) / samples_per_turn + (num_harmonics == 0));
}

Eigen::VectorXd angles_in_degrees(Eigen::Index num_samples) {
  return Eigen::VectorXd::LinSpaced(num_samples + 1, 0, 360);
}

// Samples as rows, the first repeated at the end of the turn; an empty series is zero.
Eigen::MatrixXd over_turn(const FourierSeries& series, Eigen::Index num_samples) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(num_samples + 1, series.num_components());
  if (series.num_harmonics() >= 0) {
    rows.topRows(num_samples) = fourier::synthesise(series, num_samples).transpose();
    rows.row(num_samples) = rows.row(0);
  }
  return rows;
}

std::string about(const SceneModel& model, const SpeedResult& result, const std::string& what) {
  return fmt::format("{}, {}: {}", scene_name(model.scene), speed_text(result.speed, model.scene), what);
}

std::vector<std::string> comments(const SceneModel& model, const SpeedResult& result, const RodResult& rod,
                                  const std::string& what) {
  std::vector<std::string> lines = {about(model, result, rod.name + ", " + what)};
  if (rod.stability) lines.push_back(verdict_sentence(*rod.stability, result.speed, model.scene));
  return lines;
}

std::string meaning_of_q(const SceneModel& model) {
  return model.linkage() ? "q_i: amplitude of sin(i pi x/l)" : "q_i: unknown of the system";
}

CsvFile shape_csv(const SceneModel& model, const SpeedResult& result, const RodResult& rod, bool moment) {
  const OutputUnits units = output_units(model.scene);
  const Body& link = *body_at(*model.linkage(), rod.link);
  const auto model_rod =
      std::find_if(model.rods.begin(), model.rods.end(), [&](const RodModel& other) { return other.link == rod.link; });
  const RodCoefficients& coefficients = model.coefficients.rods[static_cast<std::size_t>(model_rod->coefficients)];
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(shape_points, 0, link.length);
  const Eigen::Index N = table_samples(rod.steady->q.num_harmonics());
  const RodField field = rod_field(link, coefficients, result.speed, rod.steady->q, x, N);
  const Eigen::MatrixXd values = moment ? Eigen::MatrixXd(field.bending_moment * units.moment) : field.w;
  const std::string quantity = moment ? "M" : "w", unit = moment ? "N m" : units.length;

  CsvFile file;
  file.name = file_name((moment ? "bending_moment_" : "deflection_") + rod.name) + ".csv";
  file.comment = comments(model, result, rod,
                          moment ? "bending moment EJ w'' along the rod, x from joint 0"
                                 : "deflection w along the rod, x from joint 0, across it");
  file.columns = {"x" + bracketed(units.length), quantity + " smallest" + bracketed(unit),
                  quantity + " largest" + bracketed(unit)};
  file.rows.resize(shape_points, 3 + shape_angles);
  file.rows.col(0) = x;
  file.rows.col(1) = values.rowwise().minCoeff();
  file.rows.col(2) = values.rowwise().maxCoeff();
  for (int k = 0; k < shape_angles; ++k) {
    file.columns.push_back(fmt::format("{} at {} deg{}", quantity, 360 * k / shape_angles, bracketed(unit)));
    file.rows.col(3 + k) = values.col(N * k / shape_angles);
  }
  return file;
}

}  // namespace

std::string csv_rows(const Eigen::MatrixXd& rows) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    for (Eigen::Index column = 0; column < rows.cols(); ++column) {
      fmt::format_to(out, "{}{}", column == 0 ? "" : ",", rows(row, column));
    }
    fmt::format_to(out, "\n");
  }
  return fmt::to_string(text);
}

std::string csv_text(const CsvFile& file) {
  std::string text;
  for (std::string line : file.comment) {
    line = printable(line);
    std::replace(line.begin(), line.end(), '\n', ' ');
    text += fmt::format("# {}\n", line);
  }
  text += fmt::format("{}\n", printable(fmt::format("{}", fmt::join(file.columns, ","))));
  return text + csv_rows(file.rows);
}

CsvFile response_csv(const SceneModel& model, const SpeedResult& result, const RodResult& rod) {
  const OutputUnits units = output_units(model.scene);
  const FourierSeries& q = rod.steady->q;
  const Eigen::Index I = q.num_components(), N = table_samples(q.num_harmonics());
  CsvFile file;
  file.name = file_name("response_" + rod.name) + ".csv";
  file.comment = comments(model, result, rod, "periodic response over one turn. " + meaning_of_q(model));
  file.columns.push_back("crank angle [deg]");
  const std::string rate = (units.response.empty() ? "1" : units.response) + "/" + units.time;
  for (Eigen::Index i = 1; i <= I; ++i) file.columns.push_back(fmt::format("q_{}{}", i, bracketed(units.response)));
  for (Eigen::Index i = 1; i <= I; ++i) file.columns.push_back(fmt::format("dq_{}/dt{}", i, bracketed(rate)));
  file.rows.resize(N + 1, 1 + 2 * I);
  file.rows << angles_in_degrees(N), over_turn(q, N), result.speed * over_turn(fourier::derivative(q), N);
  return file;
}

CsvFile fourier_csv(const SceneModel& model, const SpeedResult& result, const RodResult& rod) {
  const OutputUnits units = output_units(model.scene);
  const FourierSeries& q = rod.steady->q;
  const Eigen::Index I = q.num_components(), H = q.num_harmonics();
  CsvFile file;
  file.name = file_name("fourier_" + rod.name) + ".csv";
  file.comment = comments(model, result, rod, "Fourier coefficients. " + meaning_of_q(model));
  file.comment.push_back("q_i(t) = sum over n of c_n exp(i n Omega t), c_-n = conj c_n; amplitude: |c_0| and 2 |c_n|");
  file.columns.push_back("n");
  file.rows.resize(H + 1, 1 + 3 * I);
  file.rows.col(0) = Eigen::VectorXd::LinSpaced(H + 1, 0, static_cast<double>(H));
  for (Eigen::Index i = 0; i < I; ++i) {
    for (const char* part : {"re", "im", "amplitude"}) {
      file.columns.push_back(fmt::format("{} of q_{}{}", part, i + 1, bracketed(units.response)));
    }
    file.rows.col(1 + 3 * i) = q.c.row(i).real().transpose();
    file.rows.col(2 + 3 * i) = q.c.row(i).imag().transpose();
    file.rows.col(3 + 3 * i) = 2 * q.c.row(i).cwiseAbs().transpose();
    file.rows(0, 3 + 3 * i) /= 2;
  }
  return file;
}

CsvFile exponents_csv(const SceneModel& model, const SpeedResult& result, const RodResult& rod) {
  const OutputUnits units = output_units(model.scene);
  const std::vector<Exponent>& exponents = rod.stability->exponents;
  CsvFile file;
  file.name = file_name("exponents_" + rod.name) + ".csv";
  file.comment = comments(model, result, rod, "Floquet exponents, imaginary part folded to (-Omega/2, Omega/2]");
  file.columns = {"real" + bracketed(units.rate), "imaginary" + bracketed(units.rate), "error" + bracketed(units.rate)};
  file.rows.resize(static_cast<Eigen::Index>(exponents.size()), 3);
  for (std::size_t k = 0; k < exponents.size(); ++k) {
    file.rows.row(static_cast<Eigen::Index>(k)) << exponents[k].value.real(), exponents[k].value.imag(),
        exponents[k].error;
  }
  return file;
}

CsvFile forces_csv(const SceneModel& model, const SpeedResult& result) {
  const OutputUnits units = output_units(model.scene);
  const std::vector<JointForce>& joints = result.forces->joints;
  Eigen::Index H = 0, num_columns = 1;
  for (const JointForce& joint : joints) {
    H = std::max({H, joint.rigid.num_harmonics(), joint.elastic.num_harmonics()});
    num_columns += 2 * joint.rigid.num_components();
  }
  const Eigen::Index N = table_samples(H);
  CsvFile file;
  file.name = "joint_forces.csv";
  file.comment = {about(model, result, "joint forces over one turn, elastic beside rigid"),
                  force_frames(elastic_rockers(*model.linkage())) +
                      "; LINK.1 acts on the link, LINK.0 is passed on to "
                      "the link before it, pivots and guides act on their link"};
  file.columns.push_back("crank angle [deg]");
  file.rows.resize(N + 1, num_columns);
  file.rows.col(0) = angles_in_degrees(N);
  Eigen::Index column = 1;
  for (const JointForce& joint : joints) {
    const Eigen::MatrixXd elastic = over_turn(joint.elastic, N), rigid = over_turn(joint.rigid, N);
    for (Eigen::Index c = 0; c < rigid.cols(); ++c) {
      const char* component = rigid.cols() == 1 ? "n" : c == 0 ? "x" : "y";
      file.columns.push_back(fmt::format("{} {} [N]", joint.name, component));
      file.rows.col(column++) = units.force * elastic.col(c);
      file.columns.push_back(fmt::format("{} {} rigid [N]", joint.name, component));
      file.rows.col(column++) = units.force * rigid.col(c);
    }
  }
  return file;
}

CsvFile torque_csv(const SceneModel& model, const SpeedResult& result) {
  const OutputUnits units = output_units(model.scene);
  const JointForces& forces = *result.forces;
  const Eigen::Index N = table_samples(std::max(forces.torque.num_harmonics(), forces.torque_rigid.num_harmonics()));
  CsvFile file;
  file.name = "torque.csv";
  file.comment = {about(model, result, "driving torque on the crank over one turn, elastic beside rigid")};
  file.columns = {"crank angle [deg]", "torque [N m]", "torque rigid [N m]"};
  file.rows.resize(N + 1, 3);
  file.rows << angles_in_degrees(N), units.moment * over_turn(forces.torque, N),
      units.moment * over_turn(forces.torque_rigid, N);
  return file;
}

CsvFile deflection_csv(const SceneModel& model, const SpeedResult& result, const RodResult& rod) {
  return shape_csv(model, result, rod, false);
}

CsvFile bending_moment_csv(const SceneModel& model, const SpeedResult& result, const RodResult& rod) {
  return shape_csv(model, result, rod, true);
}

std::vector<TracedPoint> traced_points(const Linkage& linkage) {
  std::vector<TracedPoint> points;
  const auto add_named = [&](const std::map<std::string, std::complex<double>>& named, const std::string& body_name,
                             int body) {
    for (const auto& [name, point] : named) points.push_back({body_name + "." + name, body, point, false});
  };
  const auto add_body = [&](const Body& body, int number, const char* joint0, bool fixed) {
    points.push_back({body.name + joint0, number, 0, fixed});
    points.push_back({body.name + ".1", number, body.length, false});
    add_named(body.points, body.name, number);
  };
  add_body(linkage.crank.body, 0, ".pivot", true);
  for (int d = 0; d < static_cast<int>(linkage.dyads.size()); ++d) {
    const Dyad& dyad = linkage.dyads[static_cast<std::size_t>(d)];
    add_body(dyad.coupler, coupler_index(d), ".0", false);
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
      add_body(rocker->body, closing_index(d), ".pivot", true);
    } else {
      const Slider& slider = std::get<Slider>(dyad.closing);
      points.push_back({slider.name, closing_index(d), 0, false});
      add_named(slider.points, slider.name, closing_index(d));
    }
  }
  return points;
}

CsvFile mechanism_csv(const Scene& scene) {
  const Linkage& linkage = std::get<Linkage>(scene.model);
  const std::string unit = bracketed(scene.units.length);
  const std::vector<TracedPoint> points = traced_points(linkage);
  CsvFile file;
  file.name = "mechanism.csv";
  file.comment = {scene_name(scene) + ": positions of joints and points over one turn"};
  file.columns.push_back("crank angle [deg]");
  for (const TracedPoint& point : points) {
    file.columns.push_back(point.name + " x" + unit);
    file.columns.push_back(point.name + " y" + unit);
  }
  file.rows.resize(samples_per_turn + 1, 1 + 2 * static_cast<Eigen::Index>(points.size()));
  file.rows.col(0) = angles_in_degrees(samples_per_turn);
  std::vector<BodyMotion> motion;
  for (Eigen::Index j = 0; j <= samples_per_turn; ++j) {
    motion_at(linkage, file.rows(j, 0) / degrees_per_radian, motion);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::complex<double> z = motion[static_cast<std::size_t>(points[k].body)].position(points[k].point);
      const auto column = 1 + 2 * static_cast<Eigen::Index>(k);
      file.rows(j, column) = z.real();
      file.rows(j, column + 1) = z.imag();
    }
  }
  return file;
}

}  // namespace hb::tools
