#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "lib/scene/sample_file.hpp"
#include "lib/scene/scene_parts.hpp"

namespace hb {

namespace {

constexpr Eigen::Index max_size = 400;
// Coefficients of one series, c_0..c_H of all components: 64 MB.
constexpr Eigen::Index max_coefficients = 4'000'000;

// A matrix [[..], ..] or a vector [..] of the wanted size (rows x columns; rows < 0: any square), as `columns` = 1 for
// a vector. Notes problems and returns nothing if it is something else.
std::optional<Eigen::MatrixXd> read_matrix(const TableView& table, std::string_view key, Eigen::Index size) {
  const toml::node* node = table.node(key);
  if (!node) return std::nullopt;
  const std::string words = size < 0 ? fmt::format("a square matrix [[..], ..] of size 1 to {}", max_size)
                                     : fmt::format("a {} x {} matrix [[..], ..], the size of mass", size, size);
  const toml::array* rows = node->as_array();
  const auto count = rows ? static_cast<Eigen::Index>(rows->size()) : 0;
  if (count < 1 || count > max_size || (size >= 0 && count != size)) {
    table.problem(key, fmt::format("found {}, allowed {}", describe(*node), words));
    return std::nullopt;
  }
  Eigen::MatrixXd matrix(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const toml::node& row_node = *rows->get(static_cast<std::size_t>(i));
    const toml::array* row = row_node.as_array();
    const std::string path = fmt::format("{}.{}", table.path_of(key), i);
    if (!row || static_cast<Eigen::Index>(row->size()) != count) {
      table.problems().add(row_node, path, fmt::format("found {}, allowed {}", describe(row_node), words));
      return std::nullopt;
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto value = read_number(*row->get(static_cast<std::size_t>(k)), fmt::format("{}.{}", path, k),
                                     finite_number, table.problems());
      if (!value) return std::nullopt;
      matrix(i, k) = *value;
    }
  }
  return matrix;
}

std::optional<Eigen::VectorXd> read_vector(const TableView& table, std::string_view key, Eigen::Index size) {
  const auto values = table.numbers(key, finite_number);
  if (!values) return std::nullopt;
  if (static_cast<Eigen::Index>(values->size()) != size) {
    table.problem(key, fmt::format("found {}, allowed {}, as many as mass has rows", describe(*table.node(key)),
                                   counted(size, "number")));
    return std::nullopt;
  }
  return Eigen::Map<const Eigen::VectorXd>(values->data(), size);
}

// Stiffness (matrices, components column-major) or load (vectors), sum of its terms by power of Omega.
class TermsReader {
 public:
  TermsReader(const TableView& hill, const SceneContext& context, Eigen::Index size, bool matrices)
      : hill_(hill), context_(context), size_(size), matrices_(matrices) {}

  std::array<FourierSeries, 3> read(std::string_view key) {
    const toml::node* node = hill_.node(key);
    if (!node) return {};
    const toml::array* list = node->as_array();
    if (node->is_table()) {
      read_term(hill_.inside(*node->as_table(), hill_.path_of(key), key));
    } else if (list && !list->empty()) {
      for (std::size_t i = 0; i < list->size(); ++i) {
        const std::string path = fmt::format("{}.{}", hill_.path_of(key), i);
        if (const toml::table* term = list->get(i)->as_table()) {
          read_term(hill_.inside(*term, path, key));
        } else {
          hill_.problems().add(*list->get(i), path,
                               fmt::format("found {}, allowed {}", describe(*list->get(i)), words));
        }
      }
    } else {
      hill_.problem(key, fmt::format("found {}, allowed a list of {}", describe(*node), words));
    }
    return series_;
  }

 private:
  static constexpr const char* words = "{ harmonic, cos, sin, omega_power } or { file = \"...\" }";

  Eigen::Index components() const { return matrices_ ? size_ * size_ : size_; }

  std::optional<Eigen::VectorXd> read_components(const TableView& term, std::string_view key) {
    if (!matrices_) return read_vector(term, key, size_);
    const auto matrix = read_matrix(term, key, size_);
    if (!matrix) return std::nullopt;
    return Eigen::Map<const Eigen::VectorXd>(matrix->data(), matrix->size());
  }

  void add(int power, const FourierSeries& term) {
    FourierSeries& sum = series_[static_cast<std::size_t>(power)];
    if (sum.c.size() == 0) sum = FourierSeries(components(), 0);
    if (term.num_harmonics() > sum.num_harmonics()) sum = fourier::resized(sum, term.num_harmonics());
    sum.c.leftCols(term.c.cols()) += term.c;
  }

  bool small_enough(const TableView& term, std::string_view key, Eigen::Index num_harmonics) {
    if (components() * (num_harmonics + 1) <= max_coefficients) return true;
    term.problem(key, fmt::format("found harmonic {} of {} components, allowed at most {} coefficients in all",
                                  num_harmonics, components(), max_coefficients));
    return false;
  }

  void read_term(const TableView& term) {
    const int power = term.integer("omega_power", 0, 2).value_or(0);
    const bool by_harmonic = term.has("harmonic") || term.has("cos") || term.has("sin");
    if (by_harmonic == term.has("file")) {
      term.problems().add(
          term.table(), term.path(),
          fmt::format("found {}, allowed {}",
                      by_harmonic ? "harmonic, cos or sin beside file" : "neither harmonic nor file", words));
      return;
    }
    if (by_harmonic) {
      read_harmonic(term, power);
    } else {
      read_file(term, power);
    }
  }

  void read_harmonic(const TableView& term, int power) {
    const int k = term.need_integer("harmonic", 0, max_harmonic);
    const double scale = term.number("scale", any_number).value_or(1);
    if (!term.has("cos") && !term.has("sin")) term.missing("cos", "cos or sin or both");
    const auto cos = read_components(term, "cos"), sin = read_components(term, "sin");
    if (!small_enough(term, "harmonic", k)) return;
    if (k == 0 && sin && !sin->isZero(0)) term.problem("sin", "found a sine of harmonic 0, allowed zeros or none");
    FourierSeries series(components(), k);
    for (Eigen::Index i = 0; i < components(); ++i) {
      series.c(i, k) = harmonic_coefficient(k, cos ? (*cos)(i) : 0, sin ? (*sin)(i) : 0);
    }
    if (scale != 1) series.c *= scale;
    add(power, series);
  }

  // Samples over one period (see sample_file.hpp).
  void read_file(const TableView& term, int power) {
    const std::string file = term.need_file("file");
    const double scale = term.number("scale", any_number).value_or(1);
    if (file.empty()) return;
    try {
      const std::filesystem::path path = context_.folder / file;
      const NumberTable table = parse_table(read_text_file(path), path.string(), 0, 3);
      const SampleColumns columns = sample_columns(table, size_, matrices_);
      if (!small_enough(term, "file", table.values.rows() / 2)) return;
      FourierSeries series = sampled_series(
          table, columns.angle, columns.components, angle_unit_of(table, columns.angle, context_.angle_unit()),
          matrices_ ? "stiffness" : "load", [&](const std::string& remark) {
            context_.remarks.push_back(
                {Concern::seam, fmt::format("{}: {}", term.problems().place(*term.node("file")), term.path_of("file")),
                 remark});
          });
      if (scale != 1) series.c *= scale;
      add(power, series);
    } catch (const SceneError& error) {
      term.problem("file", fmt::format("found \"{}\" with {}", printable(file, 100), error.what()));
    }
  }

  const TableView& hill_;
  const SceneContext& context_;
  Eigen::Index size_;
  bool matrices_;
  std::array<FourierSeries, 3> series_;
};

}  // namespace

HillSystem read_hill(const TableView& hill, const SceneContext& context) {
  HillSystem system;
  if (!hill.has("mass")) hill.missing("mass", "a square matrix [[..], ..]");
  if (!hill.has("stiffness")) hill.missing("stiffness", "a list of { harmonic, cos, sin, omega_power }");
  const auto mass = read_matrix(hill, "mass", -1);
  if (!mass) return system;  // the size of everything else
  const Eigen::Index size = mass->rows();
  system.mass = *mass;
  system.damping = read_matrix(hill, "damping", size).value_or(Eigen::MatrixXd::Zero(size, size));
  system.stiffness = TermsReader(hill, context, size, true).read("stiffness");
  system.load = TermsReader(hill, context, size, false).read("load");
  if (!hill.problems().empty()) return system;
  try {
    validate(system);
  } catch (const std::invalid_argument& error) {
    std::string_view found = error.what();
    constexpr std::string_view whose = "HillSystem: ";
    if (found.starts_with(whose)) found.remove_prefix(whose.size());
    const bool mass_is_wrong = found.find("mass is singular") != std::string_view::npos;
    hill.problem(mass_is_wrong ? "mass" : "",
                 fmt::format("found that the {}, allowed an invertible mass and finite numbers", found));
  }
  return system;
}

}  // namespace hb
