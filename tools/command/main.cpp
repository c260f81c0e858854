// The `hb` command: registers the subcommands and turns exceptions into sentences and exit codes.
#include <fmt/core.h>
#include <fmt/format.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "lib/scene/scene.hpp"
#include "lib/scene/scene_keys.hpp"
#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/compare.hpp"
#include "tools/command/version.hpp"
#include "tools/output/printable.hpp"
#include "tools/output/standard_output.hpp"
#include "tools/work/interrupts.hpp"
#include "tools/work/ranks.hpp"
#ifdef HB_WITH_MPI
#include "tools/work/mpi_ranks.hpp"
#endif

namespace {

int say(int status, const std::string& what) {
  fmt::print(stderr, "hb: {}\n", hb::tools::printable(what));
  return status;
}

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

void prepare_process() {
#ifdef __GLIBC__
  // Matrices of a speed or a place of a map are freed and allocated again thousands of times: their pages stay.
  constexpr int kept = 256 << 20;
  mallopt(M_MMAP_THRESHOLD, kept);
  mallopt(M_TRIM_THRESHOLD, kept);
#endif
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit then shows as a write error, like a full disk
  std::signal(SIGPIPE, SIG_IGN);  // files come first, see flush_output
  std::set_terminate(end_without_abort);
  hb::tools::end_cleanly_on_signals();
}

std::string unknown_command(const CLI::App& app, const std::string& found) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  const std::string near = hb::nearest_name(found, names);
  return fmt::format("found the command \"{}\"{}, allowed {}", found, near.empty() ? "" : " (" + near + " meant?)",
                     fmt::join(names, ", "));
}

// "--rmp 300": names each flag that is none, with the nearest one.
std::string unknown_flags(const CLI::App& command, const std::vector<std::string>& words) {
  std::vector<std::string> names, sentences;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const std::string& found : words) {
    if (!found.starts_with("--")) continue;
    const std::string flag = found.substr(0, found.find('='));
    if (std::ranges::find(names, flag) != names.end()) continue;
    const std::string near = hb::nearest_name(flag, names);
    sentences.push_back(fmt::format("found the unknown flag {}{}", flag, near.empty() ? "" : " (" + near + " meant?)"));
  }
  return fmt::format("{}", fmt::join(sentences, ", "));
}

int run(int argc, char** argv) {
  using namespace hb::tools;
  CLI::App app{
      "Periodic vibration and dynamic stability of linkages with elastic links, by harmonic balance.\n"
      "Exit status: 0 done, 1 disagreement found by a check or internal error, 2 wrong input or output that cannot be\n"
      "written, 3 a tolerance asked for not reached, 4 data complete but pictures missing, 130 interrupted.",
      "hb"};
  app.require_subcommand(1);
  app.set_version_flag("--version", version());
  int status = exit_ok;
  add_new_command(app, status);
  add_scene_command(app, status);
  add_steady_command(app, status);
  add_sweep_command(app, status);
  add_map_command(app, status);
  add_check_command(app, status);
  add_bench_command(app, status);
  add_tune_command(app, status);
  add_report_command(app, status);
  add_compare_command(app, status);
  try {
    app.parse(argc, argv);
    return status;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    if (argc > 1 && app.get_subcommands().empty()) {
      return say(exit_wrong_input, unknown_command(app, argv[1]));
    }
    constexpr int extras = static_cast<int>(CLI::ExitCodes::ExtrasError);
    const auto chosen = app.get_subcommands();
    const std::string command = chosen.empty() ? "hb" : "hb " + chosen.front()->get_name();
    std::string what = error.get_exit_code() == extras && !chosen.empty()
                           ? unknown_flags(*chosen.front(), {argv + 1, argv + argc})
                           : "";
    if (what.empty()) what = error.what();
    fmt::print(stderr, "{}: {} (`{} --help` lists what is allowed)\n", command, printable(what), command);
    return exit_wrong_input;
  } catch (const hb::UnresolvedLinkage& error) {
    return say(exit_not_reached, error.what());
  } catch (const hb::SceneError& error) {
    return say(exit_wrong_input, error.what());
  } catch (const hb::RequestError& error) {
    return say(exit_wrong_input, in_flags(error));
  } catch (const UsageError& error) {
    return say(exit_wrong_input, error.what());
  } catch (const OutputError& error) {
    return say(exit_wrong_input, error.what());
  } catch (const ShareDone&) {
    return exit_ok;
  } catch (const OtherRankFailed&) {
    return exit_failed;
  } catch (const std::bad_alloc&) {
    return say(exit_failed, "out of memory");
  } catch (const std::exception& error) {
    return say(exit_failed, fmt::format("internal error: {}", error.what()));
  }
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
  const int status = shared ? flush_output(run(argc, argv))
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
  return flush_output(run(argc, argv));
}

#endif
