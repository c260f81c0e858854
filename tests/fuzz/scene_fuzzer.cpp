// libFuzzer target (option HB_FUZZ, clang): the bytes are a scene's text.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/scene_mutations.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bool accepted = false;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::string wrong = hb::fuzz::check_scene_text(text, HB_SOURCE_DIR "/tests/scenes", accepted);
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  std::abort();
}
