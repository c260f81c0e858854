#include "tools/output/standard_output.hpp"

#include <cerrno>
#include <cstdio>

#include "tools/output/printable.hpp"

namespace hb::tools {
namespace {

int first_error = 0;

}  // namespace

void print_out(const std::string& text) {
  const std::string shown = printable(text);
  errno = 0;
  const bool written = std::fwrite(shown.data(), 1, shown.size(), stdout) == shown.size() && std::fflush(stdout) == 0;
  if (!written && first_error == 0) first_error = errno != 0 ? errno : EIO;
}

int standard_output_error() {
  print_out("");
  return first_error;
}

}  // namespace hb::tools
