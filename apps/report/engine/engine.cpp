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

}  // namespace

extern "C" {

/// Opens the given log as the current trial. If it is not a trial, the previous one stays.
EMSCRIPTEN_KEEPALIVE bool headpin_load() {
  return attempt([] {
    opened = std::make_unique<Opened>(take_given());
    answer("{}");
  });
}

/// Simulates the current trial with the changes of the given JSON.
///
/// @param meshes  include the meshes of its bodies
EMSCRIPTEN_KEEPALIVE bool headpin_simulate(bool meshes) {
  return attempt([&] {
    if (!opened) throw std::logic_error("no trial is open");
    const scene::Condition condition = condition_of(take_given());
    scene::PageData data = scene::page_data(opened->recorded, opened->looks, condition, meshes);
    answer(text_of(data.json), std::move(data.floats));
  });
}

}  // extern "C"
