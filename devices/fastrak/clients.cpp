#include "devices/fastrak/clients.h"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "devices/fastrak/replies.h"
#include "devices/fastrak/setup.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;
using Demands = FastrakDemands;

/// Sends a text that must have this answer.
void expect(FastrakLine& line, Demands& demands, std::string_view text, Time span,
            std::string_view answer) {
  const std::string heard = line.ask(text, span, answer.size());
  demand(line, demands, fmt::format("the answer {}", shown_bytes(answer)), heard == answer, heard);
}

/// The read-back of l with this number of stations on.
std::string stations_on(int stations) {
  std::array<bool, kFastrakStations> on{};
  std::fill_n(on.begin(), stations, true);
  return encode_active(1, on);
}

/// Requires a whole status record, as most clients do: 55 bytes from `2` to LF.
std::string status(FastrakLine& line, Demands& demands, Time span) {
  const std::string heard = line.ask("S", span, kFastrakStatusLength);
  demand(line, demands, "a status record of 55 bytes, from 2 to CR LF, in time",
         heard.size() == kFastrakStatusLength && heard.front() == '2' && heard.ends_with("\r\n"),
         heard);
  return heard;
}

/// From VRPN's transcript: output lists of all four stations, filters, then binary and continuous
/// output at once.
void vrpn_with(FastrakLine& line, Demands& demands, std::string_view list1) {
  tell(line, demands, "c", 4s);
  status(line, demands, 1s);
  tell(line, demands, fmt::format("O1,{}\r", list1), 50ms);
  for (const char* command : {"O2,2,11,0\r", "O3,2,11,0\r", "O4,2,11,0\r"}) {
    tell(line, demands, command, 50ms);
  }
  if (list1.find("16") != std::string_view::npos) tell(line, demands, "e1,0\r", 50ms);
  tell(line, demands, "x0.2,0.2,0.8,0.8\r", 1s);
  tell(line, demands, "v0.2,0.2,0.8,0.8\r", 1s);
  line.flush();
  line.send("fC");
}

void vrpn(FastrakLine& line, int, Demands& demands) {
  vrpn_with(line, demands, "2,11,0");
}

void vrpn_with_stylus(FastrakLine& line, int, Demands& demands) {
  line.ask("O1,2,11,16,0\r", 50ms);  // sent at construction, in any state of the unit
  vrpn_with(line, demands, "2,11,16,0");
}

void vrui(FastrakLine& line, int stations, Demands& demands) {
  line.ask("c", 100ms);
  line.flush();
  const std::string heard = status(line, demands, 10s);
  demand(line, demands, "S as the status record's letter", heard.size() > 2 && heard[2] == 'S',
         heard);
  for (const char* command :
       {"l#,1\r\n", "R#\r\n", "b#\r\n", "H#,  1.0000,  0.0000,  0.0000\r\n", "O#,2,4,16,1\r\n"}) {
    tell_each(line, demands, stations, command, 100ms);
  }
  tell(line, demands, "e1,0\r\n", 100ms);
  tell(line, demands, "F", 100ms);
  const std::string tip = line.ask("N1,\r\n", 5s, 29);
  demand(line, demands, "a line in answer to N1 and a dangling comma", tip.ends_with("\r\n"), tip);
  for (const char* command : {"d", "U", "f"}) tell(line, demands, command, 100ms);
  line.send("C");
}

/// It flushes its input directly after sending: an answer that comes at once is lost.
void vr_juggler_2007(FastrakLine& line, int stations, Demands& demands) {
  const auto ask = [&](std::string_view text, std::size_t enough) {
    line.send(text);
    line.flush();
    return line.wait(2s, enough);
  };
  ask("c", std::string::npos);
  ask("f", std::string::npos);
  const std::string status = ask("S", kFastrakStatusLength);
  demand(line, demands, "a status record of 55 bytes that does not come at once",
         status.size() == 55, status);
  demand(line, demands, "blanks in its columns 10 to 15",
         status.size() == 55 && status.substr(9, 6) == "      ", status);
  for (int station = 1; station <= stations; ++station) {
    ask(fmt::format("O{},2,11,1\r", station), 1);
  }
  const std::string on = ask("l1\r", 9);
  demand(line, demands, "read-backs in ASCII while records are binary", on == stations_on(stations),
         on);
}

void vr_juggler_2006(FastrakLine& line, int stations, Demands& demands) {
  tell(line, demands, "c", 100ms);
  const std::string heard = status(line, demands, 500ms);
  demand(line, demands, "S as the status record's letter", heard.size() > 2 && heard[2] == 'S',
         heard);
  tell(line, demands, "uf", 100ms);
  tell(line, demands, "e1,0\r", 100ms);
  tell_each(line, demands, stations, "l#,1\r", 100ms);
  tell(line, demands, "O1,2,4,16\r", 100ms);
  for (int s = 2; s <= stations; ++s) tell(line, demands, fmt::format("O{},2,4\r", s), 100ms);
}

void vess(FastrakLine& line, int stations, Demands& demands) {
  line.ask("C", 500ms);
  line.ask("\r", 100ms);
  line.ask("c", 1s);
  line.flush();
  expect(line, demands, "l1\r", 1s, stations_on(stations));
  expect(line, demands, "O1\r", 1s, "21O 2 4 1\r\n");
  tell_each(line, demands, kFastrakStations, "O#,2,4,1\r", 50ms);
  tell(line, demands, "f", 50ms);
  const auto set = static_cast<std::size_t>(29 * stations);
  const std::string records = line.ask("P", 1s, set);
  demand(line, demands, "a whole set in answer to P", records.size() == set && records[0] == '0',
         records);
  line.send("C");
}

/// It blocks on each byte that it did not request.
void covise(FastrakLine& line, int stations, Demands& demands) {
  for (const char* command : {"\n", "c", "u", "F"}) tell(line, demands, command, 100ms);
  for (const char* command :
       {"l#,1\r\n", "R#\r\n", "O#,2,11,16,1\r\n", "H#,  1.000000,  0.000000,  0.000000\r\n"}) {
    tell_each(line, demands, stations, command, 10ms);
  }
  tell(line, demands, "e1,0\r\n", 100ms);
}

void cybergarage(FastrakLine& line, int, Demands& demands) {
  const std::string on = line.ask("l1\r", 1s, 9);
  demand(line, demands, "9 bytes in answer to l1", on.size() == 9, on);
  tell_each(line, demands, kFastrakStations, "O#,2,0,4,1\r", 10ms);
  tell(line, demands, "F", 10ms);
  tell(line, demands, "c", 10ms);
}

/// It sends everything within microseconds, with LF at the end.
void georgia_tech(FastrakLine& line, int stations, Demands& demands) {
  const auto first = static_cast<std::size_t>(47 * stations);  // with the present output list
  const std::string heard =
      line.ask("P\nO1,52,61,50\nO2,52,61,50\nO3,52,61,50\nO4,52,61,50\nu\nf\nC\n", 1s, first);
  demand(line, demands, "records of the set-up before, when P comes before a new one",
         heard.size() >= first && heard.starts_with("01 ") && heard.substr(45, 2) == "\r\n",
         heard.substr(0, first));
  // It continues to read the running stream; this does the same, from the next record on.
  line.ask("c", 200ms);
  line.flush();
  line.send("C\n");
}

/// It sends through a terminal that converts line ends to CR LF.
void ros(FastrakLine& line, int, Demands& demands) {
  tell(line, demands, "c", 200ms);
  tell_each(line, demands, kFastrakStations, "O#,52,61,50\r\n", 50ms);
  tell(line, demands, "u\r\n", 50ms);
  tell(line, demands, "f\r\n", 50ms);
  line.send("C\r\n");
}

void nontrivial_solutions(FastrakLine& line, int stations, Demands& demands) {
  tell(line, demands, "c", 100ms);
  tell_each(line, demands, kFastrakStations, "l#,0\n", 100ms);
  tell(line, demands, fmt::format("l{},1\n", stations), 100ms);
  tell(line, demands, "f", 100ms);
  tell(line, demands, fmt::format("O{},2,4,1\n", stations), 100ms);
  const std::string record = line.ask("P", 1s, 29);
  demand(line, demands, "one record of the one station that is on",
         record.size() == 29 && record.starts_with(fmt::format("0{} ", stations)), record);
  line.send("C");
}

void pylhemus(FastrakLine& line, int, Demands& demands) {
  tell(line, demands, "W", 100ms);
  tell(line, demands, "u", 100ms);
}

void lina(FastrakLine& line, int, Demands& demands) {
  tell(line, demands, "O1,2,4,1\nO2,2,4,1\nO3,2,4,1\nO4,2,4,1\n", 1s);
}

void board_lab(FastrakLine& line, int stations, Demands& demands) {
  line.ask("c", 500ms);
  line.ask(std::string{kFastrakReinitialise}, 15s);
  line.flush();
  std::string answer;
  for (int i = 0; i < 3 && answer.empty(); ++i) answer = line.ask("\r", 1s);
  demand(line, demands, "a line in answer to CR alone, 15 s after ^Y", answer.ends_with("\r\n"),
         answer);
  expect(line, demands, "l1\r", 500ms, stations_on(stations));
  expect(line, demands, "H1\r", 500ms, "21H   1.00   0.00   0.00\r\n");
  expect(line, demands, "O1\r", 500ms, "21O 2 4 1\r\n");
  tell(line, demands, "H1,0,0,1\r", 500ms);
  tell(line, demands, "O1,0,2,0,0,11,1\r", 500ms);
  line.ask("u\r", 500ms);
  line.send("C");
}

/// It waits 40 ms for each answer; the bytes' own time on a slow line is given to it besides.
void free_vr(FastrakLine& line, int stations, Demands& demands) {
  const auto within = [&](std::size_t bytes) { return 40ms + time_of(bytes, line); };
  for (const char* command : {"c", "F", "U"}) tell(line, demands, command, 40ms);
  const std::string status = line.ask("S", within(kFastrakStatusLength), kFastrakStatusLength);
  demand(line, demands, "a status record of station 1, whole, 40 ms after S at most",
         status.size() == kFastrakStatusLength && status.starts_with("21S"), status);
  const std::string on = stations_on(stations);
  expect(line, demands, "l*\n", within(on.size()), on);
  tell(line, demands, "O1,2,4,16,1\n\r", 40ms);
  const std::string_view list = "21O 2 416 1\r\n";
  expect(line, demands, "O1\r", within(list.size()), list);
}

void ros2(FastrakLine& line, int, Demands&) {
  line.send("C");  // by another program
}

const FastrakFormat kVrpn = {{2, 11, 0}, true, false};
const FastrakFormat kVrpnStylus = {{2, 11, 16, 0}, true, false};
const FastrakFormat kVrui = {{2, 4, 16, 1}, true, false};
const FastrakFormat kJuggler2007 = {{2, 11, 1}, true, false};
const FastrakFormat kJuggler2006First = {{2, 4, 16}, true, true};
const FastrakFormat kJuggler2006 = {{2, 4}, true, true};
const FastrakFormat kShortBinary = {{2, 4, 1}, true, false};
const FastrakFormat kCovise = {{2, 11, 16, 1}, false, true};
const FastrakFormat kCybergarage = {{2, 0, 4, 1}, false, false};
const FastrakFormat kGeorgiaTech = {{52, 61, 50}, true, true};
const FastrakFormat kFactory = {{2, 4, 1}, false, false};
const FastrakFormat kFactoryCm = {{2, 4, 1}, false, true};
const FastrakFormat kBoardLab = {{0, 2, 0, 0, 11, 1}, false, true};
const FastrakFormat kFreeVr = {{2, 4, 16, 1}, false, false};

const std::array<FastrakClient, 16> kClients = {{
    {"VRPN", 1, vrpn, "", kVrpn, kVrpn},
    {"VRPN with a stylus", 1, vrpn_with_stylus, "", kVrpnStylus, kVrpn},
    {"Vrui", 1, vrui, "", kVrui, kVrui},
    {"VR Juggler 2007", 1, vr_juggler_2007, "P", kJuggler2007, kJuggler2007},
    {"VR Juggler 2006", 1, vr_juggler_2006, "P", kJuggler2006First, kJuggler2006},
    {"VESS", 1, vess, "", kShortBinary, kShortBinary},
    {"COVISE", 1, covise, "P", kCovise, kCovise},
    {"cybergarage", 1, cybergarage, "P", kCybergarage, kCybergarage},
    {"Georgia Tech's daemon", 1, georgia_tech, "", kGeorgiaTech, kGeorgiaTech},
    {"ROS node", 1, ros, "", kGeorgiaTech, kGeorgiaTech},
    {"Nontrivial Solutions", 1, nontrivial_solutions, "", kShortBinary, kShortBinary, true},
    {"pylhemus", 1, pylhemus, "P", kFactoryCm, kFactoryCm},
    {"LINA", 4, lina, "P\n", kFactory, kFactory},
    {"BoardLab", 1, board_lab, "", kBoardLab, kFactoryCm},
    {"FreeVR", 1, free_vr, "P", kFreeVr, kFactory},
    {"ROS 2 node", 1, ros2, "", kFactory, kFactory},
}};

/// The records that a unit sends in a second: one for each cycle, as far as the line is fast enough.
/// A unit drops whole records, and waits until the station that it missed is measured again.
double fastrak_rate(const FastrakClient& client, int stations, const FastrakLine& line) {
  const int turns = client.only_last ? 1 : stations;
  std::int64_t cycles = 0;  // for one record of each station
  for (int turn = 1; turn <= turns; ++turn) {
    const FastrakFormat& format = turn == 1 ? client.first : client.others;
    const Time sent = time_of(fastrak_record_length(format), line);
    std::int64_t until_next = 1;
    while (tick_time(until_next, kFastrakCycleRate) < sent) ++until_next;
    while ((until_next - 1) % turns != 0) ++until_next;
    cycles += until_next;
  }
  return static_cast<double>(kFastrakCycleRate * turns) / static_cast<double>(cycles);
}

/// Records, in a set for each time that the client asks; none after a set that is not whole.
std::vector<FastrakRecord> polled_sets(const FastrakClient& client, FastrakLine& line, int stations,
                                       Time span, Demands& demands) {
  const auto others = static_cast<std::size_t>(stations - 1);
  const std::size_t set =
      fastrak_record_length(client.first) + others * fastrak_record_length(client.others);
  const Time each = tick_time(1, kFastrakCycleRate) + time_of(set, line) + 35ms;
  std::string stream;
  for (Time waited{}; waited < span; waited += each) {
    const std::string records = line.ask(client.poll, each);
    if (records.size() != set) {
      demand(line, demands, fmt::format("a set of {} bytes", set), false, records);
      return {};
    }
    stream += records;
  }
  return take_apart(client, stations, stream, demands);
}

}  // namespace

std::span<const FastrakClient> fastrak_clients() {
  return kClients;
}

std::vector<FastrakRecord> take_apart(const FastrakClient& client, int stations,
                                      std::string_view stream, Demands& demands) {
  std::vector<FastrakRecord> records;
  std::size_t at = 0;
  std::string wrong;
  int turn = client.only_last ? stations : 1;
  while (true) {
    const FastrakFormat& format = turn == 1 ? client.first : client.others;
    const std::size_t length = fastrak_record_length(format);
    if (at + length > stream.size()) break;
    const std::string_view bytes = stream.substr(at, length);
    const auto record = decode_record(
        Bytes(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), format);
    if (!record || record->station != turn || record->error != ' ') {
      wrong = fmt::format("record {}, of station {}: {}", records.size(), turn, shown_bytes(bytes));
      break;
    }
    records.push_back(*record);
    at += length;
    if (!client.only_last) turn = turn % stations + 1;
  }
  demands.push_back({"what starts its records",
                     "records of their lengths, the stations in turn, without an error letter",
                     wrong.empty() && !records.empty(),
                     !wrong.empty()    ? wrong
                     : records.empty() ? shown_bytes(stream)
                                       : ""});
  return records;
}

std::vector<FastrakRecord> run_client(const FastrakClient& client, FastrakLine& line, int stations,
                                      Time span, Demands& demands) {
  client.start(line, stations, demands);
  if (!client.poll.empty()) return polled_sets(client, line, stations, span, demands);
  std::vector<FastrakRecord> records = take_apart(client, stations, line.wait(span), demands);
  if (records.empty()) return records;
  const double rate = fastrak_rate(client, stations, line);
  const double found = static_cast<double>(records.size()) / seconds(span);
  demands.push_back({"what starts its records", fmt::format("about {:.0f} records a second", rate),
                     found >= 0.98 * rate - 13.0 / seconds(span),
                     fmt::format("{:.0f} a second", found)});
  return records;
}

}  // namespace headpin::devices
