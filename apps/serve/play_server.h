#pragma once

#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "apps/serve/guests.h"
#include "apps/serve/web.h"

/// What `headpin serve` answers: a page for each guest, their logs, and the operator's view.
///
///     GET  /?token=OPERATOR              the operator's page
///     GET  /state?token=OPERATOR         how the guests do, as JSON
///     POST /links?token=OPERATOR         a link for one more guest
///     GET  /play/TOKEN                   the guest's page, until a game has begun
///     POST /play/TOKEN/begin?key=KEY     a game begins; the page has made the key
///     POST /play/TOKEN/log?key=KEY&at=N  a piece of the log
///     POST /play/TOKEN/end?key=KEY&at=N  the log is whole, with N bytes
///     POST /play/TOKEN/answers?key=KEY   the answers to the questionnaire, as JSON
///
/// Everything else is answered by 403, and nothing is said of it.
namespace headpin::apps {

struct ServedPages {
  std::string play, watch;             ///< templates
  nlohmann::json questions = nullptr;  ///< null without a questionnaire
  scene::Scenario watched;             ///< that the operator's page draws
};

class PlayServer {
 public:
  PlayServer(Guests& guests, ServedPages pages);

  const std::string& operator_token() const { return operator_token_; }

  /// The largest body of a request; refuses those without a token.
  std::size_t most(const WebRequest& request);
  WebAnswer answer(const WebRequest& request);

 private:
  WebAnswer of_operator(const WebRequest& request);
  WebAnswer of_guest(const WebRequest& request);
  std::string guest_page(const Guest& guest) const;
  std::string watch_page() const;

  Guests& guests_;
  ServedPages pages_;
  std::string operator_token_ = random_token();
};

}  // namespace headpin::apps
