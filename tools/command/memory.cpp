// Memory of the commands: mimalloc, which keeps what a speed or a place of a map gives back for the next one, thread by
// thread, in pages of 2 MB where the system has them: one page fault instead of 512.
#include <alloca.h>
#include <mimalloc.h>

namespace {

// The stack has what the deepest calls need before memory runs short: it grows no more then, and nothing says so.
void deepen_stack() {
  constexpr unsigned enough = 1 << 20;
  *static_cast<volatile char*>(alloca(enough)) = 0;
}

void use_large_pages() {
  mi_option_enable(mi_option_large_os_pages);  // where an administrator has set some aside, those first
  mi_option_set(mi_option_eager_commit_delay, 0);  // in the first memory of a thread too
}

void prepare() {
  deepen_stack();
  use_large_pages();
}

// Before anyone asks for memory, initialisers of shared libraries among them.
[[gnu::section(".preinit_array"), gnu::used]] void (*const before_all)() = prepare;

}  // namespace
