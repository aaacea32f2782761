// What each Fastrak client sends, what it demands of the answers, and how it counts records.

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/clients.h"
#include "tests/devices/fastrak_line.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

FastrakEmulatorOptions unit_with(int receivers, int baud = 115200) {
  FastrakEmulatorOptions options;
  options.receivers = receivers;
  options.baud = baud;
  options.faults.noise = 0.0;
  return options;
}

const FastrakClient& the_client(std::string_view name) {
  return *std::ranges::find(fastrak_clients(), name, &FastrakClient::name);
}

std::vector<std::string> said_by(std::string_view name, int stations) {
  ChangedLine line(unit_with(stations));
  FastrakDemands demands;
  the_client(name).start(line, stations, demands);
  return line.said;
}

const std::string kDiscards{ChangedLine::kFlush};

// The transcripts of fastrak.md, sections 9.2 and 9.3.
TEST(FastrakClientBytesTest, VrpnSendsWhatItWasSeenToSend) {
  EXPECT_THAT(said_by("VRPN", 2),
              ElementsAre("c", "S", "O1,2,11,0\r", "O2,2,11,0\r", "O3,2,11,0\r", "O4,2,11,0\r",
                          "x0.2,0.2,0.8,0.8\r", "v0.2,0.2,0.8,0.8\r", kDiscards, "fC"));
  EXPECT_THAT(said_by("VRPN with a stylus", 2),
              ElementsAre("O1,2,11,16,0\r", "c", "S", "O1,2,11,16,0\r", "O2,2,11,0\r",
                          "O3,2,11,0\r", "O4,2,11,0\r", "e1,0\r", "x0.2,0.2,0.8,0.8\r",
                          "v0.2,0.2,0.8,0.8\r", kDiscards, "fC"));
}

TEST(FastrakClientBytesTest, VruiAndVrJugglerDiscardWhatCameBeforeTheyAsk) {
  EXPECT_THAT(said_by("Vrui", 2),
              ElementsAre("c", kDiscards, "S", "l1,1\r\n", "l2,1\r\n", "R1\r\n", "R2\r\n", "b1\r\n",
                          "b2\r\n", "H1,  1.0000,  0.0000,  0.0000\r\n",
                          "H2,  1.0000,  0.0000,  0.0000\r\n", "O1,2,4,16,1\r\n", "O2,2,4,16,1\r\n",
                          "e1,0\r\n", "F", "N1,\r\n", "d", "U", "f", "C"));
  EXPECT_THAT(said_by("VR Juggler 2007", 1),
              ElementsAre("c", kDiscards, "f", kDiscards, "S", kDiscards, "O1,2,11,1\r", kDiscards,
                          "l1\r", kDiscards));
}

TEST(FastrakClientBytesTest, OthersReadSettingsBack) {
  EXPECT_THAT(said_by("VESS", 1),
              ElementsAre("C", "\r", "c", kDiscards, "l1\r", "O1\r", "O1,2,4,1\r", "O2,2,4,1\r",
                          "O3,2,4,1\r", "O4,2,4,1\r", "f", "P", "C"));
  EXPECT_THAT(said_by("FreeVR", 1),
              ElementsAre("c", "F", "U", "S", "l*\n", "O1,2,4,16,1\n\r", "O1\r"));
  // The first return ends nothing, as it follows ^Y.
  EXPECT_THAT(said_by("BoardLab", 1),
              ElementsAre("c", "\x19", kDiscards, "\r", "\r", "l1\r", "H1\r", "O1\r", "H1,0,0,1\r",
                          "O1,0,2,0,0,11,1\r", "u\r", "C"));
  EXPECT_THAT(said_by("Georgia Tech's daemon", 1),
              ElementsAre("P\nO1,52,61,50\nO2,52,61,50\nO3,52,61,50\nO4,52,61,50\nu\nf\nC\n", "c",
                          kDiscards, "C\n"));
}

// It asks again until a line comes, here three times.
TEST(FastrakClientBytesTest, BoardLabSendsAReturnAgainWhileNothingComes) {
  ChangedLine line(unit_with(1));
  line.change = [](const std::string&, std::string& heard) { heard.clear(); };
  FastrakDemands demands;
  the_client("BoardLab").start(line, 1, demands);
  EXPECT_EQ(std::ranges::count(line.said, "\r"), 3);
}

/// What a client demands and does not get while it starts, if an answer is changed.
struct Changed {
  std::string_view client;
  std::string sent;  ///< begin of the command whose answer is changed
  std::function<void(std::string&)> change;
  std::string_view unmet;
};

TEST(FastrakClientDemandTest, AnAnswerThatIsWrongInOnePlaceIsNotTaken) {
  const auto letter = [](std::size_t place, char c) {
    return [=](std::string& heard) { heard.at(place) = c; };
  };
  const auto cut = [](std::string& heard) { heard.erase(20, 1); };
  const std::string_view status = "a status record of 55 bytes, from 2 to CR LF, in time";
  const std::string_view s = "S as the status record's letter";
  const std::vector<Changed> all = {
      {"VRPN", "S", letter(0, '3'), status},
      {"VRPN", "S", letter(54, '\r'), status},
      {"VRPN", "S", cut, status},
      {"Vrui", "S", letter(2, 's'), s},
      {"VR Juggler 2006", "S", letter(2, 's'), s},
      {"VR Juggler 2007", "S", letter(10, 'F'), "blanks in its columns 10 to 15"},
      {"VESS", "P", letter(0, '2'), "a whole set in answer to P"},
      {"Georgia Tech's daemon", "P\n", letter(2, 'k'),
       "records of the set-up before, when P comes before a new one"},
      {"Georgia Tech's daemon", "P\n", letter(45, ' '),
       "records of the set-up before, when P comes before a new one"},
      {"Nontrivial Solutions", "P", letter(1, '2'), "one record of the one station that is on"},
      {"FreeVR", "S", letter(1, '2'), "a status record of station 1, whole, 40 ms after S at most"},
  };
  for (const Changed& one : all) {
    ChangedLine line(unit_with(1));
    line.change = [&one](const std::string& sent, std::string& heard) {
      if (sent.starts_with(one.sent)) one.change(heard);
    };
    FastrakDemands demands;
    the_client(one.client).start(line, 1, demands);
    std::vector<std::string> unmet;
    for (const FastrakDemand& demand : demands) {
      if (!demand.met) unmet.push_back(demand.what);
    }
    EXPECT_THAT(unmet, ElementsAre(one.unmet)) << one.client;
  }
}

TEST(FastrakClientDemandTest, VrJugglerLosesAnAnswerThatComesAtOnce) {
  ChangedLine line(unit_with(1));
  line.answers_at_once = true;
  FastrakDemands demands;
  the_client("VR Juggler 2007").start(line, 1, demands);
  ASSERT_FALSE(demands.empty());
  EXPECT_EQ(demands.front().what, "a status record of 55 bytes that does not come at once");
  EXPECT_EQ(demands.front().found, "nothing");
}

/// Records of the factory's form, of these stations, the last one with this error letter.
std::string records_of(const std::vector<int>& stations, char error = ' ') {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const char letter = i + 1 == stations.size() ? error : ' ';
    encode_record({.station = stations[i], .error = letter}, {}, bytes);
  }
  return {bytes.begin(), bytes.end()};
}

TEST(FastrakClientDemandTest, RecordsComeInTurnWithoutAnErrorLetter) {
  const auto found = [](int stations, const std::string& stream, std::size_t records) {
    FastrakDemands demands;
    EXPECT_EQ(take_apart(the_client("ROS 2 node"), stations, stream, demands).size(), records);
    EXPECT_EQ(demands.size(), 1u);
    EXPECT_EQ(demands.back().met, demands.back().found.empty());
    return demands.back().found;
  };
  EXPECT_EQ(found(2, records_of({1, 2, 1}), 3), "");
  EXPECT_EQ(found(2, records_of({1, 2, 1}).substr(0, 100), 2), "");  // it ends within a record
  EXPECT_THAT(found(2, records_of({1, 1}), 1),
              testing::StartsWith("record 1, of station 2: 47 bytes '01 "));
  EXPECT_THAT(found(2, records_of({1, 2}, 'k'), 1),
              testing::StartsWith("record 1, of station 2: 47 bytes '02k"));
  EXPECT_THAT(found(1, "x" + records_of({1}), 0),
              testing::StartsWith("record 0, of station 1: 47 bytes 'x01 "));
  EXPECT_EQ(found(1, "", 0), "nothing");
  EXPECT_EQ(found(1, "01 ", 0), "3 bytes '01 '");
}

TEST(FastrakClientDemandTest, ASetThatIsNotWholeEndsThePolling) {
  ChangedLine line(unit_with(1));
  line.change = [](const std::string& sent, std::string& heard) {
    if (sent == "P") heard.pop_back();
  };
  FastrakDemands demands;
  EXPECT_TRUE(run_client(the_client("pylhemus"), line, 1, 1s, demands).empty());
  EXPECT_FALSE(demands.back().met);
  EXPECT_EQ(demands.back().what, "a set of 47 bytes");
  EXPECT_THAT(demands.back().found, testing::StartsWith("46 bytes '01 "));
  EXPECT_EQ(std::ranges::count(line.said, "P"), 1);
}

// Cycles of 8.33 ms: at 9600 baud 47 bytes take 49 ms, so that each of four stations sends in every
// ninth cycle; at 57600 baud BoardLab's 57 bytes take 9.9 ms and the factory's 47 bytes 8.2 ms.
TEST(FastrakClientDemandTest, TheRateIsThatOfTheCyclesThatTheLineLeaves) {
  const auto rate = [](std::string_view name, int stations, int baud) {
    ChangedLine line(unit_with(stations, baud));
    FastrakDemands demands;
    run_client(the_client(name), line, stations, 500ms, demands);
    EXPECT_TRUE(demands.back().met) << demands.back().found;
    return demands.back().what;
  };
  EXPECT_EQ(rate("ROS 2 node", 1, 115200), "about 120 records a second");
  EXPECT_EQ(rate("ROS 2 node", 3, 115200), "about 120 records a second");
  EXPECT_EQ(rate("ROS 2 node", 4, 9600), "about 13 records a second");
  EXPECT_EQ(rate("ROS 2 node", 1, 57600), "about 120 records a second");
  EXPECT_EQ(rate("BoardLab", 1, 57600), "about 60 records a second");
}

TEST(FastrakClientDemandTest, FiveRecordsOfSixAreTooFew) {
  ChangedLine line(unit_with(1));
  line.change = [](const std::string&, std::string& heard) {
    for (std::size_t at = 0; at + 47 <= heard.size(); at += 5 * std::size_t{47}) {
      heard.erase(at, 47);
    }
  };
  FastrakDemands demands;
  run_client(the_client("ROS 2 node"), line, 1, 2s, demands);
  EXPECT_FALSE(demands.back().met);
  EXPECT_THAT(demands.back().found, testing::EndsWith(" a second"));
}

// In inches or centimetres, each as the client takes them; to half of a hundredth of an inch.
TEST(FastrakClientDemandTest, AReceiverAtRestIsWhereTheClientReadsIt) {
  const Vec3 p_TS(0.4, -0.1, 0.1);
  const auto motion = [&](int, Time) { return FastrakTruth{{Quat::Identity(), p_TS}}; };
  for (const FastrakClient& client : fastrak_clients()) {
    ChangedLine line(unit_with(client.least_stations), motion);
    FastrakDemands demands;
    const auto records = run_client(client, line, client.least_stations, 200ms, demands);
    EXPECT_FALSE(records.empty()) << client.name;
    for (const FastrakRecord& record : records) {
      const FastrakFormat& format = record.station == 1 ? client.first : client.others;
      const Vec3 p = record.position * format.metre_per_unit();
      EXPECT_LT((p - p_TS).cwiseAbs().maxCoeff(), 0.000128) << client.name;
    }
  }
}

}  // namespace
}  // namespace headpin::devices
