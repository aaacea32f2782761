#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <emscripten/emscripten.h>
#include <nlohmann/json.hpp>

#include "scene/page/page_data.h"

// The functions that the page calls, in plain C; engine.js wraps them for the page. No exception
// leaves them: each returns whether it succeeded, and `headpin_text` gives the result or the error.
namespace {

using namespace headpin;

/// The bytes of a log, its trial, and its meshes.
struct Opened {
  std::vector<std::uint8_t> bytes;
  scene::Recorded recorded;
  scene::PageLooks looks;

  explicit Opened(std::vector<std::uint8_t> log)
      : bytes(std::move(log)), recorded(scene::load_trial(bytes, "trial")), looks(recorded) {}
};

std::vector<std::uint8_t> given;  // input from the page for the next call
std::unique_ptr<Opened> opened;
std::string text;
std::vector<float> floats;

template <typename F>
bool attempt(F work) {
  floats.clear();
  try {
    work();
    return true;
  } catch (const std::bad_alloc&) {
    text = "more memory is needed than a page may have";
  } catch (const std::exception& error) {
    text = error.what();
  }
  return false;
}

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

/// Memory for the input of the next call: a log, or the text of a question.
/// @return  null without enough memory
EMSCRIPTEN_KEEPALIVE std::uint8_t* headpin_room(std::size_t size) {
  return attempt([&] { given = std::vector<std::uint8_t>(size); }) ? given.data() : nullptr;
}

/// Opens the given log as the current trial. If it is not a trial, the previous one stays.
EMSCRIPTEN_KEEPALIVE bool headpin_load() {
  return attempt([] {
    opened = std::make_unique<Opened>(std::exchange(given, {}));
    text = "{}";
  });
}

/// Simulates the current trial with the changes of the given JSON.
///
/// @param meshes  include the meshes of its bodies
EMSCRIPTEN_KEEPALIVE bool headpin_simulate(bool meshes) {
  return attempt([&] {
    if (!opened) throw std::logic_error("no trial is open");
    const scene::Condition condition = condition_of(std::exchange(given, {}));
    scene::PageData data = scene::page_data(opened->recorded, opened->looks, condition, meshes);
    text = data.json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    floats = std::move(data.floats);
  });
}

/// The result of the last call.
EMSCRIPTEN_KEEPALIVE const char* headpin_text() {
  return text.data();
}
EMSCRIPTEN_KEEPALIVE std::size_t headpin_text_size() {
  return text.size();
}
EMSCRIPTEN_KEEPALIVE const float* headpin_floats() {
  return floats.data();
}
EMSCRIPTEN_KEEPALIVE std::size_t headpin_floats_size() {
  return floats.size();
}

}  // extern "C"
