#include "tools/pictures/measured.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lib/scene/quantity.hpp"
#include "lib/scene/scene_reader.hpp"
#include "lib/scene/table_file.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/work/errors.hpp"

namespace hb::tools {
namespace {

std::string names_of(const std::vector<MeasuredQuantity>& quantities) {
  constexpr std::size_t most = 24;
  std::string text;
  for (std::size_t k = 0; k < std::min(most, quantities.size()); ++k) text += (k == 0 ? "" : ", ") + quantities[k].name;
  return text + (quantities.size() > most ? ", ..." : "");
}

// The key that a stress lacks, where there is such a link.
std::string without_section(const std::string& name, const std::vector<MeasuredQuantity>& allowed) {
  if (!name.starts_with("stress ")) return "";
  const std::string rod = name.substr(7);
  if (std::ranges::find(allowed, "deflection " + rod, &MeasuredQuantity::name) == allowed.end()) return "";
  return fmt::format("; a stress of {0} needs {0}.section", rod);
}

// Factor from the header's unit to the one shown.
double to_shown(const std::string& file, const ColumnName& column, const std::string& shown) {
  if (column.unit.empty() || column.unit == shown) return 1;
  const UnitText own = parse_unit(column.unit);
  const std::optional<Unit> wanted = shown.empty() ? std::nullopt : parse_unit(shown).unit;
  if (own.unit && wanted && own.unit->dimension == wanted->dimension) return converted(1, *own.unit, *wanted);
  throw UsageError(fmt::format("--measured: {}: found the unit {} of {}, allowed: {}", file, column.unit, column.name,
                               shown.empty() ? "none" : shown + ", or another unit of that kind"));
}

}  // namespace

int MeasuredOverlay::column(const std::string& quantity) const {
  for (std::size_t k = 1; k < csv_.columns.size(); ++k)
    if (csv_.columns[k] == quantity) return static_cast<int>(k) + 1;
  return 0;
}

void MeasuredOverlay::add_column(const std::string& name, const Eigen::VectorXd& values) {
  csv_.columns.push_back(name);
  csv_.rows.conservativeResize(Eigen::NoChange, csv_.rows.cols() + 1);
  csv_.rows.rightCols(1) = values;
}

std::string MeasuredOverlay::layer(const std::string& quantity, bool in_key) const {
  const int at = column(quantity);
  if (at == 0) return "";
  return fmt::format(", '{}' using 1:{} with points pointtype 6 pointsize 0.7 linecolor rgb '#000000' {}", csv_.name,
                     at, in_key ? "title 'measured'" : "notitle");
}

std::string MeasuredOverlay::note(const std::vector<std::string>& quantities) const {
  const bool any = std::ranges::any_of(quantities, [&](const std::string& name) { return column(name) > 0; });
  return any ? "; circles: measured" : "";
}

std::vector<double> MeasuredOverlay::values(const std::string& quantity) const {
  std::vector<double> found;
  if (const int at = column(quantity); at > 0)
    for (Eigen::Index k = 0; k < csv_.rows.rows(); ++k) found.push_back(csv_.rows(k, at - 1));
  return found;
}

MeasuredOverlay read_measured(const std::string& file, const MeasuredQuantity& axis,
                              const std::vector<MeasuredQuantity>& allowed) {
  const NumberTable table = parse_table(read_text_file(file), file, 0, 1);
  if (table.header.empty())
    throw UsageError(fmt::format("--measured: {}: found no header line, allowed: a first line of names, as in {}{},{}",
                                 file, axis.name, axis.unit.empty() ? "" : " [" + axis.unit + "]",
                                 allowed.empty() ? "" : allowed.front().name + " [" + allowed.front().unit + "]"));
  CsvFile csv;
  csv.name = "measured.csv";
  csv.comment = {"measured: " + file + ", in the units of the pictures: " + axis.name};
  csv.columns = {axis.name};
  csv.rows = table.values;
  csv.rows.col(0) *= to_shown(file, table.header[0], axis.unit);
  for (std::size_t k = 1; k < table.header.size(); ++k) {
    const ColumnName& column = table.header[k];
    const auto known = std::ranges::find(allowed, column.name, &MeasuredQuantity::name);
    if (known == allowed.end())
      throw UsageError(fmt::format("--measured: {}: found the column \"{}\", allowed: {}{}", file, column.name,
                                   names_of(allowed), without_section(column.name, allowed)));
    csv.columns.push_back(known->name);
    csv.comment.front() += ", " + known->name + (known->unit.empty() ? "" : " [" + known->unit + "]");
    csv.rows.col(static_cast<Eigen::Index>(k)) *= to_shown(file, column, known->unit);
  }
  return MeasuredOverlay(std::move(csv));
}

}  // namespace hb::tools
