// The `hb` command: registers the subcommands and turns exceptions into sentences and exit codes.
#include <fmt/core.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "lib/scene/scene.hpp"
#include "lib/scene/scene_keys.hpp"
#include "tools/command/command.hpp"
#include "hb/analysis/linkage_analysis.hpp"
#include "tools/work/ranks.hpp"
#ifdef HB_WITH_MPI
#include "tools/work/mpi_ranks.hpp"
#endif

namespace {

int say(int status, const char* what) {
  fmt::print(stderr, "hb: {}\n", what);
  return status;
}

// A result that did not reach its reader is not a success.
int flush_output(int status) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
  fmt::print(stderr, "hb: standard output cannot be written: {}\n", std::strerror(errno));
  return hb::tools::exit_wrong_input;
}

std::string unknown_command(const CLI::App& app, const std::string& found) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  const std::string near = hb::nearest_name(found, names);
  return fmt::format("found the command \"{}\"{}, allowed {}", found, near.empty() ? "" : " (" + near + " meant?)",
                     fmt::join(names, ", "));
}

int run(int argc, char** argv) {
  using namespace hb::tools;
  CLI::App app{
      "Periodic vibration and dynamic stability of linkages with elastic links, by harmonic balance.\n"
      "Exit status: 0 done, 1 disagreement found by a check or internal error, 2 wrong input, 3 tolerance not reached.",
      "hb"};
  app.require_subcommand(1);
  app.set_version_flag("--version", HB_VERSION);
  int status = exit_ok;
  add_scene_command(app, status);
  add_steady_command(app, status);
  add_sweep_command(app, status);
  add_map_command(app, status);
  add_check_command(app, status);
  add_bench_command(app, status);
  add_tune_command(app, status);
  try {
    app.parse(argc, argv);
    return status;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    if (argc > 1 && app.get_subcommands().empty()) {
      fmt::print(stderr, "hb: {}\n", unknown_command(app, argv[1]));
      return exit_wrong_input;
    }
    const auto chosen = app.get_subcommands();
    const std::string command = chosen.empty() ? "hb" : "hb " + chosen.front()->get_name();
    fmt::print(stderr, "{}: {} (`{} --help` lists what is allowed)\n", command, error.what(), command);
    return exit_wrong_input;
  } catch (const UnresolvedLinkage& error) {
    return say(exit_not_reached, error.what());
  } catch (const hb::SceneError& error) {
    return say(exit_wrong_input, error.what());
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
    fmt::print(stderr, "hb: internal error: {}\n", error.what());
    return exit_failed;
  }
}

}  // namespace

#ifdef HB_WITH_MPI

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);
  const hb::tools::MpiRanks ranks(argc, argv);
  hb::tools::set_ranks(ranks);
  // The first rank speaks for all.
  if (!ranks.first() && (!std::freopen("/dev/null", "w", stdout) || !std::freopen("/dev/null", "w", stderr))) return 1;
  const std::string command = argc > 1 ? argv[1] : "";
  const bool shared = ranks.size() == 1 || command == "sweep" || command == "map";
  const int status = shared ? flush_output(run(argc, argv))
                            : say(hb::tools::exit_wrong_input,
                                  fmt::format("found {} processes for \"{}\", allowed: several for sweep and map only",
                                              ranks.size(), command)
                                      .c_str());
  if (status == hb::tools::exit_wrong_input || status == hb::tools::exit_failed) ranks.end_all(status);
  return status;
}

#else

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit then shows as a write error, like a full disk
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
