#include <fmt/format.h>

#include <algorithm>

#include "lib/constants.hpp"
#include "lib/scene/plausibility.hpp"
#include "lib/scene/sample_file.hpp"
#include "lib/scene/scene_parts.hpp"

namespace hb {

namespace {

void add(FourierSeries& sum, const FourierSeries& term) {
  if (term.num_components() == 0) return;
  if (sum.num_components() == 0) {
    sum = term;
    return;
  }
  if (term.num_harmonics() > sum.num_harmonics()) sum = fourier::resized(sum, term.num_harmonics());
  sum.c.leftCols(term.c.cols()) += term.c;
}

// The name of the value's column or its number; "" if the key is absent.
std::string column_of(const TableView& table) {
  const toml::node* node = table.node("column");
  if (!node) return "";
  if (const auto* number = node->as_integer()) return fmt::format("{}", number->get());
  const auto* name = node->as_string();
  if (name && !name->get().empty()) return name->get();
  table.problem("column", fmt::format("found {}, allowed the name of a column, or its number from 1", describe(*node)));
  return "";
}

// The unit of the file's values: the key's, else the one in the header, else the scene's own.
Unit unit_of_values(const TableView& table, const ColumnName* header, const Measure& measure, const Units& units) {
  const Unit own = base_unit(measure, units);
  if (const auto text = table.text("unit")) {
    const UnitText unit = parse_unit(*text);
    if (unit.unit && unit.unit->dimension == measure.dimension) return *unit.unit;
    table.problem("unit",
                  fmt::format("found {}, {}, allowed a unit of {}", describe(*table.node("unit")),
                              unit.unit ? words_of(unit.unit->dimension) : unit.problem, words_of(measure.dimension)));
    return own;
  }
  if (header == nullptr || header->unit.empty()) return own;
  const std::optional<Unit> unit = parse_unit(header->unit).unit;
  if (!unit) return own;  // a remark of another kind
  if (unit->dimension == measure.dimension) return *unit;
  throw SceneError(fmt::format("the column \"{}\" in {}, {}, allowed {}{}", printable(header->name, 40),
                               printable(header->unit, 40), words_of(unit->dimension), words_of(measure.dimension),
                               measure.dimension == dimension::force && unit->dimension == dimension::pressure
                                   ? " (pressure = { file, bore } turns a pressure into a force)"
                                   : ""));
}

// Values over one turn from the file of a force or pressure table, in the scene's unit, times `scale`.
FourierSeries from_file(const TableView& table, const Measure& measure, const std::string& quantity,
                        const SceneContext& context) {
  const std::string file = table.need_file("file");
  const std::string column = column_of(table);
  const double scale = table.number("scale", any_number).value_or(1);
  if (file.empty()) return {};
  try {
    const std::filesystem::path path = context.folder / file;
    NumberTable numbers =
        parse_table(read_text_file(path), path.string(), column.empty() ? 2 : 0, 3,
                    fmt::format(" (crank angle and {}; column = \"NAME\" takes one of more)", quantity));
    const ForceColumns columns = force_columns(numbers, column);
    const double angle_unit = angle_unit_of(numbers, columns.angle, context.angle_unit());
    const ColumnName* header =
        numbers.header.empty() ? nullptr : &numbers.header[static_cast<std::size_t>(columns.value)];
    const Unit unit = unit_of_values(table, header, measure, context.units), own = base_unit(measure, context.units);
    for (double& value : numbers.values.col(columns.value)) value = converted(value, unit, own);
    if (scale != 1) numbers.values.col(columns.value) *= scale;
    return sampled_series(
        numbers, columns.angle, {columns.value}, angle_unit, quantity, [&](const std::string& remark) {
          context.remarks.push_back(
              {Concern::seam, fmt::format("{}: {}", table.problems().place(*table.node("file")), table.path_of("file")),
               remark});
        });
  } catch (const SceneError& error) {
    table.problem("file", fmt::format("found \"{}\" with {}", printable(file, 100), error.what()));
    return {};
  }
}

FourierSeries by_harmonics(const TableView& slider, const TableView& table) {
  const std::vector<double> cos = table.numbers("cos", any_number).value_or(std::vector<double>());
  const std::vector<double> sin = table.numbers("sin", any_number).value_or(std::vector<double>());
  const std::size_t count = std::max(cos.size(), sin.size());
  if (count > max_harmonic + 1) {
    slider.problem("force", fmt::format("found {} harmonics, allowed at most {}", count - 1, max_harmonic));
    return {};
  }
  if (!sin.empty() && sin[0] != 0) {
    table.problem("sin", fmt::format("found {} first, allowed 0 (it belongs to harmonic 0)", sin[0]));
  }
  FourierSeries force(1, std::max<Eigen::Index>(1, static_cast<Eigen::Index>(count)) - 1);
  for (std::size_t k = 0; k < count; ++k) {
    force.c(0, static_cast<Eigen::Index>(k)) =
        harmonic_coefficient(int(k), k < cos.size() ? cos[k] : 0, k < sin.size() ? sin[k] : 0);
  }
  return force;
}

FourierSeries read_force(const TableView& slider, const SceneContext& context) {
  const toml::node* node = slider.node("force");
  if (!node) return {};
  if (!node->is_table()) {
    static constexpr Limits words{-largest_number, largest_number, true,
                                  "a number, { cos = [...], sin = [...] } or { file = \"...\" }"};
    FourierSeries force(1, 0);
    force.c(0, 0) = slider.number("force", words).value_or(0);
    return force.c(0, 0) == 0.0 ? FourierSeries() : force;
  }
  const TableView table = *slider.table("force");
  const bool by_terms = table.has("cos") || table.has("sin");
  if (by_terms == table.has("file")) {
    slider.problem("force", fmt::format("found {}, allowed either cos and sin or file",
                                        by_terms                ? "cos or sin beside file"
                                        : table.table().empty() ? "an empty table"
                                                                : "neither cos, sin nor file"));
    return {};
  }
  if (!by_terms) return from_file(table, {dimension::force}, "force", context);
  for (const char* key : {"column", "unit", "scale"}) {
    if (table.has(key)) table.problem(key, "found beside cos and sin, allowed beside file");
  }
  return by_harmonics(slider, table);
}

// Force along the direction, F = -branch p pi d^2/4: the position is branch * (something positive) from the foot of the
// perpendicular, and pressure pushes back.
FourierSeries read_pressure(const TableView& slider, int branch, const SceneContext& context) {
  const auto table = slider.table("pressure");
  if (!table) return {};
  const double bore = table->need_number("bore", positive);
  if (table->has("bore")) remark_on_bore(*table, bore, context);
  FourierSeries pressure = from_file(*table, {dimension::pressure}, "pressure", context);
  const auto mean = table->number("mean", any_number);
  if (pressure.num_components() == 0) return {};
  if (mean) pressure.c(0, 0) = *mean;
  pressure.c *= -branch * pi * bore * bore / 4;
  return pressure;
}

}  // namespace

FourierSeries read_slider_force(const TableView& slider, int branch, const SceneContext& context) {
  FourierSeries sum = read_force(slider, context);
  add(sum, read_pressure(slider, branch, context));
  return sum;
}

}  // namespace hb
