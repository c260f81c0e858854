#include "tools/output/speaker.hpp"

namespace hb::tools {
namespace {

std::string& name() {
  static std::string words = "hb";
  return words;
}

}  // namespace

const std::string& speaker() { return name(); }

void speak_as(const std::string& subcommand) { name() = subcommand.empty() ? "hb" : "hb " + subcommand; }

}  // namespace hb::tools
