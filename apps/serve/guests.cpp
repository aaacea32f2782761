#include "apps/serve/guests.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/random.h>

#include "apps/streams.h"
#include "scene/page/browser_device.h"

namespace headpin::apps {

namespace {

constexpr std::int64_t kLongestLog = 2'000'000'000;  // bytes: two days

/// Who it is, for the operator.
std::string name_of(const Guest& guest) {
  if (!guest.place.participant.empty()) return guest.place.participant;
  return guest.log ? guest.log->path() : "a guest";
}

const char* word(Guest::State state) {
  if (state == Guest::State::invited) return "invited";
  if (state == Guest::State::cut_off) return "cut off";
  return state == Guest::State::playing ? "playing" : "ended";
}

/// Why a guest gets no other link; null where it may.
const char* why_not_again(const Guest& guest) {
  if (guest.place.participant.empty()) return "another link is only for a participant of a plan";
  if (guest.state == Guest::State::invited) return "no game has begun by this link: use it";
  if (guest.state == Guest::State::ended) return "this game was played to its end";
  return guest.state == Guest::State::cut_off ? "this game goes on by another link" : nullptr;
}

}  // namespace

std::string random_token() {
  std::array<std::uint8_t, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error(std::string("the system gives no random numbers: ") +
                             std::strerror(errno));
  }
  std::string token;
  for (const std::uint8_t byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool is_token(std::string_view text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == text.npos;
}

Guest& Guests::invite() {
  return add_guest(next_());
}

Guest& Guests::invite_again(std::string_view token) {
  Guest& before = find(token);
  if (const char* const why = why_not_again(before)) throw Refused(409, why);
  try {
    before.place.require_unplayed();
  } catch (const Refused&) {
    throw;
  } catch (const std::exception& error) {
    throw Refused(409, printable(error.what()));
  }
  const auto known = std::ranges::find(guests_, &before, &Guest::instead_of);
  if (known != guests_.end()) return *known;
  Guest& guest = add_guest(before.place);
  guest.instead_of = &before;
  return guest;
}

Guest& Guests::add_guest(Place place) {
  Guest& guest = guests_.emplace_back();
  guest.token = random_token();
  guest.followed = scene::FollowedLog(
      scene::played_with(place.scenario, scene::browser_devices().front(), false));
  guest.place = std::move(place);
  return guest;
}

Guest& Guests::find(std::string_view token) {
  const auto found = std::ranges::find(guests_, token, &Guest::token);
  if (found == guests_.end()) throw Refused(403, "this link is not known here");
  return *found;
}

Guest& Guests::still_open(std::string_view token) {
  Guest& guest = find(token);
  if (guest.state != Guest::State::invited) {
    throw Refused(403, "this link was used already; ask for another one");
  }
  return guest;
}

Guest& Guests::to_show(std::string_view token) {
  Guest& guest = find(token);
  return guest.is_to_be_asked() ? guest : still_open(token);
}

std::int64_t Guests::begin(std::string_view token, const std::string& key) {
  if (!is_token(key)) throw Refused(400, "key: expected 32 hexadecimal digits");
  Guest& guest = find(token);
  if (guest.state != Guest::State::invited && guest.key == key)
    return playing(token, key).log->size();
  still_open(token);
  if (guest.instead_of && guest.instead_of->state == Guest::State::ended) {
    throw Refused(409, "this game was played to its end meanwhile");
  }
  try {
    guest.log = guest.place.open();
  } catch (const Refused& no) {
    tell_(no.what());
    throw;
  } catch (const std::exception& error) {
    tell_(error.what());
    throw Refused(500, "the game cannot be recorded here; tell the people who invited you");
  }
  if (guest.instead_of) cut_off(*guest.instead_of);
  guest.key = key;
  guest.state = Guest::State::playing;
  guest.heard = std::chrono::steady_clock::now();
  tell_(fmt::format("{} plays", name_of(guest)));
  return 0;
}

void Guests::cut_off(Guest& guest) {
  guest.state = Guest::State::cut_off;
  tell_(fmt::format("{} plays by another link: {} is cut off", name_of(guest), guest.log->path()));
  try {
    guest.log->close();
  } catch (const std::runtime_error& error) {
    tell_(error.what());
  }
}

Guest& Guests::playing(std::string_view token, const std::string& key) {
  Guest& guest = find(token);
  if (guest.state == Guest::State::invited || guest.key != key) {
    throw Refused(403, "another page plays with this link");
  }
  if (guest.state == Guest::State::cut_off) throw Refused(403, "this game goes on by another link");
  return guest;
}

std::int64_t Guests::add(std::string_view token, const std::string& key, std::int64_t at,
                         std::span<const std::uint8_t> piece) {
  Guest& guest = playing(token, key);
  if (guest.state == Guest::State::ended) throw Refused(409, "this game has ended");
  if (at > kLongestLog - static_cast<std::int64_t>(piece.size())) {
    throw Refused(413, fmt::format("the log is longer than {} bytes", kLongestLog));
  }
  try {
    guest.followed.add(guest.log->add(at, piece));
  } catch (const WrongPlace& error) {
    throw Refused(409, error.what());
  } catch (const std::runtime_error& error) {
    if (guest.trouble != error.what()) tell_(error.what());
    guest.trouble = error.what();
    throw Refused(507, "the game cannot be stored here");
  }
  guest.trouble.clear();
  guest.heard = std::chrono::steady_clock::now();
  return guest.log->size();
}

void Guests::end(std::string_view token, const std::string& key, std::int64_t size) {
  Guest& guest = playing(token, key);
  if (guest.log->size() != size) {
    throw Refused(409, fmt::format("expected {} bytes, found {}", size, guest.log->size()));
  }
  if (guest.state == Guest::State::ended) return;
  try {
    guest.log->close();
  } catch (const std::runtime_error& error) {
    tell_(error.what());
    throw Refused(507, "the game cannot be stored here");
  }
  guest.state = Guest::State::ended;
  tell_(fmt::format("{} has ended: {}, {} bytes", name_of(guest), guest.log->path(), size));
}

void Guests::answer(std::string_view token, const std::string& key, const nlohmann::json& answers) {
  Guest& guest = playing(token, key);
  if (!guest.place.answer) throw Refused(404, "nothing is asked here");
  const std::string text = answers.dump();
  if (guest.has_answered()) {
    if (guest.answers == text) return;
    throw Refused(409, "the questions were answered already");
  }
  const auto refuse = [&](const std::exception& error, int status, const char* why) {
    tell_(fmt::format("{}: {}", name_of(guest), printable(error.what())));
    throw Refused(status, why);
  };
  try {
    guest.place.answer(answers);
  } catch (const NoAnswer& error) {
    refuse(error, 400, "a question has none of its answers");
  } catch (const std::exception& error) {
    refuse(error, 507, "they cannot be stored here now; tell the people who invited you");
  }
  guest.answers = text;
  tell_(fmt::format("{} has answered the questions", name_of(guest)));
}

nlohmann::json Guests::state() const {
  nlohmann::json all = nlohmann::json::array();
  for (const Guest& guest : guests_) {
    nlohmann::json one = {{"token", guest.token},
                          {"participant", guest.place.participant},
                          {"condition", guest.place.condition},
                          {"state", word(guest.state)},
                          {"answered", guest.has_answered()},
                          {"trouble", guest.trouble}};
    if (guest.log) {
      const auto silent = std::chrono::steady_clock::now() - guest.heard;
      one["file"] = guest.log->path();
      one["bytes"] = guest.log->size();
      one["silent_s"] = std::chrono::duration<double>(silent).count();
      one["game"] = guest.followed.state();
    }
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace headpin::apps
