#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "apps/serve/incoming_log.h"
#include "scene/scenario/scenario.h"
#include "scene/watch/followed_log.h"

/// The people who play over the network, one link each.
namespace headpin::apps {

/// 128 random bits of the system, as 32 hexadecimal digits.
std::string random_token();
/// Whether a text could be one.
bool is_token(std::string_view text);

/// A request that is answered with no, and why.
struct Refused : std::runtime_error {
  Refused(int status_code, const std::string& why) : std::runtime_error(why), status(status_code) {}
  int status;  ///< of HTTP
};

/// An answer that is missing, or is none of its question's.
struct NoAnswer : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// What a guest plays, and where the log goes.
struct Place {
  std::string participant = {};  ///< of the plan; empty where the guest says who it is
  std::string condition = {};
  scene::Scenario scenario;
  std::string hint = {};  ///< for the guest, before the game
  /// Opens the log when the game begins.
  /// @throws Refused  409 where its session has been played, or is being played elsewhere; others when its file
  ///                  cannot be opened
  std::function<std::unique_ptr<IncomingLog>()> open = {};
  /// Asked before another link is made; null outside a plan.
  /// @throws Refused  409 as above
  std::function<void()> require_unplayed = {};
  /// Stores the answers of the questionnaire; null without one.
  /// @throws NoAnswer  and others where they cannot be stored
  std::function<void(const nlohmann::json&)> answer = {};
};

struct Guest {
  enum class State { invited, playing, ended, cut_off };  ///< cut off: another game took its place

  /// Whether only the questions are left.
  bool is_to_be_asked() const { return state == State::ended && place.answer && !has_answered(); }
  bool has_answered() const { return !answers.empty(); }

  std::string token;
  Place place;
  State state = State::invited;
  std::string key;  ///< made by the page that began the game; only it can send the log
  std::unique_ptr<IncomingLog> log;
  scene::FollowedLog followed;
  std::chrono::steady_clock::time_point heard;  ///< when the last piece came
  std::string trouble;                          ///< the last refusal of a piece
  std::string answers;                          ///< that are stored, as JSON; empty before
  Guest* instead_of = nullptr;  ///< whose game, of the same participant, ends when this one begins
};

/// All guests. One thread uses it.
class Guests {
 public:
  /// @param next  the place of the next guest; throws Refused when there is none
  /// @param tell  takes a sentence for the operator
  Guests(std::function<Place()> next, std::function<void(const std::string&)> tell)
      : next_(std::move(next)), tell_(std::move(tell)) {}

  /// Makes a link for one more guest.
  Guest& invite();
  /// Makes a link for the participant of a game that does not go on: for another game from the start. The one
  /// before may go on until that begins; what it recorded is kept. Asked again, it is the same link until then.
  ///
  /// @throws Refused  403 for an unknown token; 409, and why, where nobody could play by it: for a guest who is no
  ///                  participant of a plan, or does not play, or whose whole game is here
  Guest& invite_again(std::string_view token);

  /// @throws Refused  403 for an unknown token
  Guest& find(std::string_view token);
  /// @throws Refused  403 for a link that was used
  Guest& still_open(std::string_view token);

  /// For its page: also a link whose game has ended, while its questions are not answered.
  /// @throws Refused  403 for another link that was used
  Guest& to_show(std::string_view token);

  /// The link is used from now on. The same key may begin again, also after the end, as its page may
  /// not have got the answer to the one or the other.
  ///
  /// @return  bytes of the log that are here
  /// @throws Refused  403 for a used link, 400 for what is no key, 409 where the session was played to its end or is
  ///                  being played elsewhere, 500 where its file cannot be opened
  std::int64_t begin(std::string_view token, const std::string& key);

  /// @return  bytes of the log that are here
  /// @throws Refused  403 for another key; 409 for a piece that does not follow; 413 for too long a
  ///                  log; 507 where the disk takes no more
  std::int64_t add(std::string_view token, const std::string& key, std::int64_t at,
                   std::span<const std::uint8_t> piece);

  /// @param size  of the whole log
  /// @throws Refused  403; 409 when some of it is missing
  void end(std::string_view token, const std::string& key, std::int64_t size);

  /// The same answers may come again, as their page may not have got the answer to the first request.
  ///
  /// @throws Refused  403; 400 for answers that are none; 409 for others than those that are stored;
  ///                  507 where they cannot be stored
  void answer(std::string_view token, const std::string& key, const nlohmann::json& answers);

  /// For the operator: all guests and how they do.
  nlohmann::json state() const;

 private:
  Guest& playing(std::string_view token, const std::string& key);
  Guest& add_guest(Place place);
  void cut_off(Guest& guest);

  std::function<Place()> next_;
  std::function<void(const std::string&)> tell_;
  std::list<Guest> guests_;
};

}  // namespace headpin::apps
