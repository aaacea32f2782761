#include "apps/serve/play_server.h"

#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "apps/page_file.h"
#include "devices/base/version.h"
#include "scene/page/play_page.h"

namespace headpin::apps {

namespace {

using nlohmann::json;

constexpr std::size_t kMostPiece = 4'000'000;
constexpr std::size_t kMostAnswers = 65'536;
constexpr std::string_view kPlay = "/play/";
constexpr const char* kHtml = "text/html; charset=utf-8";
constexpr const char* kJson = "application/json";

[[noreturn]] void forbid() {
  throw Refused(403, "expected a link with its token, as headpin serve printed it");
}

WebAnswer in_json(const json& object) {
  return {.type = kJson, .body = object.dump(-1, ' ', false, json::error_handler_t::replace)};
}

std::int64_t whole_number(const std::string& text, const char* name) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || number < 0) {
    throw Refused(400, fmt::format("{}: expected a whole number from 0", name));
  }
  return number;
}

/// "/play/TOKEN/doing"
struct GuestPath {
  std::string_view token, doing;
};

std::optional<GuestPath> guest_path(std::string_view path) {
  if (!path.starts_with(kPlay)) return std::nullopt;
  path.remove_prefix(kPlay.size());
  const std::size_t slash = std::min(path.find('/'), path.size());
  if (!is_token(path.substr(0, slash))) return std::nullopt;
  return GuestPath{path.substr(0, slash), path.substr(std::min(slash + 1, path.size()))};
}

/// The page may send to where it came from, and nowhere else.
std::string with_connection(std::string page) {
  constexpr std::string_view kMark = "img-src data: blob:";
  const std::size_t at = page.find(kMark);
  if (at != page.npos) page.insert(at + kMark.size(), "; connect-src 'self'");
  return page;
}

std::string page_of(const std::string& page, scene::PageData data) {
  data.json["version"] = devices::software_version();
  data.json["commit"] = devices::software_commit();
  return with_connection(filled(
      page, {{"play", deflated(data.json.dump(-1, ' ', false, json::error_handler_t::replace))},
             {"play-numbers", deflated(in_quanta(data))}}));
}

}  // namespace

PlayServer::PlayServer(Guests& guests, ServedPages pages)
    : guests_(guests), pages_(std::move(pages)) {}

std::size_t PlayServer::most(const WebRequest& request) {
  const std::optional<GuestPath> guest = guest_path(request.path);
  if (!guest) {
    if (request.query("token") != operator_token_) forbid();
    return 0;
  }
  guests_.find(guest->token);
  if (guest->doing == "log") return kMostPiece;
  return guest->doing == "answers" ? kMostAnswers : 0;
}

WebAnswer PlayServer::answer(const WebRequest& request) {
  return guest_path(request.path) ? of_guest(request) : of_operator(request);
}

WebAnswer PlayServer::of_operator(const WebRequest& request) {
  const bool get = request.method == "GET";
  if (get && request.path == "/") return {.type = kHtml, .body = watch_page()};
  if (get && request.path == "/state") return in_json({{"guests", guests_.state()}});
  if (request.method == "POST" && request.path == "/links") {
    const std::string again = request.query("again");
    const Guest& guest = again.empty() ? guests_.invite() : guests_.invite_again(again);
    return in_json({{"path", fmt::format("{}{}", kPlay, guest.token)},
                    {"participant", guest.place.participant}});
  }
  forbid();
}

WebAnswer PlayServer::of_guest(const WebRequest& request) {
  const GuestPath path = *guest_path(request.path);
  if (request.method == "GET" && path.doing.empty()) {
    return {.type = kHtml, .body = guest_page(guests_.to_show(path.token))};
  }
  if (request.method != "POST") forbid();
  const std::string key = request.query("key");
  if (path.doing == "begin") return in_json({{"size", guests_.begin(path.token, key)}});
  if (path.doing == "answers") {
    const json answers = json::parse(request.body, nullptr, false);
    if (!answers.is_object()) throw Refused(400, "expected a JSON object of answers");
    guests_.answer(path.token, key, answers);
    return in_json({{"stored", true}});
  }
  if (path.doing != "log" && path.doing != "end") forbid();
  const std::int64_t at = whole_number(request.query("at"), "at");
  if (path.doing == "end") {
    guests_.end(path.token, key, at);
    return in_json({{"size", at}});
  }
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(request.body.data());
  return in_json({{"size", guests_.add(path.token, key, at, {bytes, request.body.size()})}});
}

std::string PlayServer::guest_page(const Guest& guest) const {
  scene::PageData data = scene::play_page(guest.place.scenario);
  data.json["guest"] = {{"participant", guest.place.participant},
                        {"condition", guest.place.condition},
                        {"hint", guest.place.hint},
                        {"ended", guest.is_to_be_asked()},
                        {"questions", pages_.questions}};
  return page_of(pages_.play, std::move(data));
}

std::string PlayServer::watch_page() const {
  return page_of(pages_.watch, scene::play_page(pages_.watched));
}

}  // namespace headpin::apps
