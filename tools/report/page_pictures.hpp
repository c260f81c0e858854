// Pictures of a page for readers without JavaScript.
#pragma once

#include <functional>
#include <vector>

#include "tools/output/output_folder.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/report/report_page.hpp"

namespace hb::tools {

// The figures that show most, drawn small from the CSV files written into the folder; none of them stays there. Empty
// where gnuplot is missing or fails: a page does without.
[[nodiscard]] std::vector<PageText::Picture> page_pictures(const std::vector<Figure>& figures, OutputFolder& folder);

// The same from a folder of their own that goes again: `write` puts the CSV files there and says what is drawn of them.
[[nodiscard]] std::vector<PageText::Picture> page_pictures(
    const std::function<std::vector<Figure>(OutputFolder&)>& write);

}  // namespace hb::tools
