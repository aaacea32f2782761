// What commands say of lines and LCM URLs that are wrong, or where nobody answers.

#include <cstdlib>
#include <fstream>

#include "scene/record/log.h"
#include "tests/apps/command_line.h"
#include "tests/support/lcm_server.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class LinesAndUrls : public CommandLine {
 protected:
  LinesAndUrls() { unsetenv("LCM_DEFAULT_URL"); }
  ~LinesAndUrls() override { unsetenv("LCM_DEFAULT_URL"); }
};

// liblcm aborts when it waits for messages without a connection.
TEST_F(LinesAndUrls, WithoutAServerOfLcmNothingBegins) {
  const LocalPort silent;
  const LocalLcmServer closes(false);
  for (const std::string& url : {silent.url(), closes.url()}) {
    const std::string says =
        url + ": no LCM server answers there; expected a running lcm-tcpq-server";
    expect_refusal("live lcm:" + url + " --eyes none", 1, "headpin live: lcm:" + says);
    expect_refusal("live --lcm " + url + " --eyes none --record OUT", 1, "lcm:" + says);
    expect_refusal("emulate --lcm " + url, 1, "lcm:" + says);
    expect_refusal("emulate --mouse " + url, 1, "--mouse " + says);
    expect_refusal("stream " + kDemo + " --speed 0 --lcm " + url, 1, "--lcm " + says);
  }
}

TEST_F(LinesAndUrls, AServerOfLcmThatGoesAwayEndsASessionInOrder) {
  LocalLcmServer server(true);
  const std::string record = (folder_ / "live.lcmlog").string();
  const pid_t process =
      started({"live", "lcm:" + server.url(), "--eyes", "none", "--record", record});
  int status = 0;
  while (!fs::exists(record) && waitpid(process, &status, WNOHANG) == 0) usleep(1000);
  ASSERT_TRUE(fs::exists(record)) << status;
  server.close_all();
  ASSERT_EQ(waitpid(process, &status, 0), process);
  ASSERT_TRUE(WIFEXITED(status)) << status;
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_TRUE(scene::read_trial(record).complete);
}

TEST_F(LinesAndUrls, AWrongUrlOfLcmIsRefusedWithItsOption) {
  const std::string no_url =
      ": expected an LCM URL such as udpm://239.255.76.67:7667?ttl=0 or file://LOG?mode=w";
  expect_refusal("live --lcm foo", 2, "headpin live: --lcm foo" + no_url);
  expect_refusal("live lcm:http://foo", 2, "headpin live: lcm:http://foo" + no_url);
  expect_refusal("stream " + kDemo + " --lcm udpm:239.255.76.67:7667", 2,
                 "--lcm udpm:239.255.76.67:7667" + no_url);
  expect_refusal("emulate --mouse foo", 2, "--mouse foo" + no_url);
  expect_refusal("stream " + kDemo + " --lcm udpm://1.2.3.4:7667", 2,
                 "--lcm udpm://1.2.3.4:7667: expected udpm://ADDRESS:PORT with an address from "
                 "224.0.0.0 to 239.255.255.255 and a port from 1 to 65535");
  expect_refusal("live --lcm udpm://239.255.76.67:99999", 2, "and a port from 1 to 65535");
  expect_refusal("emulate --lcm 'udpm://?tll=0'", 2,
                 "--lcm udpm://?tll=0: unknown parameter 'tll'; expected ttl or recv_buf_size");
  expect_refusal("live 'lcm:udpm://?ttl=abc'", 2,
                 "lcm:udpm://?ttl=abc: ttl: expected a whole number from 0 to 255, found abc");
  setenv("LCM_DEFAULT_URL", "foo", 1);
  for (const std::string& command : {std::string("live lcm:"), "stream " + kDemo}) {
    expect_refusal(command, 2, "LCM_DEFAULT_URL in the environment" + no_url + ", found 'foo'");
  }
}

TEST_F(LinesAndUrls, ALogThatIsReadIsNotWrittenToAndTheOtherWayRound) {
  const std::string says =
      "file://OUT.lcmlog: this would be read; to write a log, expected "
      "file://OUT.lcmlog?mode=w";
  expect_refusal("stream " + kDemo + " --lcm file://OUT.lcmlog", 2, "--lcm " + says);
  expect_refusal("emulate --mouse file://OUT.lcmlog", 2, "--mouse " + says);
  const std::string written =
      "file://OUT.lcmlog?mode=w: this would be written; to read a log, expected file://OUT.lcmlog";
  expect_refusal("live 'lcm:file://OUT.lcmlog?mode=w'", 2, "lcm:" + written);
  expect_refusal("live --lcm 'file://OUT.lcmlog?mode=w'", 2, "--lcm " + written);
  expect_refusal("live lcm:file://", 2,
                 "lcm:file://: expected the name of a log after file://, found nothing");
  EXPECT_EQ(headpin("stream " + kDemo + " --speed 0 --lcm 'file://log.lcmlog?mode=w'").code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "log.lcmlog"));
}

TEST_F(LinesAndUrls, ALineThatIsNoneIsSaidToBeSo) {
  std::ofstream(folder_ / "text.txt") << "text";
  fs::create_directory(folder_ / "dir");
  const LocalPort silent;
  const std::string tcp = "tcp:127.0.0.1:" + std::to_string(silent.number());
  const std::string none =
      ": there is no such serial port; expected a serial port such as /dev/ttyUSB0, or "
      "tcp:HOST:PORT";
  for (const std::string command : {"conformance ", "live --fastrak "}) {
    expect_refusal(command + "/dev/no-such-port", 1, ": /dev/no-such-port" + none);
    expect_refusal(command + "udp:127.0.0.1:1", 1, ": udp:127.0.0.1:1" + none);
    expect_refusal(command + "text.txt", 1, ": text.txt: expected a serial port, found a file");
    expect_refusal(command + "dir", 1, ": dir: expected a serial port, found a folder");
    expect_refusal(command + tcp, 1, ": " + tcp + ": nobody answers there: Connection refused");
    expect_refusal(command + "tcp:foo", 2, ": tcp:foo: expected tcp:HOST:PORT");
  }
  for (const std::string line : {"fastrak:", "--fastrak ''"}) {
    expect_refusal("live " + line, 2,
                   "headpin live: fastrak: expected the name of a serial port or tcp:HOST:PORT "
                   "after the colon, found nothing");
  }
}

TEST_F(LinesAndUrls, AnUnknownClientIsRefusedWithTheKnownOnes) {
  const Result result = headpin("conformance line --client VES");
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("headpin conformance: --client: expected "));
  EXPECT_THAT(result.err, HasSubstr("VR Juggler 2007"));
  EXPECT_THAT(result.err, HasSubstr(", found VES; the nearest is VESS"));
}

TEST_F(LinesAndUrls, AUnitSaysWhereItsLineCannotBe) {
  expect_refusal("emulate --link nodir7/x", 1,
                 "headpin emulate: --link nodir7/x: cannot be created: there is no folder nodir7");
  for (const std::string address : {"localhost", "", "nobody", "198.51.100.77"}) {
    expect_refusal("emulate --tcp " + address + ":5555", 2,
                   "--tcp " + address +
                       ":5555: expected an IPv4 address of this computer in numbers, such as "
                       "127.0.0.1:5555, found '" +
                       address + "'");
  }
  const LocalPort taken;
  const std::string port = std::to_string(taken.number());
  expect_refusal("emulate --tcp " + port, 75,
                 "--tcp " + port + ": this port cannot be opened: Address already in use");
  expect_refusal("emulate --faults 'noise=1, loud=2'", 2,
                 "headpin emulate: --faults: fault 'loud=2': expected one of noise, dropout, ");
}

}  // namespace
}  // namespace headpin
