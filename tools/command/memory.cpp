// Memory of the commands: mimalloc, which keeps what a speed or a place of a map gives back for the next one, thread by
// thread, in pages of 2 MB where the system has them: one page fault instead of 512.
#include <mimalloc.h>

namespace {

void use_large_pages() {
  mi_option_enable(mi_option_large_os_pages);
  mi_option_set(mi_option_eager_commit_delay, 0);  // in the first memory of a thread too
}

// Before anyone asks for memory, initialisers of shared libraries among them.
[[gnu::section(".preinit_array"), gnu::used]] void (*const before_all)() = use_large_pages;

}  // namespace
