#include "scene/watch/drawn_by.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scene/record/events.h"

namespace headpin::scene {

nlohmann::json to_json(const render::Fingerprint& f) {
  return {{"renderer", f.renderer},
          {"processor", f.processor},
          {"environment", f.environment},
          {"test_picture", fmt::format("{:016x}", f.picture)}};
}

Event drawn_by_event(const render::Fingerprint& fingerprint) {
  Event event;
  event.tick = 0;
  event.kind = kind::drawn_by;
  event.detail =
      to_json(fingerprint).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return event;
}

std::optional<render::Fingerprint> drawn_by(const std::vector<Event>& events) {
  const auto found = std::ranges::find(events, kind::drawn_by, &Event::kind);
  if (found == events.end()) return std::nullopt;
  try {
    const nlohmann::json j = nlohmann::json::parse(found->detail);
    render::Fingerprint f;
    f.renderer = j.at("renderer");
    f.processor = j.at("processor");
    f.environment = j.at("environment");
    const std::string hash = j.at("test_picture");
    const auto [end, error] =
        std::from_chars(hash.data(), hash.data() + hash.size(), f.picture, 16);
    if (error != std::errc{} || end != hash.data() + hash.size()) return std::nullopt;
    return f;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

}  // namespace headpin::scene
