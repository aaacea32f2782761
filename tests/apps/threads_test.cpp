// Commands that work in several threads, where the system makes few or none.

#include "tests/apps/command_line.h"

namespace headpin {
namespace {

class FewThreads : public CommandLine {
 protected:
  void SetUp() override {
#ifdef HEADPIN_SANITIZED
    GTEST_SKIP() << "sanitizers have to be loaded first";
#endif
  }

  /// Runs `headpin ARGUMENTS` where only so many threads can be made.
  nlohmann::json with_threads(int threads, const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() +
                                "' && THREADS=" + std::to_string(threads) +
                                " LD_PRELOAD='" NO_THREADS "' '" HEADPIN_PROGRAM "' " + arguments +
                                " --json >out.txt 2>err.txt </dev/null";
    const int status = std::system(command.c_str());
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
        << arguments << ": " << status << "\n"
        << slurp(folder_ / "err.txt");
    return nlohmann::json::parse(slurp(folder_ / "out.txt"), nullptr, false);
  }
};

TEST_F(FewThreads, ASweepGoesOnWithThem) {
  ASSERT_EQ(headpin("synthesize -o throw.lcmlog --seed 4").code, 0);
  std::ofstream(folder_ / "sweep.toml")
      << "trials = ['throw.lcmlog']\n[grid]\nelasticity = [0, 0.5, 1]\n";
  for (const int threads : {0, 2}) {
    const std::string sweep = "sweep" + std::to_string(threads);
    ASSERT_EQ(headpin("sweep plan sweep.toml -o " + sweep).code, 0);
    EXPECT_EQ(with_threads(threads, "sweep run " + sweep + " --jobs 4")["simulated"], 3);
  }
}

TEST_F(FewThreads, AStudyGoesOnWithThem) {
  std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
  text.replace(text.find("throws = 10"), 11, "throws = 1");
  std::ofstream(folder_ / "short.toml") << text;
  for (const int threads : {0, 2}) {
    const std::string study = "study" + std::to_string(threads);
    ASSERT_EQ(headpin("experiment plan --design short.toml --people 3 -o " + study).code, 0);
    const nlohmann::json played =
        with_threads(threads, "experiment run " + study + " --all --virtual --jobs 4");
    EXPECT_EQ(played["sessions"].size(), 3u);
    EXPECT_EQ(with_threads(threads, "experiment score " + study + " --jobs 4"),
              json("experiment score " + study + " --json"));
  }
}

TEST_F(FewThreads, PowerIsTheSameWithThem) {
  const std::string line = "experiment power --people 18,36 --studies 5 --seed 3";
  const nlohmann::json power = json(line + " --json");
  for (const int threads : {0, 1}) EXPECT_EQ(with_threads(threads, line + " --jobs 4"), power);
}

TEST_F(FewThreads, AThrowIsMadeAgainWithThem) {
  for (const int threads : {0, 2}) {
    const nlohmann::json told =
        with_threads(threads, "whatif '" + kDemo + "' -o w" + std::to_string(threads) +
                                  " --within 10 --step 5 --speed 1 --direction 0 --height 0 "
                                  "--spin 0 --jobs 4");
    EXPECT_EQ(told["moments"], 5);
  }
}

}  // namespace
}  // namespace headpin
