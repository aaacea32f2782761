#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <poll.h>

#include "apps/command.h"
#include "apps/failed_with.h"
#include "apps/options.h"
#include "apps/streams.h"
#include "devices/fastrak/clients.h"
#include "devices/fastrak/readings.h"
#include "devices/lines/lasting_line.h"

namespace headpin::apps {
namespace {

struct ConformanceOptions {
  std::string line, client;
  int baud = 115200;
  double seconds = 2.0;
  bool json = false;
};

/// @throws UsageError  for a name that no line can have
std::unique_ptr<devices::ByteStream> stream_at(const std::string& name, int baud) {
  try {
    return devices::open_line(name, baud);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

/// A client's end of a real line.
class PortLine : public devices::FastrakLine {
 public:
  PortLine(const std::string& name, int baud) : stream_(stream_at(name, baud)), baud_(baud) {}

  void put(std::string_view text) override {
    devices::Bytes rest(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    const std::chrono::steady_clock::time_point end =
        std::chrono::steady_clock::now() + std::chrono::seconds(2);
    while (!rest.empty() && std::chrono::steady_clock::now() < end) {
      rest = rest.subspan(stream_->write(rest));
      if (!rest.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (!rest.empty()) throw std::runtime_error("cannot write to the line: " + stream_->trouble());
  }

  std::string wait(Time span, std::size_t enough) override {
    const std::chrono::steady_clock::time_point end = std::chrono::steady_clock::now() + span;
    while (heard_.size() < enough && std::chrono::steady_clock::now() < end) {
      pollfd state{stream_->descriptor(), POLLIN, 0};
      ::poll(&state, 1, 1);
      listen();
    }
    const std::string rest = heard_.size() > enough ? heard_.substr(enough) : "";
    return std::exchange(heard_, rest).substr(0, enough);
  }

  void flush() override {
    listen();
    heard_.clear();
  }

  int baud() const override { return baud_; }

 private:
  void listen() {
    std::array<std::uint8_t, 1024> bytes{};
    while (const std::size_t n = stream_->read(bytes)) {
      heard_.append(reinterpret_cast<const char*>(bytes.data()), n);
    }
  }

  std::unique_ptr<devices::ByteStream> stream_;
  int baud_;
  std::string heard_;
};

/// Resets the unit after the last client: resumed, stopped, in factory settings.
void reset(PortLine& line) {
  using namespace std::chrono_literals;
  line.ask("\x11\rc", 300ms);
  line.ask("W", 200ms);
  line.flush();
}

struct Row {
  std::string client;
  std::string skipped;  ///< why it could not be tried; empty: it was
  std::vector<devices::FastrakDemand> demands;
  int tries = 0;

  const devices::FastrakDemand* unmet() const {
    const auto found = std::ranges::find(demands, false, &devices::FastrakDemand::met);
    return found == demands.end() ? nullptr : &*found;
  }
  /// Whether it shows less than it should, because receivers moved.
  bool told_too_little() const {
    return std::ranges::any_of(demands, &devices::FastrakDemand::receivers_move);
  }
};

nlohmann::ordered_json as_json(const Row& row) {
  nlohmann::ordered_json json = {{"client", row.client},
                                 {"skipped", !row.skipped.empty()},
                                 {"why", nullptr},
                                 {"demands", row.demands.size()},
                                 {"tries", row.tries}};
  if (!row.skipped.empty()) json["why"] = row.skipped;
  json["unmet"] = nlohmann::json::array();
  for (const devices::FastrakDemand& demand : row.demands) {
    if (demand.met) continue;
    json["unmet"].push_back(
        {{"sent", demand.sent}, {"what", demand.what}, {"found", demand.found}});
  }
  return json;
}

void print_row(const Row& row) {
  const devices::FastrakDemand* unmet = row.unmet();
  if (!row.skipped.empty()) {
    fmt::print("{:<24}skipped: {}\n", row.client, row.skipped);
  } else if (unmet) {
    fmt::print("{:<24}FAILS: sent {}, expected {}, found {}\n", row.client, unmet->sent,
               unmet->what, unmet->found);
  } else {
    fmt::print("{:<24}passes, {} demands{}\n", row.client, row.demands.size(),
               row.tries > 1 ? ", at the second try" : "");
  }
  std::fflush(stdout);
}

/// Repeats an attempt once that failed, because a machine or a line may have been delayed, or that
/// told too little.
template <typename Try>
void examine(Row& row, PortLine& line, Try attempt) {
  const auto again = [&row] { return row.unmet() || row.told_too_little(); };
  for (row.tries = 0; row.tries == 0 || (row.tries < 2 && again()); ++row.tries) {
    reset(line);
    row.demands.clear();
    attempt(row.demands);
  }
}

constexpr const char* kReadings = "readings";

/// One row for the unit's readings, then one for each wanted client.
///
/// @param stations  receivers that the unit has
std::vector<Row> examine_all(PortLine& line, const ConformanceOptions& options, int& stations,
                             const std::function<void(const Row&)>& see) {
  std::vector<Row> rows(1);
  rows[0].client = kReadings;
  examine(rows[0], line,
          [&](auto& demands) { stations = devices::examine_readings(line, demands); });
  if (rows[0].told_too_little() && !rows[0].unmet()) {
    rows[0].skipped = "the receivers move: hold them still for the readings";
  }
  const bool answers = std::ranges::any_of(
      rows[0].demands, [](const auto& demand) { return demand.met || demand.found != "nothing"; });
  if (!answers) {
    throw std::runtime_error(fmt::format(
        "{}: no Fastrak answers at {} baud: {}", options.line, options.baud,
        "sent 'S' and 'l1', expected a status record of 55 bytes and 9 bytes, found nothing"));
  }
  stations = std::max(stations, 1);
  see(rows[0]);
  for (const devices::FastrakClient& client : devices::fastrak_clients()) {
    if (!options.client.empty() && options.client != client.name) continue;
    Row row{std::string(client.name), "", {}};
    if (stations < client.least_stations) {
      row.skipped = fmt::format("needs more than {} receivers", stations);
    } else {
      examine(row, line, [&](auto& demands) {
        devices::run_client(client, line, stations, microseconds(options.seconds), demands);
      });
    }
    see(row);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<std::string> client_names() {
  std::vector<std::string> names;
  for (const devices::FastrakClient& client : devices::fastrak_clients()) {
    names.emplace_back(client.name);
  }
  return names;
}

/// Checked here and not by the option itself, whose help would list all clients twice.
void require_known_client(std::string name) {
  const std::string wrong = name.empty() ? "" : one_of(client_names())(name);
  if (!wrong.empty()) throw UsageError("--client: " + wrong);
}

void examine_unit(const ConformanceOptions& options) {
  require_known_client(options.client);
  PortLine line(options.line, options.baud);
  int stations = 0;
  const std::vector<Row> rows = examine_all(line, options, stations, [&](const Row& row) {
    if (!options.json) print_row(row);
  });
  reset(line);
  nlohmann::ordered_json table = nlohmann::json::array();
  for (const Row& row : rows) table.push_back(as_json(row));
  const nlohmann::ordered_json results = {{"stations", stations}, {"clients", table}};
  if (std::ranges::any_of(rows, [](const Row& row) { return row.unmet() != nullptr; })) {
    throw FailedWith(options.line + ": at least one client does not work with this unit", results);
  }
  // No client compares one form with another, so that none stands for the readings.
  if (!rows[0].skipped.empty()) {
    throw FailedWith(
        options.line + ": too little is known of the readings: hold the receivers still", results);
  }
  if (options.json) print_json(results);
}

}  // namespace

void add_conformance(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "conformance", "Test whether a Fastrak, real or emulated, works with known clients");
  const auto options = std::make_shared<ConformanceOptions>();
  command->add_option("LINE", options->line, "serial port or tcp:HOST:PORT of the unit")
      ->required();
  command->add_option("--baud", options->baud, "baud rate of the port")
      ->check(one_of({"2400", "4800", "9600", "19200", "38400", "57600", "115200"}))
      ->capture_default_str();
  command->add_option("--client", options->client, "test only this client");
  command->add_option("--seconds", options->seconds, "seconds of records to read for each client")
      ->check(number_from(0.5, 3600.0))
      ->capture_default_str();
  add_json(*command, options->json);
  command->footer(
      fmt::format("Clients: {}", fmt::join(client_names(), ", ")) +
      ".\nFirst, the command reads the pose in inches and centimetres, in ASCII and "
      "binary, as angles,\nquaternion and direction cosines; all must agree. Hold the "
      "receivers still for that, above all on a\nslow line. A check that fails, or tells "
      "too little because they move, is repeated once. All checks\ntake about two "
      "minutes. The unit is left running in its factory settings; nothing is saved in "
      "it.\n\nExample:\n  "
      "headpin conformance /dev/ttyUSB0");
  command->callback([options] { examine_unit(*options); });
}

}  // namespace headpin::apps
