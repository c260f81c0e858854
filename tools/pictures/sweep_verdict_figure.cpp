// Verdicts along a sweep as a strip of colours, a row for each elastic link.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tools/output/sweep_words.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/sweep_figures.hpp"
#include "tools/pictures/sweep_frame.hpp"

namespace hb::tools {
namespace {

// The colours of the page of hb report; readable without colour vision.
struct VerdictColour {
  Verdict verdict;
  const char* colour;
};
constexpr VerdictColour verdict_colours[] = {{Verdict::stable, "0x0072b2"},
                                             {Verdict::bounded, "0x009e73"},
                                             {Verdict::undecided, "0xb0b4ba"},
                                             {Verdict::unstable, "0xd55e00"}};

struct Piece {
  double from, to;
  Verdict verdict;
};

// The end of a band is where the growth rate is zero: undecided by nature.
bool at_band_end(const SweepResult& result, const std::vector<std::size_t>& rods, double x) {
  constexpr double same = 1e-6;
  const auto near = [&](double end) { return std::abs(x - end) <= same * std::abs(end); };
  return std::ranges::any_of(rods, [&](std::size_t r) {
    return std::ranges::any_of(result.rods[r].bands,
                               [&](const UnstableBand& band) { return near(band.from) || near(band.to); });
  });
}

// Each computed point stands for its neighbourhood, half way to the next; bands are as long as they were located.
std::vector<Piece> pieces_of(const SweepResult& result, const std::vector<std::size_t>& rods) {
  std::vector<Piece> pieces;
  std::vector<std::pair<double, Verdict>> known;
  for (const SweepPoint* point : all_points(result)) {
    if (point->rods.empty()) continue;
    Verdict verdict = Verdict::stable;
    bool all = true;
    for (const std::size_t r : rods) {
      if (!point->rods[r].stability)
        all = false;
      else
        verdict = worst(verdict, point->rods[r].stability->stability.verdict);
    }
    if (all && !(verdict == Verdict::undecided && at_band_end(result, rods, point->x)))
      known.push_back({point->x, verdict});
  }
  for (std::size_t k = 0; k < known.size(); ++k) {
    const double x = known[k].first, from = k == 0 ? x : (known[k - 1].first + x) / 2,
                 to = k + 1 == known.size() ? x : (x + known[k + 1].first) / 2;
    if (!pieces.empty() && pieces.back().verdict == known[k].second && pieces.back().to == from)
      pieces.back().to = to;
    else
      pieces.push_back({from, to, known[k].second});
  }
  if (!result.searched_bands) return pieces;
  // What is unstable ends where the band does.
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (pieces[k].verdict != Verdict::unstable) continue;
    for (const std::size_t r : rods)
      for (const UnstableBand& band : result.rods[r].bands) {
        const bool begins = k > 0 && band.from > pieces[k - 1].from && band.from < pieces[k].to,
                   ends = k + 1 < pieces.size() && band.to > pieces[k].from && band.to < pieces[k + 1].to;
        if (begins && band.to > pieces[k].from) pieces[k].from = pieces[k - 1].to = band.from;
        if (ends && band.from < pieces[k].to) pieces[k].to = pieces[k + 1].from = band.to;
      }
  }
  for (const std::size_t r : rods)
    for (const UnstableBand& band : result.rods[r].bands) pieces.push_back({band.from, band.to, Verdict::unstable});
  return pieces;
}

struct Row {
  std::string name;
  std::vector<std::size_t> rods;
};

std::vector<Row> rows_of(const SweepScene& scene, const SweepResult& result) {
  std::vector<Row> rows;
  std::vector<std::size_t> all;
  for (std::size_t r = 0; r < result.rods.size(); ++r) all.push_back(r);
  rows.push_back({scene.first().linkage() ? "mechanism" : "system", all});
  if (result.rods.size() > 1)
    for (const std::size_t r : all) rows.push_back({result.rods[r].name, {r}});
  return rows;
}

}  // namespace

CsvFile sweep_verdict_csv(const SweepScene& scene, const SweepResult& result) {
  CsvFile file;
  file.name = "sweep_verdict.csv";
  const std::vector<Row> rows = rows_of(scene, result);
  std::string names;
  std::vector<std::array<double, 4>> lines;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    names += fmt::format("{}{} {}", k == 0 ? "" : ", ", k, rows[k].name);
    for (const Piece& piece : pieces_of(result, rows[k].rods))
      lines.push_back(
          {static_cast<double>(k), piece.from, piece.to, static_cast<double>(verdict_number(piece.verdict))});
  }
  file.comment = {scene_name(scene.scene()) + ": verdicts along " + scene.axis().path + "; rows: " + names,
                  std::string(verdict_numbers) + "; points stand for their neighbourhood, bands as located"};
  file.columns = {"row", "from", "to", "verdict"};
  file.rows.resize(static_cast<Eigen::Index>(lines.size()), 4);
  for (std::size_t k = 0; k < lines.size(); ++k)
    for (std::size_t c = 0; c < 4; ++c)
      file.rows(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(c)) = lines[k][c];
  return file;
}

Figure sweep_verdict_figure(const SweepScene& scene, const SweepResult& result, const CsvFile& csv) {
  const std::vector<Row> rows = rows_of(scene, result);
  Figure figure;
  figure.name = "sweep_verdict";
  figure.width = 1000;
  figure.height = 190 + 44 * static_cast<int>(rows.size());
  std::string tics, layers, colour = "0xffffff";
  for (std::size_t k = 0; k < rows.size(); ++k)
    tics += fmt::format("{}{} {}", k == 0 ? "" : ", ", quoted(rows[k].name), k);
  for (const auto& [verdict, code] : verdict_colours) {
    const int number = verdict_number(verdict);
    colour = fmt::format("($4 == {} ? {} : {})", number, code, colour);
    if (csv.rows.rows() > 0 && (csv.rows.col(3).array() == number).any())
      layers += fmt::format(", keyentry with points pointtype 5 pointsize 1.6 linecolor rgb {} title '{}'", code,
                            to_string(verdict));
  }
  const std::string verdict = sweep_title_verdict(result);
  figure.commands = fmt::format(
      "set title {}\n{}set yrange [{}:-0.5]\nset ytics ({})\nunset grid\nset key at screen 0.5, screen 0.02 center "
      "bottom "
      "horizontal Left reverse samplen 2\nset bmargin at screen {}\nset style fill solid noborder\n"
      "plot '{}' using 2:1:2:3:($1-0.38):($1+0.38):{} with boxxyerror linecolor rgb variable notitle{}\n"
      "set ytics autofreq\nset grid\nset bmargin -1\n{}",
      figure_title(scene.scene(), {verdict}, "verdict of the steady motion"), frame_axis(scene),
      static_cast<double>(rows.size()) - 0.5, tics, 100.0 / figure.height, csv.name, colour, layers, frame_clean_up);
  return figure;
}

}  // namespace hb::tools
