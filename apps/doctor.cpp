#include <chrono>
#include <fstream>
#include <memory>
#include <thread>

#include <dlfcn.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/streams.h"
#include "devices/lcm_link.h"
#include "scene/eyes.h"

namespace headpin::apps {

namespace {

struct Finding {
  std::string name;
  bool works;
  std::string says;  ///< what it is, or what is wrong
  std::string remedy;
};

Finding look_at_osmesa() {
  try {
    scene::Eyes eyes = scene::open_eyes(scene::make_stage(scene::Scenario()));
    std::array<render::Image, 2> images;
    scene::see(eyes, {}, images);
    return {"osmesa", true, eyes.renderer.description(), ""};
  } catch (const std::exception& error) {
    return {"osmesa", false, error.what(), "apt-get install libosmesa6"};
  }
}

/// Sends a sample to itself, as an LCM application does at its start.
Finding look_at_multicast() {
  const std::string remedy = "ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo";
  try {
    devices::LcmLink link("");
    devices::LcmSource source(link);
    devices::TrackerSample sample;
    sample.station = 4;
    link.publish(devices::Sample(sample));
    for (int i = 0; i < 50; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      source.receive(Time{1'000'000});
      if (source.counts().received > 0) return {"lcm_multicast", true, "a sample came back", ""};
    }
    return {"lcm_multicast", false, "what is sent does not come back", remedy};
  } catch (const std::exception& error) {
    const std::string says = error.what();
    return {"lcm_multicast", false, says.substr(0, says.find(';')), remedy};
  }
}

/// Raw eyes come in one message of half a megabyte; a subscriber's socket that holds less loses
/// pieces of it, and with them the frame.
Finding look_at_receive_buffer() {
  constexpr long kEnough = 2'097'152;  // bytes: two frames, and what the kernel adds to each piece
  long found = 0;
  std::ifstream("/proc/sys/net/core/rmem_default") >> found;
  return {"raw_eyes", found >= kEnough,
          fmt::format("sockets hold {} bytes by default; live --eyes raw needs {}, png does not",
                      found, kEnough),
          fmt::format("sysctl -w net.core.rmem_max={0} net.core.rmem_default={0}", kEnough)};
}

Finding look_for_library(const char* name, const char* file, const char* package) {
  void* library = dlopen(file, RTLD_LAZY | RTLD_LOCAL);
  if (!library) return {name, false, "not installed", fmt::format("apt-get install {}", package)};
  dlclose(library);
  return {name, true, file, ""};
}

Finding look_for_program(const char* name, const char* package) {
  const char* path = std::getenv("PATH");
  std::string_view rest = path ? path : "";
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    const std::string candidate = fmt::format("{}/{}", rest.substr(0, colon), name);
    if (access(candidate.c_str(), X_OK) == 0) return {name, true, candidate, ""};
    rest = colon == std::string_view::npos ? "" : rest.substr(colon + 1);
  }
  return {name, false, "not installed", fmt::format("apt-get install {}", package)};
}

void diagnose(bool json) {
  const std::vector<Finding> findings = {look_at_osmesa(),
                                         look_at_multicast(),
                                         look_at_receive_buffer(),
                                         look_for_program("ffmpeg", "ffmpeg"),
                                         look_for_program("lcm-logplayer", "liblcm-bin"),
                                         look_for_library("egl", "libEGL.so.1", "libegl1"),
                                         look_for_program("Rscript", "r-base-core")};
  nlohmann::json all = nlohmann::json::object();
  for (const Finding& f : findings) {
    all[f.name] = {{"works", f.works}, {"says", f.says}, {"remedy", f.remedy}};
    if (json) continue;
    fmt::print("{:<15}{:<5}{}\n", f.name, f.works ? "ok" : "no", f.says);
    if (!f.works) fmt::print("{:<20}type: {}\n", "", f.remedy);
  }
  if (json) print_json(all);
}

}  // namespace

void add_doctor(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("doctor", "Tell what works on this machine");
  add_json(*command, *json);
  command->footer(
      "Only pictures need OSMesa, only videos ffmpeg; without a multicast route every command "
      "works\n"
      "with file:// and memq:// URLs. EGL and R are for what is to come.\n\nExample:\n  headpin "
      "doctor");
  command->callback([json] { diagnose(*json); });
}

}  // namespace headpin::apps
