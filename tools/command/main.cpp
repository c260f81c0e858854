// The `hb` program: prepares the process and runs the command line, alone or as one of several processes.
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
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

// Before objects with initialisers ask for memory.
[[gnu::constructor(101)]] void end_cleanly_without_memory() { std::set_terminate(end_without_abort); }

void prepare_process() {
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit then shows as a write error, like a full disk
  std::signal(SIGPIPE, SIG_IGN);  // files come first, see flush_output
  hb::tools::end_cleanly_on_signals();
}

}  // namespace

#ifdef HB_WITH_MPI

int main(int argc, char** argv) {
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
