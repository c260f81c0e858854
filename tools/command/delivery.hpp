// The end of every subcommand: files, standard output, pictures, in the order in which least is lost.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/output/output_folder.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/report/report_page.hpp"

namespace hb::tools {

struct Delivery {
  std::string printed;  // for standard output
  LongText document = {};  // instead; printable as it is; may be empty
  // Writes the data into the folder and says which pictures there are of them.
  std::function<std::vector<Figure>(OutputFolder&)> write_data;
  // Further pictures whose data take time to compute; may be empty.
  std::function<std::vector<Figure>(OutputFolder&)> write_more = {};
  // The page report.html, with pictures for readers without script; made once the other pictures are there; may be
  // empty.
  std::function<std::string(std::vector<PageText::Picture>)> page = {};
  // Once the data are in their place.
  std::function<void()> committed = {};
};

// Data are committed first; then `printed` is printed, whatever became of the files; pictures are drawn last. Gives
// `status`, or exit_wrong_input where the data could not be written, or, instead of 0, exit_no_pictures.
[[nodiscard]] int deliver(OutputFolder* folder, const PictureStyle& style, int status, const Delivery& delivery);

}  // namespace hb::tools
