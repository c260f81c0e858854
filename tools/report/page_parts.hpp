// The plain files of tools/report/page and the plotting library, put into the program when it is built.
#pragma once

#include <string_view>

namespace hb::tools::page {

extern const std::string_view html, style, script;
// Empty where the program was built without the library.
extern const std::string_view library, library_style, library_licence;

}  // namespace hb::tools::page
