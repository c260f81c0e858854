// Faults of the machine around `hb`: full disks, kills, programs that hang, others in the same folder. What was
// computed is never lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/run_command.hpp"
#include "tools/output/provenance.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Faults : public CommandTest {
 protected:
  // A program of that name, found before any other; what stands in front of a command to have it found.
  std::string with_program(const std::string& name, const std::string& shell_text) const {
    fs::create_directories(folder_ / "bin");
    std::ofstream(folder_ / "bin" / name) << "#!/bin/sh\n" << shell_text << "\n";
    fs::permissions(folder_ / "bin" / name, fs::perms::all);
    return "PATH='" + (folder_ / "bin").string() + "':$PATH";
  }
  std::map<std::string, std::string> files(const std::string& folder) const {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_ / folder))
      if (entry.is_regular_file()) found[entry.path().filename().string()] = read(entry.path());
    return found;
  }
  // Names in the test's folder, without what the test itself put there.
  std::vector<std::string> names(const std::vector<std::string>& without = {}) const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (std::find(without.begin(), without.end(), name) == without.end()) found.push_back(name);
    }
    std::sort(found.begin(), found.end());
    return found;
  }
  bool has_scratch(const std::string& folder) const {
    for (const auto& entry : fs::directory_iterator(folder_ / folder))
      if (entry.is_directory() && entry.path().filename().string().starts_with(".hb-")) return true;
    return false;
  }
  // Runs shell lines in the test's folder; HB is the command.
  int shell(const std::string& lines) const {
    const std::string text = "cd '" + folder_.string() + "' && HB='" HB_COMMAND "'\n" + lines;
    const int status = std::system(("exec sh -c \"$(cat <<'END_OF_LINES'\n" + text + "\nEND_OF_LINES\n)\"").c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
};

const std::string six_link = "'" HB_SOURCE_DIR "/tests/scenes/six_link.toml'";
const std::string mathieu = "'" HB_SOURCE_DIR "/tests/scenes/mathieu.toml'";
const std::string long_sweep = "sweep " + six_link + " --rpm 1000:1500:5 --only steady,stability --modes 2 --no-plots ";

// A gnuplot that failed took everything with it: exit 2, no files, no standard output.
TEST_F(Faults, AFailingGnuplotCostsPicturesOnly) {
  const std::string before = with_program("gnuplot", "printf 'no \\033[31mluck\\007 %s'; exit 3");
  const CommandResult result = hb("steady " + mathieu + " --omega 1 --out out", before);
  EXPECT_EQ(result.status, 4) << result.err;
  EXPECT_NE(result.out.find("stable"), std::string::npos);
  EXPECT_NE(result.err.find("luck"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find('\033'), std::string::npos) << result.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/steady.json"));
  EXPECT_TRUE(fs::exists(folder_ / "out/response_system.csv"));
  EXPECT_FALSE(has_scratch("out"));
  EXPECT_EQ(names({"bin"}), std::vector<std::string>{"out"});
}

TEST_F(Faults, GarbageInPlaceOfAPictureIsNotKept) {
  const std::string before =
      with_program("gnuplot",
                   "for n in response_system phase_system spectrum_system; do\n"
                   "echo garbage >$n.svg; head -c 1000 /dev/zero >$n.png; done\nyes | head -c 3000000");
  const CommandResult result = hb("steady " + mathieu + " --omega 1 --out out", before);
  EXPECT_EQ(result.status, 4) << result.err;
  EXPECT_LT(result.err.size(), 2000u);
  for (const auto& [name, text] : files("out")) {
    EXPECT_FALSE(name.ends_with(".svg") || name.ends_with(".png")) << name;
  }
}

// It hung for ever; everything computed waited with it.
TEST_F(Faults, AGnuplotThatHangsIsEnded) {
  with_program("gnuplot", "sleep 1000 & echo $! >pid; wait");
  const std::string path = std::getenv("PATH");
  setenv("PATH", ((folder_ / "bin").string() + ":" + path).c_str(), 1);
  hb::tools::Figure figure;
  figure.name = "picture";
  const hb::tools::PlotOutcome outcome =
      hb::tools::run_gnuplot(folder_, "plots.gp", {figure}, std::chrono::milliseconds(300));
  setenv("PATH", path.c_str(), 1);
  EXPECT_FALSE(outcome.complete());
  EXPECT_NE(outcome.words.find("ended"), std::string::npos) << outcome.words;
  // With what it had started.
  const pid_t started = std::stoi(read(folder_ / "pid"));
  for (int k = 0; k < 200 && kill(started, 0) == 0; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_NE(kill(started, 0), 0);
}

// INT and TERM while drawing left the temporary folder and gnuplot behind.
TEST_F(Faults, SignalsWhileDrawingCleanUpAndKeepTheData) {
  with_program("gnuplot", "echo $$ >\"$HB_TEST_PID\"; exec sleep 1000");
  for (const char* signal : {"INT", "TERM", "HUP"}) {
    for (const std::string& command : {"steady " + mathieu + " --omega 1", "sweep " + mathieu + " --omega 1:1.5:0.1"}) {
      fs::remove_all(folder_ / "out");
      fs::remove(folder_ / "pid");
      const int status = shell("PATH=\"$PWD/bin:$PATH\" HB_TEST_PID=\"$PWD/pid\" \"$HB\" " + command +
                               " --out out >printed 2>said </dev/null & child=$!\n"
                               "while [ ! -s pid ] && kill -0 $child 2>/dev/null; do sleep 0.02; done\n"
                               "kill -" +
                               signal + " $child; wait $child");
      EXPECT_EQ(status, 130) << signal << read(folder_ / "said");
      EXPECT_NE(read(folder_ / "printed").find("stable"), std::string::npos) << signal;
      EXPECT_TRUE(fs::exists(folder_ / (command[1] == 't' ? "out/steady.json" : "out/sweep.json")));
      EXPECT_FALSE(has_scratch("out")) << signal;
      EXPECT_EQ(names({"bin", "pid", "printed", "said"}), std::vector<std::string>{"out"}) << signal;
      EXPECT_NE(kill(std::stoi(read(folder_ / "pid")), 0), 0) << signal;
    }
  }
}

TEST_F(Faults, AfterAKillWhileDrawingTheNextRunSaysSoAndClearsUp) {
  with_program("gnuplot", "echo $$ >\"$HB_TEST_PID\"; exec sleep 1000");
  shell("PATH=\"$PWD/bin:$PATH\" HB_TEST_PID=\"$PWD/pid\" \"$HB\" steady " + mathieu +
        " --omega 1 --out out >printed 2>said </dev/null & child=$!\n"
        "while [ ! -s pid ] && kill -0 $child 2>/dev/null; do sleep 0.02; done\nkill -KILL $child; wait $child");
  EXPECT_TRUE(fs::exists(folder_ / "out/steady.json"));
  EXPECT_NE(read(folder_ / "printed").find("stable"), std::string::npos);
  ASSERT_TRUE(has_scratch("out"));
  const CommandResult next = hb("steady " + mathieu + " --omega 1 --no-plots --out out");
  EXPECT_EQ(next.status, 0) << next.err;
  EXPECT_NE(next.err.find("lock"), std::string::npos) << next.err;
  EXPECT_NE(next.err.find("process"), std::string::npos) << next.err;
  EXPECT_FALSE(has_scratch("out"));
  EXPECT_EQ(hb("steady " + mathieu + " --omega 1 --no-plots --out out").err.find("lock"), std::string::npos);
}

// A full disk deleted the finished parts, those of earlier runs too.
TEST_F(Faults, AFullDiskAtAResumeKeepsTheParts) {
  const CommandResult whole = hb(long_sweep);
  ASSERT_EQ(stopped_by("KILL", long_sweep + "--out out", "out.part"), 137);
  const std::string kept = read(folder_ / "out.part");
  // Room for what is there already, not for the files of the answer.
  shell("{ ( ulimit -f 4; \"$HB\" " + long_sweep + "--out out --resume 2>said; echo $? >status ) | cat >printed; }");
  EXPECT_EQ(read(folder_ / "status"), "2\n");
  EXPECT_NE(read(folder_ / "said").find("cannot be written"), std::string::npos) << read(folder_ / "said");
  EXPECT_EQ(read(folder_ / "printed"), whole.out);
  for (const char* file : {"said", "printed", "status"}) fs::remove(folder_ / file);
  EXPECT_EQ(read(folder_ / "out.part").substr(0, kept.size()), kept);
  const CommandResult rest = hb(long_sweep + "--out out --resume");
  EXPECT_EQ(rest.status, whole.status) << rest.err;
  EXPECT_EQ(rest.out, whole.out);
  EXPECT_EQ(names(), std::vector<std::string>{"out"});
}

TEST_F(Faults, NoMemoryKeepsTheParts) {
  ASSERT_EQ(stopped_by("KILL", long_sweep + "--out out", "out.part"), 137);
  const std::string kept = read(folder_ / "out.part");
  for (const int megabytes : {60, 90, 120}) {
    const CommandResult result =
        hb(long_sweep + "--out out --resume", "ulimit -v " + std::to_string(1000 * megabytes) + ";");
    if (result.status == 0 || result.status == 3) return;  // it was enough
    EXPECT_NE(result.status, 134) << result.err;
    EXPECT_EQ(read(folder_ / "out.part").substr(0, kept.size()), kept) << megabytes;
  }
}

// The same command without --resume began anew over the finished parts, without a word.
TEST_F(Faults, FinishedPartsAreOnlyThrownAwayOnRequest) {
  ASSERT_EQ(stopped_by("KILL", long_sweep + "--out out", "out.part"), 137);
  const std::string kept = read(folder_ / "out.part");
  for (const char* other : {"", "--set AB.J=46 ", "--tol 1e-8 "}) {
    const CommandResult again = hb(long_sweep + other + "--out out");
    EXPECT_EQ(again.status, 2) << again.err;
    EXPECT_EQ(again.out, "");
    EXPECT_NE(again.err.find("--resume"), std::string::npos) << again.err;
    EXPECT_NE(again.err.find("--restart"), std::string::npos) << again.err;
    EXPECT_EQ(read(folder_ / "out.part"), kept);
  }
  EXPECT_EQ(hb(long_sweep + "--out out --resume --restart").status, 2);
  EXPECT_EQ(hb("sweep " + mathieu + " --omega 1:1.5:0.1 --no-plots --restart").status, 2);
  EXPECT_EQ(read(folder_ / "out.part"), kept);
  const CommandResult anew = hb("sweep " + mathieu + " --omega 1:1.5:0.1 --no-plots --out out --restart");
  EXPECT_EQ(anew.status, 0) << anew.err;
  EXPECT_EQ(names(), std::vector<std::string>{"out"});
}

TEST_F(Faults, PartsThatAreNotOfHbOrOfAnotherVersionAreNotTouched) {
  std::ofstream(folder_ / "out.part") << "my own part";
  for (const char* flag : {"", " --resume", " --restart"}) {
    const CommandResult result = hb("sweep " + mathieu + " --omega 1:1.5:0.1 --no-plots --out out" + flag);
    EXPECT_EQ(result.status, 2) << flag;
    EXPECT_NE(result.err.find("out.part"), std::string::npos) << result.err;
    EXPECT_EQ(read(folder_ / "out.part"), "my own part");
  }
  fs::remove(folder_ / "out.part");
  ASSERT_EQ(stopped_by("KILL", long_sweep + "--out out", "out.part"), 137);
  std::string kept = read(folder_ / "out.part");
  const std::size_t version = kept.find("hb ");
  ASSERT_NE(version, std::string::npos);
  kept[version + 3] = '9';
  std::ofstream(folder_ / "out.part", std::ios::binary) << kept;
  const CommandResult result = hb(long_sweep + "--out out --resume");
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("hb 9"), std::string::npos) << result.err;
  EXPECT_EQ(read(folder_ / "out.part"), kept);
}

// Two runs into one folder: one of them lost everything at its end.
TEST_F(Faults, ASecondRunIntoTheSameFolderIsRefusedAtOnce) {
  for (const char* place : {"out", "new/out"}) {
    fs::create_directory(folder_ / "out");
    fs::create_symlink("out", folder_ / "link");
    const std::string folder = place;
    const int status = shell("\"$HB\" " + long_sweep + "--rods AB --out " + folder +
                             " >/dev/null 2>&1 </dev/null & child=$!\n"
                             "while [ ! -s " +
                             folder +
                             ".part ]; do sleep 0.02; done\n"
                             "\"$HB\" steady " +
                             mathieu + " --omega 1 --out " + (folder == "out" ? "./link/" : folder) +
                             " >printed 2>said; second=$?\n"
                             "echo $child >pid; wait $child; echo $? >first; exit $second");
    EXPECT_EQ(status, 2);
    EXPECT_EQ(read(folder_ / "printed"), "");
    const std::string said = read(folder_ / "said"), pid = read(folder_ / "pid");
    EXPECT_NE(said.find("process " + pid.substr(0, pid.size() - 1) + ","), std::string::npos) << said << pid;
    EXPECT_NE(said.find("started 2"), std::string::npos) << said;
    EXPECT_NE(said.find("allowed"), std::string::npos) << said;
    EXPECT_TRUE(fs::exists(folder_ / folder / "sweep.json")) << read(folder_ / "first");
    for (const char* name : {"out", "link", "new"}) fs::remove_all(folder_ / name);
  }
}

TEST_F(Faults, AFolderMadeMeanwhileGetsTheFilesBesideItsOwn) {
  shell("\"$HB\" " + long_sweep +
        "--rods AB --out out >printed 2>said </dev/null & child=$!\n"
        "while [ ! -s out.part ]; do sleep 0.02; done\nmkdir out; echo mine >out/mine; wait $child");
  EXPECT_TRUE(fs::exists(folder_ / "out/sweep.json")) << read(folder_ / "said");
  EXPECT_EQ(read(folder_ / "out/mine"), "mine\n");
  EXPECT_EQ(names({"printed", "said"}), std::vector<std::string>{"out"});
}

TEST_F(Faults, ALinkToNowhereMadeMeanwhileKeepsThePartsAndPrints) {
  const int status = shell("\"$HB\" " + long_sweep +
                           "--rods AB --out out >printed 2>said </dev/null & child=$!\n"
                           "while [ ! -s out.part ]; do sleep 0.02; done\nln -s nowhere out; wait $child");
  EXPECT_EQ(status, 2);
  EXPECT_TRUE(fs::exists(folder_ / "out.part"));
  EXPECT_NE(read(folder_ / "printed").find("AB"), std::string::npos);
  EXPECT_NE(read(folder_ / "said").find("--resume"), std::string::npos) << read(folder_ / "said");
  // At the start such a link is refused.
  const CommandResult later = hb("steady " + mathieu + " --omega 1 --out out");
  EXPECT_EQ(later.status, 2);
  EXPECT_NE(later.err.find("nowhere"), std::string::npos) << later.err;
}

// A user's torque.csv was overwritten without a word.
TEST_F(Faults, FilesOfOthersWithNamesOfOursAreKept) {
  fs::create_directory(folder_ / "out");
  for (const char* name : {"steady.json", "response_system.csv"}) std::ofstream(folder_ / "out" / name) << "mine";
  fs::create_symlink("../elsewhere", folder_ / "out/fourier_system.csv");
  const std::string command = "steady " + mathieu + " --omega 1 --no-plots --out out";
  const CommandResult result = hb(command);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(read(folder_ / "out/steady.json.~1~"), "mine");
  EXPECT_EQ(read(folder_ / "out/response_system.csv.~1~"), "mine");
  EXPECT_TRUE(fs::is_symlink(folder_ / "out/fourier_system.csv.~1~"));
  EXPECT_NE(result.err.find("steady.json.~1~"), std::string::npos) << result.err;
  const std::size_t entries = num_entries(folder_ / "out");
  const CommandResult again = hb(command);
  EXPECT_NE(again.err.find("replaced"), std::string::npos) << again.err;
  EXPECT_EQ(num_entries(folder_ / "out"), entries);
}

// `hb steady` overwrote the pictures and the script of `hb sweep` in the same folder.
TEST_F(Faults, CommandsInOneFolderDoNotTouchEachOthersFiles) {
  const std::string slider = "'" HB_SOURCE_DIR "/tests/scenes/slider_crank.toml' --modes 1 --out out ";
  std::map<std::string, std::string> before;
  const std::vector<std::string> commands = {"sweep " + slider + "--rpm 2000:4000:1000",
                                             "steady " + slider + "--rpm 600",
                                             "map " + slider + "--x rpm=2000:4000:3 --y rod.J=20:40:3",
                                             "scene '" HB_SOURCE_DIR "/tests/scenes/slider_crank.toml' --out out",
                                             "check " + slider + "--rpm 600 --only steady",
                                             "bench " + slider + "--rpm 600 --case-limit 0.01"};
  for (const std::string& command : commands) {
    const CommandResult result = hb(command);
    ASSERT_NE(result.status, 2) << result.err;
    const std::map<std::string, std::string> after = files("out");
    EXPECT_GT(after.size(), before.size()) << command;
    for (const auto& [name, text] : before) {
      ASSERT_TRUE(after.contains(name)) << name;
      EXPECT_EQ(after.at(name), text) << name << " of an earlier command, after " << command;
    }
    EXPECT_EQ(result.err.find("~1~"), std::string::npos) << result.err;
    before = after;
  }
}

// "internal error: cannot write to file" and a second message.
TEST_F(Faults, AFullStandardOutputIsSaidOnceAfterTheFilesAreWritten) {
  for (const std::string& flags : {std::string(), std::string(" --json")}) {
    const int status =
        shell("\"$HB\" steady " + mathieu + " --omega 1 --no-plots --out out" + flags + " >/dev/full 2>said");
    EXPECT_EQ(status, 2);
    const std::string said = read(folder_ / "said");
    EXPECT_NE(said.find("standard output cannot be written: No space left"), std::string::npos) << said;
    EXPECT_EQ(said.find("internal"), std::string::npos) << said;
    EXPECT_EQ(said.find("standard output", said.find("standard output") + 1), std::string::npos) << said;
    EXPECT_TRUE(fs::exists(folder_ / "out/steady.json"));
  }
}

TEST_F(Faults, AReaderThatStopsReadingIsToldNothingAndFilesAreWhole) {
  shell("\"$HB\" sweep " + mathieu + " --omega 1:1.5:0.0005 --json --no-plots --out out 2>said | head -c 1 >/dev/null");
  EXPECT_EQ(read(folder_ / "said"), "");
  EXPECT_EQ(Json::parse(read(folder_ / "out/sweep.json"))["omega"].size(), 1001u);
}

// Escape sequences and marks that turn the direction of writing went from a scene's names to the terminal.
TEST_F(Faults, ControlCharactersInNamesAndTitlesAreNeverPrintedRaw) {
  std::string text = read(HB_SOURCE_DIR "/tests/scenes/six_link.toml");
  const std::string turn = "\\u202e\\u009b", end = "]]>";
  const auto name = text.find("\"AB\"");
  ASSERT_NE(name, std::string::npos);
  text.replace(name, 4, "\"r" + turn + end + "od\"");
  const auto title = text.find("title = \"");
  ASSERT_NE(title, std::string::npos);
  text.insert(title + 9, "T" + turn + end + " & <b> '");
  std::ofstream(folder_ / "scene.toml") << text;
  const auto clean = [](const std::string& shown) {
    for (const char* raw : {"\033", "\007", "\u202e", "\u009b"})
      if (shown.find(raw) != std::string::npos) return false;
    return true;
  };
  const CommandResult table = hb("steady scene.toml --rpm 600 --modes 1 --out out");
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_TRUE(clean(table.out)) << table.out;
  EXPECT_TRUE(clean(table.err)) << table.err;
  const CommandResult json = hb("steady scene.toml --rpm 600 --modes 1 --json");
  EXPECT_TRUE(clean(json.out));
  EXPECT_TRUE(Json::parse(json.out)["rods"].contains("r\u202e\u009b]]>od")) << json.out;
  EXPECT_TRUE(clean(hb("scene scene.toml").out));
  const CommandResult wrong = hb("steady scene.toml --rpm 600 --rods '\033[31mX'");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_TRUE(clean(wrong.err)) << wrong.err;
  for (const auto& [file, contents] : files("out")) {
    EXPECT_TRUE(clean(file)) << file;
    if (file.ends_with(".png")) continue;
    EXPECT_TRUE(clean(contents)) << file;
    // Which may not stand in the text of XML.
    if (file.ends_with(".svg")) {
      EXPECT_EQ(contents.find("]]>"), std::string::npos) << file;
    }
  }
}

// No output file said where it came from.
TEST_F(Faults, EveryFileNamesProgramCommandAndScene) {
  const std::string command = " six_link.toml --rpm 300 --set AB.J=46 --modes 2 ";
  fs::copy_file(HB_SOURCE_DIR "/tests/scenes/six_link.toml", folder_ / "six_link.toml");
  const CommandResult plain = hb("steady" + command + "--json");
  ASSERT_EQ(hb("steady" + command + "--json --out out --threads 2").out, plain.out);
  ASSERT_EQ(hb("steady" + command + "--out again").status, 0);
  EXPECT_EQ(plain.out.find("provenance"), std::string::npos);
  const std::map<std::string, std::string> first = files("out"), second = files("again");
  EXPECT_GT(first.size(), 20u);
  for (const auto& [name, text] : first) {
    // Where it went and how many threads there were is none of its business.
    EXPECT_EQ(text, second.at(name)) << name;
    if (name.starts_with(".hb-")) continue;
    EXPECT_NE(text.find("hb 0."), std::string::npos) << name;
    EXPECT_NE(text.find("hb steady six_link.toml --rpm 300 --set AB.J=46 --modes 2"), std::string::npos) << name;
    EXPECT_NE(text.find("six_link.toml"), std::string::npos) << name;
  }
  const Json json = Json::parse(first.at("steady.json"));
  EXPECT_EQ(json["provenance"]["scene"]["text"], read(folder_ / "six_link.toml"));
  Json without = json;
  without.erase("provenance");
  EXPECT_EQ(without, Json::parse(plain.out));
}

TEST(Crc32, OfTheCheckString) { EXPECT_EQ(hb::tools::crc32("123456789"), 0xcbf43926u); }

TEST_F(Faults, ASceneMayComeFromStandardInputOrAPipe) {
  const std::string expected = hb("steady " + mathieu + " --omega 1").out;
  for (const char* from : {"cat SCENE | \"$HB\" steady - --omega 1", "\"$HB\" steady - --omega 1 <SCENE",
                           "mkfifo pipe; cat SCENE >pipe & \"$HB\" steady pipe --omega 1"}) {
    std::string line = from;
    line.replace(line.find("SCENE"), 5, mathieu);
    EXPECT_EQ(shell(line + " >printed"), 0) << from;
    EXPECT_EQ(read(folder_ / "printed"), expected) << from;
  }
  EXPECT_EQ(shell("\"$HB\" steady - --omega 1 </dev/null 2>said"), 2);
  EXPECT_NE(read(folder_ / "said").find("standard input"), std::string::npos);
  for (const char* device : {"/dev/full", "/dev/zero", "/dev/null"}) {
    const CommandResult result = hb(std::string("scene ") + device);
    EXPECT_EQ(result.status, 2) << device;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

TEST_F(Faults, AllThreadsMayBeAskedFor) {
  EXPECT_EQ(hb("steady " + mathieu + " --omega 1 --threads all").out, hb("steady " + mathieu + " --omega 1").out);
}

}  // namespace
