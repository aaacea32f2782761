#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "devices/fastrak/asking.h"
#include "devices/fastrak/emulator.h"

namespace headpin::devices {

/// A client's end of the line to a unit in simulated time, whose answers a test changes.
class ChangedLine : public FastrakLine {
 public:
  explicit ChangedLine(const FastrakEmulatorOptions& options, FastrakMotion motion = still_motion)
      : emulator_(options, std::move(motion)) {}

  void put(std::string_view text) override {
    said.emplace_back(text);
    emulator_.receive(Bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), now_);
    if (answers_at_once) hear(Time{100'000}, std::string::npos);
  }
  std::string wait(Time span, std::size_t enough = std::string::npos) override {
    hear(span, enough);
    std::string told = heard_.substr(0, enough);
    heard_.erase(0, told.size());
    if (change) change(sent(), told);
    return told;
  }
  void flush() override {
    said.emplace_back(kFlush);
    heard_.clear();
  }
  int baud() const override { return emulator_.baud(); }

  static constexpr std::string_view kFlush = "(what came is discarded)";
  std::vector<std::string> said;  ///< what was sent so far, and kFlush
  std::function<void(const std::string& sent, std::string& heard)> change;
  bool answers_at_once = false;

 private:
  void hear(Time span, std::size_t enough) {
    for (const Time end = now_ + span; now_ < end && heard_.size() < enough;) {
      now_ += Time{500};
      const Bytes out = emulator_.due(now_);
      heard_.append(reinterpret_cast<const char*>(out.data()), out.size());
      emulator_.taken(out.size());
    }
  }

  FastrakEmulator emulator_;
  Time now_{};
  std::string heard_;
};

}  // namespace headpin::devices
