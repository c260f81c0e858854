// The `hb` program: prepares the process and runs the command line, alone or as one of several processes.
#include <fmt/core.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#endif

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <string>

#include "tools/command/command.hpp"
#include "tools/command/dispatch.hpp"
#include "tools/output/standard_output.hpp"
#include "tools/work/interrupts.hpp"
#include "tools/work/ranks.hpp"
#ifdef HB_WITH_MPI
#include "tools/work/mpi_ranks.hpp"
#endif

namespace {

using hb::tools::say;

// A result that did not reach its reader is not a success. A reader that has read enough (`| head`) is told nothing.
int flush_output(int status) {
  const int error = hb::tools::standard_output_error();
  if (error == 0) return status;
  if (error == EPIPE) {
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  }
  return say(hb::tools::exit_wrong_input, fmt::format("standard output cannot be written: {}", std::strerror(error)));
}

// Errors that nobody caught, as out of memory while one was handled.
[[noreturn]] void end_without_abort() {
  constexpr char message[] = "hb: out of memory, or an internal error\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, message, sizeof message - 1);
  _exit(hb::tools::exit_failed);
}

#ifdef __GLIBC__
// The heap goes on in pages of 2 MB where the system has them: one page fault instead of 512. Its first header lies in
// the small page before, since only memory that nobody has touched becomes large.
void use_large_pages() {
  rlimit space{}, data{};
  if (getrlimit(RLIMIT_AS, &space) != 0 || getrlimit(RLIMIT_DATA, &data) != 0) return;
  if (space.rlim_cur != RLIM_INFINITY || data.rlim_cur != RLIM_INFINITY) return;
  constexpr std::uintptr_t page = 2 << 20, small = 4096;
  constexpr std::size_t some = 64 << 20;
  const auto end = reinterpret_cast<std::uintptr_t>(sbrk(0));
  sbrk(static_cast<std::intptr_t>((2 * page - small - end % page) % page));
  void* const memory = std::malloc(some);
  const std::uintptr_t begin = (reinterpret_cast<std::uintptr_t>(memory) / page + 1) * page;
  if (memory != nullptr) madvise(reinterpret_cast<void*>(begin), some - page, MADV_HUGEPAGE);
  std::free(memory);
}
#endif

// Before other threads ask for memory.
void prepare_memory() {
#ifdef __GLIBC__
  // Matrices of a speed or a place of a map are freed and allocated again thousands of times: their pages stay.
  constexpr int kept = 256 << 20;
  mallopt(M_MMAP_THRESHOLD, kept);
  mallopt(M_TRIM_THRESHOLD, kept);
  constexpr int at_once = 1 << 20;
  mallopt(M_TOP_PAD, at_once);
  use_large_pages();
#endif
}

void prepare_process() {
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit then shows as a write error, like a full disk
  std::signal(SIGPIPE, SIG_IGN);  // files come first, see flush_output
  std::set_terminate(end_without_abort);
  hb::tools::end_cleanly_on_signals();
}

}  // namespace

#ifdef HB_WITH_MPI

int main(int argc, char** argv) {
  prepare_memory();
  const hb::tools::MpiRanks ranks(argc, argv);
  hb::tools::set_ranks(ranks);
  prepare_process();
  // The first rank speaks for all.
  if (!ranks.first() && (!std::freopen("/dev/null", "w", stdout) || !std::freopen("/dev/null", "w", stderr))) return 1;
  const std::string command = argc > 1 ? argv[1] : "";
  const bool shared = ranks.size() == 1 || command == "sweep" || command == "map";
  const int status = shared ? flush_output(hb::tools::run(argc, argv))
                            : say(hb::tools::exit_wrong_input,
                                  fmt::format("found {} processes for \"{}\", allowed: several for sweep and map only",
                                              ranks.size(), command));
  if (status == hb::tools::exit_wrong_input || status == hb::tools::exit_failed) ranks.end_all(status);
  return status;
}

#else

int main(int argc, char** argv) {
  prepare_memory();
  prepare_process();
  // Under mpirun the program with MPI beside this one takes over; alone, nobody waits for MPI to be loaded.
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr || std::getenv("PMI_SIZE") != nullptr) {
    std::error_code error;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
    const std::string with_mpi = (self.parent_path() / "hb_mpi").string();
    execv(with_mpi.c_str(), argv);
    return say(hb::tools::exit_wrong_input, "found mpirun, but this hb was built without MPI");
  }
  return flush_output(hb::tools::run(argc, argv));
}

#endif
