#include <map>

#include <zlib.h>

#include "apps/page_file.h"
#include "scene/record/log.h"
#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kBase64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=";

// The examples of RFC 4648, section 10, and one with the two digits that are no letters.
TEST(Base64, IsThatOfTheStandard) {
  const std::map<std::string, std::string> examples = {{"", ""},
                                                       {"f", "Zg=="},
                                                       {"fo", "Zm8="},
                                                       {"foo", "Zm9v"},
                                                       {"foob", "Zm9vYg=="},
                                                       {"fooba", "Zm9vYmE="},
                                                       {"foobar", "Zm9vYmFy"},
                                                       {"\xfb\xff\xbe", "+/++"}};
  for (const auto& [bytes, text] : examples) {
    EXPECT_EQ(apps::base64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}),
              text);
  }
}

/// The page is made elsewhere (apps/report); here stands what a trial is put into.
class Report : public CommandLine {
 protected:
  Report() { write("page.html", "<html><!--headpin:data--></html>"); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
};

TEST_F(Report, HoldsTheTrialAsTextThatNoBrowserReadsAsHtml) {
  const scene::Trial demo = scene::read_trial(kDemo);
  scene::TrialHeader header = demo.header;
  header.participant = "</script><script>alert('\"1\"')</script>" + std::string(10'000, 'x');
  header.condition = "--><!--headpin:data-->\x01\xff";
  {
    scene::Recorder recorder(folder_ / "hostile.lcmlog", header);
    scene::write(recorder, demo.samples, demo.events);
    recorder.close();
  }
  ASSERT_EQ(headpin("report hostile.lcmlog -o out.html --page page.html").code, 0);
  const std::string page = slurp(folder_ / "out.html");
  for (std::size_t at = page.find("\">"); at != std::string::npos; at = page.find("\">", at + 1)) {
    const std::size_t end = page.find_first_not_of(kBase64, at + 2);
    EXPECT_EQ(page.substr(end, 9), "</script>");
  }
  EXPECT_THAT(page, Not(HasSubstr("alert")));
  EXPECT_THAT(page, Not(HasSubstr("headpin:data")));
  EXPECT_THAT(page, HasSubstr("data-block=\"log\""));
}

TEST_F(Report, OfTheSameTrialIsTheSameBytes) {
  const nlohmann::json made = json("report --json " + kDemo + " -o a.html --page page.html");
  EXPECT_EQ(made["state_hash"], json("replay --json " + kDemo)["state_hash"]);
  EXPECT_EQ(made["bytes"], fs::file_size(folder_ / "a.html"));
  fs::rename(folder_ / "a.html", folder_ / "b.html");
  ASSERT_EQ(headpin("report " + kDemo + " -o a.html --page page.html").code, 0);
  EXPECT_EQ(slurp(folder_ / "a.html"), slurp(folder_ / "b.html"));
  EXPECT_LT(fs::file_size(folder_ / "a.html"), 500'000u);  // the page itself is 230 kB
}

TEST_F(Report, ALogWithoutItsStatesIsInThePageAndSimulatesToTheSameBits) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
  const std::vector<std::uint8_t> inputs = apps::log_of_inputs(folder_ / "game.lcmlog");
  write("inputs.lcmlog", std::string(inputs.begin(), inputs.end()));
  const nlohmann::json info = json("info --json inputs.lcmlog");
  EXPECT_EQ(info["ticks"], 0);
  EXPECT_FALSE(info["channels"].contains("STATE") || info["channels"].contains("STATE_CHANGE"));
  EXPECT_EQ(info["skipped"]["bytes"], 0);
  EXPECT_EQ(json("replay --json inputs.lcmlog")["state_hash"],
            json("replay --json game.lcmlog")["state_hash"]);
  EXPECT_LT(inputs.size(),
            fs::file_size(folder_ / kDemo) + 30'000);  // events of a replay, newer messages
}

TEST_F(Report, RefusesWhatItCannotShowOrFillIn) {
  write("empty.lcmlog", "");
  write("other.html", "<html></html>");
  expect_refusal("report empty.lcmlog -o OUT.html --page page.html", 1, "empty.lcmlog");
  expect_refusal("report none.lcmlog -o OUT.html --page page.html", 1, "none.lcmlog");
  expect_refusal("report " + kDemo + " -o OUT.html --page other.html", 1, "headpin:data");
  expect_refusal("report " + kDemo + " -o OUT.html --page none.html", 1, "none.html");
  expect_refusal("report " + kDemo + " none.lcmlog -o OUT.html --page page.html", 1, "none.lcmlog");
  ASSERT_EQ(headpin("replay " + kDemo + " --set rates.physics_hz=480 -o fast.lcmlog").code, 0);
  expect_refusal("report " + kDemo + " fast.lcmlog -o OUT.html --page page.html", 1,
                 "480 ticks a second; expected 240");
  expect_refusal("report " + kDemo, 2, "--output");
  write("there.html", "mine");
  EXPECT_EQ(headpin("report " + kDemo + " -o there.html --page page.html").code, 1);
  EXPECT_EQ(slurp(folder_ / "there.html"), "mine");
}

TEST_F(Report, ALogThatIsCutOffIsShownUpToThere) {
  const std::string whole = slurp(kDemo);
  write("cut.lcmlog", whole.substr(0, whole.size() / 2));
  const nlohmann::json made = json("report --json cut.lcmlog -o out.html --page page.html");
  EXPECT_LT(made["ticks"], json("replay --json " + kDemo)["ticks"]);
}

TEST_F(Report, AThrowThatATrialDoesNotHaveIsRefusedByTheOptionThatNamesIt) {
  expect_refusal("report " + kDemo + " -o OUT.html --page page.html --whatif 99", 2,
                 "--whatif: expected a throw of ");
  const std::string whole = slurp(kDemo);
  write("cut.lcmlog", whole.substr(0, whole.size() / 4));  // before the release
  const Result cut = headpin("report cut.lcmlog -o OUT.html --page page.html --whatif 1");
  EXPECT_EQ(cut.code, 1);
  EXPECT_THAT(cut.err, HasSubstr("cut.lcmlog: has no throw; expected"));
  const std::size_t first = cut.err.find("is incomplete");
  EXPECT_NE(first, std::string::npos) << cut.err;
  EXPECT_EQ(cut.err.find("is incomplete", first + 1), std::string::npos) << cut.err;
}

TEST_F(Report, AVideoPastTwentyMegabytesLiesBesideThePage) {
  write("both.mp4", "1234ftypisom");
  write("long.mp4", "1234ftyp" + std::string(20'000'000, 'v'));
  const std::string words = "report " + kDemo + " --page page.html -o ";
  ASSERT_EQ(headpin(words + "short.html --video both.mp4").code, 0);
  EXPECT_THAT(slurp(folder_ / "short.html"), HasSubstr("data-block=\"video\""));
  EXPECT_FALSE(fs::exists(folder_ / "short.mp4"));
  ASSERT_EQ(headpin(words + "trial.html --video long.mp4").code, 0);
  EXPECT_THAT(slurp(folder_ / "trial.html"), Not(HasSubstr("data-block=\"video\"")));
  EXPECT_EQ(slurp(folder_ / "trial.mp4"), slurp(folder_ / "long.mp4"));
  write("other.mp4", "mine");  // where the video would go
  EXPECT_EQ(headpin(words + "other.html --video long.mp4").code, 1);
  EXPECT_EQ(slurp(folder_ / "other.mp4"), "mine");
  EXPECT_FALSE(fs::exists(folder_ / "other.html"));
}

// `frames --video` writes two: the one that it is called by is not the one that a browser shows.
TEST_F(Report, AVideoThatIsNoMp4IsRefused) {
  write("stereo.mkv", "\x1a\x45\xdf\xa3" + std::string(20'000'001, 'v'));
  write("stereo.mp4", "1234ftyp, good");
  const std::string words = "report " + kDemo + " --page page.html --force -o ";
  expect_refusal(words + "stereo.html --video stereo.mkv", 2,
                 "--video stereo.mkv: expected an MP4");
  EXPECT_EQ(slurp(folder_ / "stereo.mp4"), "1234ftyp, good");
  EXPECT_EQ(headpin(words + "OUT.html --video '" + kDemo + "'").code, 2);
  EXPECT_FALSE(fs::exists(folder_ / "OUT.html"));
}

TEST_F(Report, NumbersInQuantaAreDifferencesInSevenBitsAByte) {
  scene::PageData data;
  data.floats = {1.0f, 0.5f, 0.0f, 100.0f};  // two columns, two rows
  data.json["sections"] = {
      {{"offset", 0}, {"rows", 2}, {"columns", {"a", "b"}}, {"quanta", {1.0, 0.25}}}};
  // a: 1, then -1; b: 2, then 398. Zigzag: 2, 1; 4, 796 = 6 * 128 + 28.
  EXPECT_THAT(apps::in_quanta(data), testing::ElementsAre(2, 1, 4, 0x80 | 28, 6));
}

/// The text of a block of a page.
std::string block_of(const std::string& page, const std::string& name) {
  const std::string begins = "data-block=\"" + name + "\">";
  const std::size_t begin = page.find(begins) + begins.size();
  std::string packed;
  std::uint32_t bits = 0;
  int count = 0;
  for (std::size_t at = begin; page.at(at) != '<' && page.at(at) != '='; ++at) {
    bits = bits << 6 | static_cast<std::uint32_t>(std::string_view(kBase64).find(page[at]));
    if ((count += 6) >= 8) packed += static_cast<char>(bits >> (count -= 8) & 0xff);
  }
  std::string text(1'000'000, '\0');
  uLongf size = text.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(text.data()), &size,
                       reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
            Z_OK);
  return text.substr(0, size);
}

TEST_F(Report, TellsTheCommandThatMakesItAgain) {
  const std::string words = "report '" + kDemo + "' -o 'out.html' --page 'page.html'";
  for (const std::string more : {"", " --longest-gap 90"}) {
    ASSERT_EQ(headpin(words + more + " --force").code, 0) << more;
    const auto about = nlohmann::json::parse(block_of(slurp(folder_ / "out.html"), "about"));
    EXPECT_EQ(about["command"], "headpin " + words + more);
  }
}

}  // namespace
}  // namespace headpin
