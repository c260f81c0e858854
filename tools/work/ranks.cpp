#include "tools/work/ranks.hpp"

namespace hb::tools {
namespace {

const Ranks alone;
const Ranks* current = &alone;

}  // namespace

const Ranks& ranks() { return *current; }

void set_ranks(const Ranks& all) { current = &all; }

}  // namespace hb::tools
