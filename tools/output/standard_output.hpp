// What the subcommands print on standard output.
#pragma once

#include <string>

namespace hb::tools {

// Printable text; what could not be written is remembered, not thrown: files come first.
void print_out(const std::string& text);

// Reason why something did not reach its reader (errno); 0: everything did.
[[nodiscard]] int standard_output_error();

}  // namespace hb::tools
