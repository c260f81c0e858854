// Where the answer goes, as written on the command line.
#pragma once

#include <filesystem>
#include <optional>

#include "tools/command/common_flags.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {

// Where the answer goes, and with how many threads it is computed.
struct Output {
  std::optional<std::filesystem::path> folder;  // for CSV and pictures
  PictureStyle pictures;
  bool json = false, stats = false, html = false;
  int threads = 1;
};

// Throws UsageError.
[[nodiscard]] Output output(const CommonFlags& flags);

}  // namespace hb::tools
