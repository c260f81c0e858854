#include "lib/scene/sample_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "lib/constants.hpp"
#include "lib/fourier/periodic_samples.hpp"
#include "lib/scene/quantity.hpp"
#include "lib/scene/scene.hpp"
#include "lib/scene/scene_reader.hpp"

namespace hb {

using Eigen::Index;

namespace {

// Angles are often rounded to a few decimals: they are compared to a small part of the spacing.
constexpr double closing = 0.01, even = 0.005;
// The closing row repeats the first to this part of the column's largest value.
constexpr double same = 1e-6;

// Up to 4096 harmonics each.
constexpr Index max_splines = 900;

std::string place(const NumberTable& table, Index row) {
  return fmt::format("{}:{}", table.name, table.lines[static_cast<std::size_t>(row)]);
}

[[noreturn]] void fail(const NumberTable& table, Index row, const std::string& message) {
  throw SceneError(fmt::format("{}: {}", place(table, row), message));
}

// Column of the first value of row `a` that row `b` does not repeat; nothing if it repeats all.
std::optional<Index> difference(const NumberTable& table, const std::vector<Index>& columns, Index a, Index b) {
  for (const Index column : columns) {
    const double largest = table.values.col(column).cwiseAbs().maxCoeff();
    if (!(std::abs(table.values(a, column) - table.values(b, column)) <= same * largest)) return column;
  }
  return std::nullopt;
}

std::string column_text(const NumberTable& table, Index column) {
  if (table.header.empty()) return fmt::format("column {}", column + 1);
  return "column " + printable(table.header[static_cast<std::size_t>(column)].name, 40);
}

// What else the angles may be in, where they span a turn of that: "; angles in deg are told by ...", or nothing.
std::string angle_unit_hint(const Eigen::Ref<const Eigen::VectorXd>& angle, double angle_unit) {
  struct Turn {
    const char* name;
    double size;
  };
  const Index n = angle.size();
  const double span = angle(n - 1) - angle(0);
  for (const Turn& turn : {Turn{"deg", 360}, Turn{"rad", 2 * pi}, Turn{"rev", 1}}) {
    const double turns = std::max(1.0, std::round(span / turn.size));  // of two-turn cycles too
    const bool closes = turns <= 2 && std::abs(span - turns * turn.size) <= 1.5 * turns * turn.size / double(n);
    if (closes && std::abs(2 * pi / turn.size - angle_unit) > 0.01 * angle_unit)
      return fmt::format("; angles in {0} are told by the column's name in a first line: angle [{0}]", turn.name);
  }
  return "";
}

// Rows of one turn: all, or all but a last one that repeats the first.
Index rows_of_a_turn(const NumberTable& table, Index angle_column, const std::vector<Index>& columns, double angle_unit,
                     const std::string& quantity) {
  const auto angle = table.values.col(angle_column);
  const Index n = angle.size();
  for (Index j = 1; j < n; ++j) {
    if (!((angle(j) - angle(j - 1)) * angle_unit >= 1e-9)) {
      fail(table, j,
           fmt::format("found crank angle {} after {}, allowed strictly increasing angles", angle(j), angle(j - 1)));
    }
  }
  const double turn = 2 * pi, span = (angle(n - 1) - angle(0)) * angle_unit;
  if (std::abs(span - turn) <= closing * turn / double(n)) {
    const auto other = difference(table, columns, n - 1, 0);
    if (!other) return n - 1;
    fail(table, n - 1,
         fmt::format("found {} one turn after {}, allowed the same {}", table.values(n - 1, *other),
                     table.values(0, *other), quantity));
  }
  if (span < turn) return n;
  const double per_turn = turn / angle_unit;
  const bool two_turns = std::abs(span - 2 * turn) <= 2 * turn / double(n) * (1 + closing);
  if (two_turns) {
    fail(table, n - 1,
         fmt::format("found crank angles over two turns (to {}, a four-stroke cycle), allowed one turn of {:.6g}: what "
                     "acts on the linkage must repeat with every turn of the crank; the mean of both turns at each "
                     "angle may stand for it, without what differs between them (half orders of the speed)",
                     angle(n - 1), per_turn));
  }
  fail(
      table, n - 1,
      fmt::format("found crank angle {}, allowed angles less than one turn ({:.6g} in their unit) after the first, {}, "
                  "or one last row a turn after it that repeats its {}{}",
                  angle(n - 1), per_turn, angle(0), quantity, angle_unit_hint(angle, angle_unit)));
}

void refuse_gaps(const NumberTable& table, const Eigen::VectorXd& angles, const std::string& hint) {
  const Index n = angles.size();
  double widest = angles(0) + 2 * pi - angles(n - 1);
  Index after = n - 1;
  for (Index j = 1; j < n; ++j) {
    if (angles(j) - angles(j - 1) > widest) widest = angles(j) - angles(j - 1), after = j - 1;
  }
  if (widest <= 2 * pi / 3 * (1 + closing)) return;
  fail(table, after,
       fmt::format("found {} without a row behind this one, allowed rows all over one turn{}",
                   widest >= pi * (1 - closing) ? "half a turn or more" : "more than a third of a turn", hint));
}

// A step from the last row back to the first that is much larger than any other: a table that is no whole turn.
void remark_on_seam(const NumberTable& table, const std::vector<Index>& columns, Index n, const SampleRemark& remark) {
  if (n < 6) return;
  for (const Index column : columns) {
    const auto value = table.values.col(column);
    double largest = 0;
    for (Index j = 1; j < n; ++j) largest = std::max(largest, std::abs(value(j) - value(j - 1)));
    const double seam = std::abs(value(0) - value(n - 1));
    if (!(seam > 3 * largest) || !(seam > same * value.head(n).cwiseAbs().maxCoeff())) continue;
    remark(
        fmt::format("{}: found a jump at the seam, {:.4g} from the last row back to the first in {} where others "
                    "differ by {:.4g} at most, allowed; taken as it stands: do the rows span one turn, and is no "
                    "column an angle, a time or a number of the row?",
                    place(table, n - 1), seam, column_text(table, column), largest));
    return;
  }
}

}  // namespace

FourierSeries sampled_series(const NumberTable& table, std::optional<Index> angle_column,
                             const std::vector<Index>& columns, double angle_unit, const std::string& quantity,
                             const SampleRemark& remark) {
  const double turn = 2 * pi;
  Index n = table.values.rows();
  Eigen::VectorXd angles;
  if (angle_column) {
    n = rows_of_a_turn(table, *angle_column, columns, angle_unit, quantity);
    if (n < 3) fail(table, n - 1, fmt::format("found {} different angles, allowed at least 3", n));
    angles = table.values.col(*angle_column).head(n) * angle_unit;
    refuse_gaps(table, angles, angle_unit_hint(table.values.col(*angle_column).head(n), angle_unit));
  } else if (n > 3 && !difference(table, columns, n - 1, 0)) {
    const bool constant = [&] {
      for (Index j = 1; j < n; ++j) {
        if (difference(table, columns, j, 0)) return false;
      }
      return true;
    }();
    --n;
    if (!constant) {
      remark(
          fmt::format("{}: found a last row that repeats the first, allowed; left out as the first row of the next "
                      "turn (a column of angles tells if it is not)",
                      place(table, n)));
    }
  }
  remark_on_seam(table, columns, n, remark);

  Eigen::MatrixXd values(static_cast<Index>(columns.size()), n);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    values.row(static_cast<Index>(i)) = table.values.col(columns[i]).head(n).transpose();
  }
  if (!angle_column) return interpolate(values);
  const double step = turn / double(n);
  double uneven = 0;
  for (Index j = 0; j < n; ++j) uneven = std::max(uneven, std::abs(angles(j) - angles(0) - double(j) * step));
  if (uneven <= even * step) return interpolate(values, angles(0));
  if (values.rows() > max_splines) {
    fail(table, n - 1,
         fmt::format("found angles of unequal spacing for {} entries, allowed for at most {}", values.rows(),
                     max_splines));
  }
  FourierSeries all(values.rows(), 0);
  for (Index i = 0; i < values.rows(); ++i) {
    const FourierSeries one = spline_series(angles, values.row(i).transpose());
    if (one.num_harmonics() > all.num_harmonics()) all = fourier::resized(all, one.num_harmonics());
    all.c.row(i).head(one.c.cols()) = one.c.row(0);
  }
  return all;
}

double angle_unit_of(const NumberTable& table, std::optional<Index> angle_column, double angle_unit) {
  if (!angle_column || table.header.empty()) return angle_unit;
  const auto unit = parse_unit(table.header[static_cast<std::size_t>(*angle_column)].unit).unit;
  return unit && unit->dimension == dimension::angle ? size_of(*unit) : angle_unit;
}

namespace {

std::string lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  return text;
}

bool names_angle(const ColumnName& column) {
  const std::string name = lower(column.name);
  return name.find("angle") != std::string::npos || name == "tau" || name == "phi";
}

std::optional<Index> index_from_one(std::string_view digits, Index size) {
  Index value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || value < 1 || value > size) return std::nullopt;
  return value - 1;
}

// "k12", "K_1_2", "k10_3" of a matrix, "h1", "load_2" of a vector: the letters and what follows them.
struct EntryName {
  std::string letters, indices;
};
std::optional<EntryName> entry_name(const ColumnName& column) {
  const std::string name = lower(column.name);
  const std::size_t first = name.find_first_of("0123456789");
  if (first == 0 || first == std::string::npos) return std::nullopt;
  if (name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_ ") < first) return std::nullopt;
  if (name.find_first_not_of("0123456789_", first) != std::string::npos) return std::nullopt;
  std::string letters = name.substr(0, first);
  while (letters.size() > 1 && (letters.back() == '_' || letters.back() == ' ')) letters.pop_back();
  return EntryName{letters, name.substr(first)};
}

// Component of a column-major matrix or of a vector.
std::optional<Index> component_of(const std::string& indices, Index size, bool matrix) {
  if (!matrix) return index_from_one(indices, size);
  const std::size_t gap = indices.find('_');
  if (gap == std::string::npos && indices.size() != 2) return std::nullopt;
  const std::string_view all = indices;
  const auto i = index_from_one(gap == std::string::npos ? all.substr(0, 1) : all.substr(0, gap), size);
  const auto k = index_from_one(gap == std::string::npos ? all.substr(1) : all.substr(gap + 1), size);
  if (!i || !k) return std::nullopt;
  return *i + size * *k;
}

std::string entry_words(Index size, bool matrix) {
  if (size == 1) return "angle and one more";
  if (!matrix) return fmt::format("angle, h1 to h{}", size);
  return fmt::format("angle, k11, k12, ... k{0}{1}{0}", size, size > 9 ? "_" : "");
}

[[noreturn]] void refuse_column(const NumberTable& table, const std::string& found, const std::string& allowed) {
  throw SceneError(fmt::format("{}: found {}, allowed {}", table.name, found, allowed));
}

SampleColumns columns_by_name(const NumberTable& table, Index size, bool matrix) {
  SampleColumns result;
  const Index count = matrix ? size * size : size;
  std::vector<std::optional<Index>> found(static_cast<std::size_t>(count));
  std::string letters;
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    const ColumnName& column = table.header[c];
    const std::string shown = fmt::format("the column \"{}\"", printable(column.name, 40));
    if (names_angle(column)) {
      if (result.angle) refuse_column(table, shown + ", a second one of angles", entry_words(size, matrix));
      result.angle = static_cast<Index>(c);
      continue;
    }
    const auto entry = entry_name(column);
    std::optional<Index> component = entry ? component_of(entry->indices, size, matrix) : std::nullopt;
    if (!component && size == 1) component = 0;
    if (!component) refuse_column(table, shown, entry_words(size, matrix));
    if (entry && !letters.empty() && letters != entry->letters)
      refuse_column(table, fmt::format("{} beside columns of {}", shown, letters), "entries of one name");
    if (entry) letters = entry->letters;
    auto& place = found[static_cast<std::size_t>(*component)];
    if (place) refuse_column(table, shown + " for an entry that another column gives", "one column for each entry");
    place = static_cast<Index>(c);
  }
  const std::string name = letters.empty() ? (matrix ? "k" : "h") : letters;
  for (Index k = 0; k < count; ++k) {
    const Index row = k % size, column = matrix ? k / size : 0;
    auto at = found[static_cast<std::size_t>(k)];
    if (!at && matrix) at = found[static_cast<std::size_t>(column + size * row)];  // the mirror image
    if (!at) {
      refuse_column(table,
                    fmt::format("no column {}{}", name,
                                matrix ? fmt::format("{}{}{}", row + 1, size > 9 ? "_" : "", column + 1)
                                       : fmt::format("{}", row + 1)),
                    matrix ? "all entries, or those of one half and the diagonal" : "all entries");
    }
    result.components.push_back(*at);
  }
  return result;
}

// Equally spaced values: angles or row numbers where entries should be.
bool is_even_ramp(const Eigen::Ref<const Eigen::VectorXd>& values) {
  const Index n = values.size();
  const double step = (values(n - 1) - values(0)) / double(n - 1);
  if (n < 3 || step == 0) return false;
  for (Index j = 0; j < n; ++j) {
    if (!(std::abs(values(j) - values(0) - double(j) * step) <= even * std::abs(step))) return false;
  }
  return true;
}

// Over exactly one turn, its closing row or not.
bool spans_a_turn(const Eigen::Ref<const Eigen::VectorXd>& values) {
  const Index n = values.size();
  const double step = (values(n - 1) - values(0)) / double(n - 1);
  for (const double turn : {1.0, 2 * pi, 360.0}) {
    for (const Index cells : {n - 1, n}) {
      if (std::abs(std::abs(step) * double(cells) - turn) <= closing * turn / double(cells)) return true;
    }
  }
  return false;
}

}  // namespace

SampleColumns sample_columns(const NumberTable& table, Index size, bool matrix) {
  const auto decides = [&](const ColumnName& column) {
    const auto entry = entry_name(column);
    return names_angle(column) || (entry && component_of(entry->indices, size, matrix));
  };
  if (std::ranges::any_of(table.header, decides)) return columns_by_name(table, size, matrix);

  const Index columns = table.values.cols(), count = matrix ? size * size : size;
  if (columns > 1 && is_even_ramp(table.values.col(0))) {
    const bool angles = spans_a_turn(table.values.col(0));
    const double first = table.values(0, 0);
    constexpr Index no_coincidence = 12;  // rows
    const bool numbers =
        table.values.rows() >= no_coincidence && (first == 0 || first == 1) && table.values(1, 0) == first + 1;
    if (angles || numbers)
      fail(table, 0,
           fmt::format("found {} in the first column, allowed columns named in a first line ({}), or all entries{} "
                       "over one period without a column of angles",
                       angles ? "angles" : "row numbers", entry_words(size, matrix), matrix ? " row by row" : ""));
  }
  if (columns != count) {
    fail(table, 0,
         fmt::format("found {}, allowed {} in a row (all entries{}, no angle), or columns named in a first line ({})",
                     counted(columns, "field"), counted(count, "number"), matrix ? " row by row" : "",
                     entry_words(size, matrix)));
  }
  SampleColumns result;
  for (Index k = 0; k < count; ++k) result.components.push_back(matrix ? size * (k % size) + k / size : k);
  return result;
}

ForceColumns force_columns(const NumberTable& table, const std::string& column) {
  ForceColumns result;
  const auto named = std::ranges::find_if(table.header, names_angle);
  if (named != table.header.end()) result.angle = named - table.header.begin();
  const Index count = table.values.cols();
  if (column.empty()) {
    result.value = 1 - result.angle;
    return result;
  }
  std::vector<std::string> names;
  std::optional<Index> found = index_from_one(column, count);
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    names.push_back(table.header[c].name);
    if (lower(names.back()) == lower(column)) found = static_cast<Index>(c);
  }
  const std::string allowed =
      names.empty() ? fmt::format("the number of a column, 1 to {}", count) : "one of the columns " + joined(names);
  if (!found) refuse_column(table, fmt::format("no column \"{}\"", printable(column, 40)), allowed);
  if (*found == result.angle) refuse_column(table, fmt::format("the angles as column \"{}\"", column), allowed);
  result.value = *found;
  return result;
}

}  // namespace hb
