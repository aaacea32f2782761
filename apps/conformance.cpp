#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>

#include "apps/command.h"
#include "apps/options.h"
#include "devices/fastrak_clients.h"
#include "devices/fastrak_replies.h"
#include "devices/lasting_line.h"

namespace headpin::apps {
namespace {

struct ConformanceOptions {
  std::string line, client;
  int baud = 115200;
  double seconds = 2.0;
  bool json = false;
};

/// A client's end of a real line.
class PortLine : public devices::FastrakLine {
 public:
  PortLine(const std::string& name, int baud)
      : stream_(devices::open_line(name, baud)), baud_(baud) {}

  void send(std::string_view text) override {
    devices::Bytes rest(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    const std::chrono::steady_clock::time_point end =
        std::chrono::steady_clock::now() + std::chrono::seconds(2);
    while (!rest.empty() && std::chrono::steady_clock::now() < end) {
      rest = rest.subspan(stream_->write(rest));
      if (!rest.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (!rest.empty()) throw std::runtime_error("the line takes nothing: " + stream_->trouble());
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

/// Whatever the last client left: resumed, stopped, in the factory's set-up.
void reset(PortLine& line) {
  using namespace std::chrono_literals;
  line.ask("\x11\rc", 300ms);
  line.ask("W", 200ms);
  line.flush();
}

/// @throws std::runtime_error  when nobody answers as a Fastrak does
int count_receivers(PortLine& line, const ConformanceOptions& options) {
  using namespace std::chrono_literals;
  const std::string status = line.ask("S", 1s, devices::kFastrakStatusLength);
  const std::string on = line.ask("l1\r", 1s, 9);
  const auto active = devices::decode_active(on);
  if (!devices::decode_status(status) || !active) {
    throw std::runtime_error(fmt::format(
        "{}: no Fastrak answers at {} baud: expected a status record of 55 bytes, got {}",
        options.line, options.baud, status.size()));
  }
  // Clients count from station 1 on.
  return static_cast<int>(std::ranges::find(*active, false) - active->begin());
}

struct Row {
  std::string client;
  bool skipped = false;
  std::vector<devices::FastrakDemand> demands;

  const devices::FastrakDemand* unmet() const {
    const auto found = std::ranges::find(demands, false, &devices::FastrakDemand::met);
    return found == demands.end() ? nullptr : &*found;
  }
};

nlohmann::ordered_json as_json(const Row& row) {
  nlohmann::ordered_json json = {
      {"client", row.client}, {"skipped", row.skipped}, {"demands", row.demands.size()}};
  json["unmet"] = nlohmann::json::array();
  for (const devices::FastrakDemand& demand : row.demands) {
    if (!demand.met) json["unmet"].push_back({{"what", demand.what}, {"found", demand.found}});
  }
  return json;
}

void print_row(const Row& row, int stations) {
  const devices::FastrakDemand* unmet = row.unmet();
  if (row.skipped) {
    fmt::print("{:<24}skipped: needs more than {} receivers\n", row.client, stations);
  } else if (unmet) {
    fmt::print("{:<24}FAILS: expected {}; found {}\n", row.client, unmet->what, unmet->found);
  } else {
    fmt::print("{:<24}passes, {} demands\n", row.client, row.demands.size());
  }
  std::fflush(stdout);
}

void examine_unit(const ConformanceOptions& options) {
  PortLine line(options.line, options.baud);
  reset(line);
  const int stations = count_receivers(line, options);
  if (stations == 0) throw std::runtime_error(options.line + ": no receiver at station 1");
  nlohmann::ordered_json table = nlohmann::json::array();
  bool all_met = true, any = false;
  for (const devices::FastrakClient& client : devices::fastrak_clients()) {
    if (!options.client.empty() && options.client != client.name) continue;
    any = true;
    Row row{std::string(client.name), stations < client.least_stations, {}};
    if (!row.skipped) {
      reset(line);
      devices::run_client(client, line, stations, microseconds(options.seconds), row.demands);
    }
    all_met = all_met && !row.unmet();
    if (options.json) {
      table.push_back(as_json(row));
    } else {
      print_row(row, stations);
    }
  }
  reset(line);
  if (!any) throw UsageError("--client '" + options.client + "': no such client; see --help");
  if (options.json) {
    fmt::print("{}\n", nlohmann::json{{"stations", stations}, {"clients", table}}.dump());
  }
  if (!all_met) throw std::runtime_error(options.line + ": not what every client needs");
}

std::string client_names() {
  std::string names;
  for (const devices::FastrakClient& client : devices::fastrak_clients()) {
    names += (names.empty() ? "" : ", ") + std::string(client.name);
  }
  return names;
}

}  // namespace

void add_conformance(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "conformance", "Try a Fastrak, real or emulated, with what known clients send and need");
  const auto options = std::make_shared<ConformanceOptions>();
  command->add_option("LINE", options->line, "serial port, or tcp:HOST:PORT")->required();
  command->add_option("--baud", options->baud, "of the port")
      ->check(CLI::IsMember({2400, 4800, 9600, 19200, 38400, 57600, 115200}))
      ->capture_default_str();
  command->add_option("--client", options->client, "only this one");
  command->add_option("--seconds", options->seconds, "of records for each")
      ->check(number_from(0.5, 3600.0))
      ->capture_default_str();
  add_json(*command, options->json);
  command->footer("Clients: " + client_names() +
                  ".\nTakes some two minutes and leaves the unit running in its factory's set-up, "
                  "nothing saved.\n\nExample:\n  headpin conformance /dev/ttyUSB0");
  command->callback([options] { examine_unit(*options); });
}

}  // namespace headpin::apps
