// What is told of the versions of a game, whichever of them was played last.

#include "tests/apps/command_line.h"
#include "tests/apps/two_versions.h"

namespace headpin {
namespace {

using VersionsTold = CommandLine;

TEST_F(VersionsTold, DetectionIsThatOfEachAndNullWhereTheyDiffer) {
  write_two_versions(folder_ / "two.lcmlog");  // red, then blue
  const std::string blue = " --set version.blue.detection=paper --set version.blue.iterations=5";
  const nlohmann::json all = json("replay two.lcmlog --json -o played.lcmlog" + blue);
  EXPECT_TRUE(all["detection"].is_null());
  EXPECT_TRUE(all["iterations"].is_null());
  EXPECT_EQ(all["versions"]["red"]["detection"], "converged");  // of the trial, not of what is on
  EXPECT_EQ(all["versions"]["red"]["iterations"], 20);
  EXPECT_EQ(all["versions"]["blue"]["detection"], "paper");
  EXPECT_EQ(all["versions"]["blue"]["iterations"], 5);
  const nlohmann::json compared = json("compare played.lcmlog played.lcmlog --json")["a"];
  EXPECT_EQ(compared["versions"], all["versions"]);
  EXPECT_TRUE(compared["detection"].is_null());
  // Of versions that agree in it.
  const nlohmann::json same = json("replay two.lcmlog --json --detection paper --iterations 7");
  EXPECT_EQ(same["detection"], "paper");
  EXPECT_EQ(same["iterations"], 7);
  EXPECT_EQ(same["versions"]["red"]["detection"], "paper");
  EXPECT_EQ(same["versions"]["blue"]["iterations"], 7);
}

}  // namespace
}  // namespace headpin
