#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

/// How the page and the engine talk: functions in plain C, which engine.js wraps. No exception leaves
/// them: each returns whether it succeeded, and `headpin_text` gives the result or the error.
namespace headpin::page {

/// Does the work of a call; an exception becomes the error that the page reads.
bool attempt(const std::function<void()>& work);

/// The result of a call.
void answer(std::string text, std::vector<float> floats = {});
void answer_bytes(std::vector<std::uint8_t> bytes);
/// The numbers of the last result; whoever fills them again and again keeps their memory.
std::vector<float>& floats();

/// The input of a call, as the page has put it in.
std::vector<std::uint8_t> take_given();

std::string text_of(const nlohmann::json& object);

}  // namespace headpin::page
