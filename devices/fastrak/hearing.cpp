#include "devices/fastrak/hearing.h"

#include <string_view>
#include <utility>

#include "devices/fastrak/codec.h"
#include "devices/fastrak/commands.h"

namespace headpin::devices {
namespace {

constexpr std::string_view kImmediate = "PCcSFfUuDdW";

bool is_control(char c) {
  return c == kFastrakSave || c == kFastrakResume || c == kFastrakSuspend ||
         c == kFastrakReinitialise;
}

}  // namespace

FastrakHeard FastrakHearing::hear(std::uint8_t byte) {
  using Kind = FastrakHeard::Kind;
  const char c = static_cast<char>(byte);
  if (is_control(c)) return control(c);
  if (c == '\r' || c == '\n') return end_of_line(c);
  if (c == ' ' && line_.empty()) return {};
  swallow_ = Swallow::nothing;
  if (!line_.empty()) {
    if (line_.size() <= kFastrakLongestLine) line_ += c;  // one more than allowed: it is too long
    return {};
  }
  if (kImmediate.find(c) != std::string_view::npos) {
    swallow_ = Swallow::any_end;
    return {Kind::immediate, {c}};
  }
  if (is_fastrak_line_command(c)) {
    line_ = c;
    return {};
  }
  swallow_ = Swallow::any_end;
  return {Kind::unknown, {c}};
}

/// Control bytes act at once, also in the middle of a line, which continues after them; but the unit
/// that starts again forgets the line.
FastrakHeard FastrakHearing::control(char c) {
  if (c == kFastrakReinitialise) line_.clear();
  if (line_.empty()) swallow_ = Swallow::any_end;
  return {FastrakHeard::Kind::control, {c}};
}

FastrakHeard FastrakHearing::end_of_line(char c) {
  using Kind = FastrakHeard::Kind;
  const bool cr = c == '\r';
  const Swallow swallow =
      std::exchange(swallow_, cr ? Swallow::line_feed : Swallow::carriage_return);
  if (!line_.empty()) return {Kind::line, std::exchange(line_, {})};
  if (swallow == (cr ? Swallow::carriage_return : Swallow::line_feed)) {
    swallow_ = Swallow::nothing;  // the second half of CR LF or LF CR
    return {};
  }
  if (cr && swallow != Swallow::any_end) return {Kind::unknown, {}};
  return {};
}

}  // namespace headpin::devices
