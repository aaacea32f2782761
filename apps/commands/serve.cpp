#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/condition.h"
#include "apps/options.h"
#include "apps/page_file.h"
#include "apps/serve/certificate.h"
#include "apps/serve/networks.h"
#include "apps/serve/places.h"
#include "apps/serve/play_server.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/study_folder.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

struct ServeOptions {
  std::string what = "paper-room";
  std::optional<std::string> output, page, watch_page, certificate, key;
  std::string bind = "127.0.0.1";
  int port = 8080, links = 1;
  Condition condition;
  bool json = false;
};

/// The places of the guests, and what the pages need to know.
struct Offered {
  std::unique_ptr<Study> study;  ///< null for a scenario
  std::function<Place()> next;
  ServedPages pages;
};

Offered offered(const ServeOptions& options) {
  Offered out;
  out.pages.play = options.page ? page_template(*options.page) : play_template();
  out.pages.watch = options.watch_page ? page_template(*options.watch_page) : watch_template();
  if (fs::is_directory(options.what)) {
    if (options.output) {
      throw UsageError("--output: the logs of a study are in its folder; expected no --output");
    }
    if (options.condition != Condition{}) {
      throw UsageError(
          "the plan of a study says its conditions; expected no --set, --friction or the like");
    }
    out.study = std::make_unique<Study>(open_study(options.what));
    out.next = places_of(*out.study);
    out.pages.questions = questions_in_json(out.study->questions);
    out.pages.watched = scene::load_scenario(out.study->at.scenario().string());
    return out;
  }
  if (!options.output) throw UsageError("expected --output FOLDER, for the logs of the games");
  scene::Scenario scenario = scene::load_scenario(options.what);
  apply_condition(options.condition, scenario);
  out.pages.watched = scenario;
  out.next = places_of(scenario, *options.output);
  return out;
}

std::string in_url(const std::string& address) {
  return address.find(':') == address.npos ? address : "[" + address + "]";
}

std::optional<Certificate> certificate_for(const ServeOptions& options) {
  if (options.certificate.has_value() != options.key.has_value()) {
    throw UsageError("--certificate and --key: expected both or none");
  }
  if (options.certificate) return read_certificate(*options.certificate, *options.key);
  if (is_loopback(options.bind)) return std::nullopt;
  return self_signed(reachable(options.bind));
}

void print_start(const ServeOptions& options, const std::string& origin,
                 const std::string& operator_token, const std::vector<std::string>& links,
                 const std::optional<Certificate>& certificate) {
  const std::string sha256 = certificate ? certificate->sha256 : "";
  if (options.json) {
    nlohmann::ordered_json urls = nlohmann::ordered_json::array();
    for (const std::string& link : links) urls.push_back(origin + "/play/" + link);
    print_json({{"operator", origin + "/?token=" + operator_token},
                {"links", urls},
                {"certificate_sha256", sha256}});
  } else {
    fmt::print("operator  {}/?token={}\n", origin, operator_token);
    for (const std::string& link : links) fmt::print("guest     {}/play/{}\n", origin, link);
  }
  std::fflush(stdout);
  if (sha256.empty()) return;
  say("headpin serve: it made a certificate for this run; browsers will ask whether to trust it. "
      "Its SHA-256 is\n{}\n",
      sha256);
}

void serve(const ServeOptions& options) {
  watch_stop_signals();
  Offered offer = offered(options);
  Guests guests(offer.next, [](const std::string& sentence) {
    say("headpin serve: {}\n", printable(sentence));
  });
  std::vector<std::string> links;
  for (int i = 0; i < options.links; ++i) {
    try {
      links.push_back(guests.invite().token);
    } catch (const Refused& none_left) {
      if (links.empty())
        throw std::runtime_error(fmt::format("{}: {}", options.what, none_left.what()));
      say("headpin serve: {}\n", none_left.what());
      break;
    }
  }
  PlayServer player(guests, std::move(offer.pages));
  const std::optional<Certificate> certificate = certificate_for(options);
  const WebServer server(
      {.address = options.bind, .port = options.port, .certificate = certificate},
      [&](const WebRequest& request) { return player.most(request); },
      [&](const WebRequest& request) { return player.answer(request); });
  const std::string origin = fmt::format("{}://{}:{}", certificate ? "https" : "http",
                                         in_url(reachable(options.bind)), server.port());
  print_start(options, origin, player.operator_token(), links, certificate);
  while (stop_signal() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  heed_stop();
}

}  // namespace

void add_serve(CLI::App& app) {
  auto options = std::make_shared<ServeOptions>();
  CLI::App* command = app.add_subcommand(
      "serve",
      "Serve the page of `play` to other devices, such as a headset, and record what they send");
  command
      ->add_option("WHAT", options->what,
                   "folder of a study, name of a bundled scenario, or a TOML file")
      ->capture_default_str();
  add_output(*command, "-o,--output", options->output,
             "folder for the logs of a scenario's games: guest-01.lcmlog and so on; existing logs "
             "are kept",
             {});
  command->add_option("--port", options->port, "TCP port; 0: any free one")
      ->check(whole_number_from(0, 65535))
      ->capture_default_str();
  command
      ->add_option("--bind", options->bind,
                   "address to listen at; the default is for this machine only, 0.0.0.0 is for all "
                   "networks. Other addresses than those of this machine only are served by HTTPS")
      ->capture_default_str();
  command->add_option("--certificate", options->certificate,
                      "certificate for HTTPS (PEM); default: one that is made for this run");
  command->add_option("--key", options->key, "key of the certificate (PEM)");
  command->add_option("--links", options->links, "number of links to print")
      ->check(whole_number_from(1, 1000))
      ->capture_default_str();
  command->add_option("--page", options->page,
                      "page template of the guests; default: the one that is installed with the "
                      "program");
  command->add_option("--watch-page", options->watch_page,
                      "page template of the operator; default: the one that is installed with the "
                      "program");
  add_condition_options(*command, options->condition);
  add_json(*command, options->json);
  command->footer(
      "Each link is for one game of one person. The operator's page makes more links, in a study "
      "also for a participant whose game\nwas cut off. It shows who is playing, and the room. With a "
      "study, each link is for the next participant of the plan; the\nquestions are asked in the "
      "page after the game.\n\n"
      "Example:\n  headpin serve regulation-ten-pin -o games --bind 0.0.0.0\n  headpin serve study --port 9000");
  command->callback([options] { serve(*options); });
}

}  // namespace headpin::apps
