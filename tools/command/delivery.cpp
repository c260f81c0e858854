#include "tools/command/delivery.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "tools/command/command.hpp"
#include "tools/output/printable.hpp"
#include "tools/output/standard_output.hpp"
#include "tools/report/page_pictures.hpp"
#include "tools/work/interrupts.hpp"

namespace hb::tools {
namespace {

void warn(const OutputFolder& folder, const std::exception& error) {
  fmt::print(stderr, "hb {}: {}\n", folder.command(), printable(error.what()));
}

// A name that no axis has changes nothing: that is said, once the pictures are known.
void say_unknown_labels(const OutputFolder& folder, const PictureStyle& style, const std::vector<Figure>& figures) {
  if (style.labels.empty() || figures.empty()) return;
  const std::vector<std::string> names = axis_names(figures);
  for (const PictureStyle::Label& label : style.labels)
    if (std::ranges::find(names, label.name) == names.end())
      fmt::print(stderr, "hb {}: --label: no axis is named \"{}\", there are: {}\n", folder.command(),
                 printable(label.name), printable(fmt::format("{}", fmt::join(names, ", "))));
}

// One stage: data, their script, the pictures.
std::vector<Figure> write_stage(OutputFolder& folder, const PictureStyle& style, std::vector<Figure> figures,
                                const std::function<std::vector<Figure>(OutputFolder&)>& write) {
  for (Figure& figure : write(folder)) figures.push_back(std::move(figure));
  if (!style.drawn) figures.clear();
  if (!figures.empty()) folder.write(script_name(folder.command()), plot_script(figures, style));
  folder.commit();
  return figures;
}

}  // namespace

int deliver(OutputFolder* folder, const PictureStyle& style, int status, const Delivery& delivery) {
  std::vector<Figure> figures;
  bool written = false;
  begin_delivery();
  if (folder != nullptr) {
    try {
      figures = write_stage(*folder, style, {}, delivery.write_data);
      written = true;
      if (delivery.committed) delivery.committed();
    } catch (const std::exception& error) {
      warn(*folder, error);
      status = exit_wrong_input;
    }
  } else if (delivery.committed) {
    delivery.committed();
  }
  if (delivery.document) delivery.document(print_piece);
  print_out(delivery.printed);
  if (!written) return status;
  if (asked_to_end()) return status == exit_ok && !figures.empty() ? exit_no_pictures : status;
  std::fflush(stdout);
  begin_pictures(status == exit_ok ? int{exit_no_pictures} : status);
  bool drawn = true;
  try {
    if (style.drawn && delivery.write_more)
      figures = write_stage(*folder, style, std::move(figures), delivery.write_more);
    say_unknown_labels(*folder, style, figures);
    if (!figures.empty()) drawn = draw_figures(figures, *folder, style);
    if (delivery.page) {
      const std::string page =
          delivery.page(drawn ? page_pictures(figures, *folder) : std::vector<PageText::Picture>());
      folder->write("report.html", page);
      folder->commit();
    }
  } catch (const std::exception& error) {
    warn(*folder, error);
    drawn = false;
  }
  return drawn || status != exit_ok ? status : exit_no_pictures;
}

}  // namespace hb::tools
