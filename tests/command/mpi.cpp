// `mpirun -n 2 hb sweep` and `hb map`: the bits of one process.
#include <gtest/gtest.h>

#include "tests/support/run_command.hpp"

namespace {

namespace fs = std::filesystem;

class Mpi : public CommandTest {
 protected:
  // MPI itself leaks a little at its end.
  CommandResult on_two(const std::string& arguments) const {
    return hb(arguments,
              "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 ASAN_OPTIONS=detect_leaks=0 timeout 100 "
              "'" HB_MPIRUN "' --oversubscribe --bind-to none -n 2");
  }
  void expect_same_files(const fs::path& a, const fs::path& b) const {
    std::size_t files = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / a)) {
      EXPECT_EQ(read(entry.path()), read(folder_ / b / entry.path().filename())) << entry.path();
      ++files;
    }
    EXPECT_GT(files, 2u);
    EXPECT_EQ(num_entries(folder_ / b), files);
  }
};

const std::string swing_map =
    " --x omega=1:2.6:20 --y hill.stiffness.1.cos.0.0=0.1:0.6:12 --threads 2 --no-plots --json";
const std::string speeds = " --rpm 1000:3000:250 --modes 2 --no-plots --threads 1";

TEST_F(Mpi, AMapHasTheSameBits) {
  const CommandResult one = hb("map " + scene("mathieu") + swing_map + " --out one");
  const CommandResult two = on_two("map " + scene("mathieu") + swing_map + " --out two");
  ASSERT_EQ(one.status, 0) << one.err;
  ASSERT_EQ(two.status, 0) << two.err;
  EXPECT_EQ(one.out, two.out);
  expect_same_files("one", "two");
}

TEST_F(Mpi, ASweepHasTheSameBits) {
  const CommandResult one = hb("sweep " + scene("six_link") + speeds + " --json --out one");
  const CommandResult two = on_two("sweep " + scene("six_link") + speeds + " --json --out two");
  EXPECT_EQ(one.status, two.status) << two.err;
  EXPECT_EQ(one.out, two.out);
  expect_same_files("one", "two");
}

TEST_F(Mpi, GoesOnWithWhatOneProcessLeft) {
  const std::string arguments = "map " + scene("mathieu") + swing_map + " --out kept";
  const CommandResult whole = hb("map " + scene("mathieu") + swing_map);
  stopped_by("KILL", arguments, "kept.part");
  const CommandResult rest = on_two(arguments + (fs::exists(folder_ / "kept.part") ? " --resume" : ""));
  EXPECT_EQ(rest.status, 0) << rest.err;
  EXPECT_EQ(rest.out, whole.out);
  EXPECT_FALSE(fs::exists(folder_ / "kept.part"));
}

TEST_F(Mpi, ErrorsEndAllProcesses) {
  for (const std::string& arguments :
       {std::string("map missing.toml --x omega=1:2:3 --y a=1:2:3"), "sweep " + scene("six_link") + " --out /proc/x",
        "steady " + scene("six_link")}) {
    const CommandResult result = on_two(arguments);
    EXPECT_EQ(result.status, 2) << arguments << "\n" << result.err;
    EXPECT_NE(result.err.find("allowed"), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
  }
}

}  // namespace
