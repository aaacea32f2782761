#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <emscripten/emscripten.h>
#include <nlohmann/json.hpp>

#include "apps/report/engine/answers.h"
#include "scene/page/page_data.h"

// The functions that the page of a trial calls.
namespace {

using namespace headpin;
using namespace headpin::page;

/// The bytes of a log, its trial, and its meshes.
struct Opened {
  std::vector<std::uint8_t> bytes;
  scene::Recorded recorded;
  scene::PageLooks looks;

  explicit Opened(std::vector<std::uint8_t> log)
      : bytes(std::move(log)),
        recorded(scene::load_trial(bytes, "trial")),
        looks(recorded.scenario) {}
};

std::unique_ptr<Opened> opened;

template <typename T>
void read(std::optional<T>& into, const std::string& name, const nlohmann::json& value) {
  constexpr bool kNumber = std::is_same_v<T, double>;
  if (kNumber ? !value.is_number() : !value.is_string()) {
    throw std::invalid_argument(name + ": expected " + (kNumber ? "a number" : "a name") +
                                ", found " + value.dump());
  }
  into = value.get<T>();
}

/// {"friction": 0.5, "shape": "true", ...}
scene::Condition condition_of(const std::vector<std::uint8_t>& question) {
  const nlohmann::json asked = nlohmann::json::parse(question);
  scene::Condition condition;
  const auto read_name = [&](const std::string& key, const nlohmann::json& value) {
    std::optional<std::string> name;
    read(name, key, value);
    // In quotes, because the name of a shape is "true".
    condition.set.push_back("collision." + key + "='" + *name + "'");
  };
  for (const auto& [name, value] : asked.items()) {
    if (name == "elasticity") {
      read(condition.elasticity, name, value);
    } else if (name == "friction") {
      read(condition.friction, name, value);
    } else if (name == "shape" || name == "response") {
      read_name(name, value);
    } else {
      throw std::invalid_argument("expected elasticity, friction, shape or response, found " +
                                  name);
    }
  }
  return condition;
}

/// @param meshes  include the meshes of its bodies
void answer_page(const Opened& log, const scene::Condition& condition, bool meshes) {
  scene::PageData data = scene::page_data(log.recorded, log.looks, condition, meshes);
  answer(text_of(data.json), std::move(data.floats));
}

}  // namespace

extern "C" {

/// Opens the given log as the current trial. If it is not a trial, the previous one stays.
EMSCRIPTEN_KEEPALIVE bool headpin_load() {
  return attempt([] {
    opened = std::make_unique<Opened>(take_given());
    answer("{}");
  });
}

/// Opens the given log and simulates it as it was recorded, with the meshes of its bodies. After an error the
/// previous trial stays.
EMSCRIPTEN_KEEPALIVE bool headpin_open() {
  return attempt([] {
    auto log = std::make_unique<Opened>(take_given());
    answer_page(*log, {}, true);
    opened = std::move(log);
  });
}

/// Simulates the current trial with the changes of the given JSON, without meshes.
EMSCRIPTEN_KEEPALIVE bool headpin_simulate() {
  return attempt([] {
    if (!opened) throw std::logic_error("no trial is open");
    answer_page(*opened, condition_of(take_given()), false);
  });
}

}  // extern "C"
