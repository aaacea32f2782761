#include "apps/report/engine/answers.h"

#include <cstddef>
#include <exception>
#include <new>
#include <utility>

#include <emscripten/emscripten.h>

namespace headpin::page {

namespace {

std::vector<std::uint8_t> given, bytes;
std::string text;
std::vector<float> numbers_given_out;

}  // namespace

bool attempt(const std::function<void()>& work) {
  text.clear();
  numbers_given_out.clear();
  bytes.clear();
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

void answer(std::string said, std::vector<float> with) {
  text = std::move(said);
  numbers_given_out = std::move(with);
}

void answer_bytes(std::vector<std::uint8_t> given_out) {
  bytes = std::move(given_out);
}

std::vector<float>& floats() {
  return numbers_given_out;
}

std::vector<std::uint8_t> take_given() {
  return std::exchange(given, {});
}

std::string text_of(const nlohmann::json& object) {
  return object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

extern "C" {

/// Memory for the input of the next call: a log, or the text of a question.
/// @return  null without enough memory
EMSCRIPTEN_KEEPALIVE std::uint8_t* headpin_room(std::size_t size) {
  return attempt([&] { given = std::vector<std::uint8_t>(size); }) ? given.data() : nullptr;
}

/// The result of the last call.
EMSCRIPTEN_KEEPALIVE const char* headpin_text() {
  return text.data();
}
EMSCRIPTEN_KEEPALIVE std::size_t headpin_text_size() {
  return text.size();
}
EMSCRIPTEN_KEEPALIVE const float* headpin_floats() {
  return numbers_given_out.data();
}
EMSCRIPTEN_KEEPALIVE std::size_t headpin_floats_size() {
  return numbers_given_out.size();
}
EMSCRIPTEN_KEEPALIVE const std::uint8_t* headpin_bytes() {
  return bytes.data();
}
EMSCRIPTEN_KEEPALIVE std::size_t headpin_bytes_size() {
  return bytes.size();
}

}  // extern "C"

}  // namespace headpin::page
