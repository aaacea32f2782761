#include <chrono>
#include <fstream>
#include <memory>
#include <set>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/plot_file.h"
#include "apps/priority.h"
#include "apps/rsvg.h"
#include "apps/streams.h"
#include "devices/lcm/link.h"
#include "devices/lcm/source.h"
#include "render/egl_devices.h"
#include "render/fingerprint.h"
#include "scene/looks/eyes.h"

namespace headpin::apps {

namespace {

struct Finding {
  std::string name;
  bool works;
  std::string says;  ///< what was found, or the problem
  std::string remedy;
};

/// Draws the player's view and the test picture with one context.
Finding look_at_eyes(const char* name, const std::string& gl, const char* remedy,
                     std::set<std::uint64_t>& pictures) {
  try {
    const scene::Scenario scenario;
    scene::Eyes eyes = scene::open_eyes(scene::make_stage(scenario), scenario.look, gl);
    std::array<render::Image, 2> images;
    scene::see(eyes, {}, images);
    pictures.insert(render::fingerprint(eyes.renderer).picture);
    const std::string& why = eyes.renderer.instead_of();
    return {name, true, eyes.renderer.description() + (why.empty() ? "" : "; " + why), ""};
  } catch (const std::exception& error) {
    return {name, false, error.what(), remedy};
  }
}

/// Tests the context that commands use, then each context alone. The last finding says whether they
/// draw equal pictures.
std::vector<Finding> look_at_contexts(const std::string& gl) {
  std::set<std::uint64_t> used, pictures;
  std::vector<Finding> findings = {
      look_at_eyes("eyes", gl, "apt-get install libosmesa6 libegl1 libegl-mesa0", used),
      look_at_eyes("osmesa", "osmesa", "apt-get install libosmesa6", pictures),
      look_at_eyes("egl", "egl", "apt-get install libegl1 libegl-mesa0", pictures)};
  if (findings[1].works && findings[2].works) {
    findings[2].says += pictures.size() == 1 ? "; draws the same" : "; draws other bits";
  }
  for (Finding* alone : {&findings[1], &findings[2]}) {
    if (alone->works || !findings[0].works) continue;
    alone->says += "; not needed, because another context draws";
    alone->remedy.clear();
  }
  return findings;
}

/// A line for each device that EGL lists.
std::vector<Finding> look_at_devices() {
  std::vector<Finding> findings;
  try {
    for (const render::EglDevice& device : render::egl_devices()) {
      findings.push_back(
          {fmt::format("egl:{}", device.number), device.works,
           device.says + (device.cuda ? fmt::format("; CUDA's {}", *device.cuda) : ""),
           "ls -l /dev/dri /dev/nvidia* /usr/share/glvnd/egl_vendor.d"});
    }
  } catch (const std::runtime_error& error) {
    findings.push_back({"egl:auto", false, error.what(), "apt-get install libegl1 libegl-mesa0"});
  }
  return findings;
}

/// Sends a sample to itself, like an LCM application at its start.
Finding look_at_multicast() {
  const std::string remedy = "ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo";
  try {
    devices::LcmLink link("");
    devices::Clocks clocks;
    devices::LcmSource source(link, clocks);
    devices::TrackerSample sample;
    sample.station = 4;
    link.publish(devices::Sample(sample));
    for (int i = 0; i < 50; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      source.receive(Time{1'000'000});
      if (source.intake().counts().received > 0)
        return {"lcm_multicast", true, "a sample came back", ""};
    }
    return {"lcm_multicast", false, "what is sent does not come back", remedy};
  } catch (const std::invalid_argument& error) {
    return {"lcm_multicast", false, error.what(), "unset LCM_DEFAULT_URL"};
  } catch (const std::exception& error) {
    const std::string says = error.what();
    return {"lcm_multicast", false, says.substr(0, says.find(';')), remedy};
  }
}

/// Raw pictures of the eyes are one message of half a megabyte. A subscriber's socket with a
/// smaller buffer loses fragments, and with them the frame.
Finding look_at_receive_buffer() {
  constexpr long kEnough = 2'097'152;  // bytes: two frames, and the kernel's overhead per fragment
  long found = 0;
  std::ifstream("/proc/sys/net/core/rmem_default") >> found;
  return {"raw_eyes", found >= kEnough,
          fmt::format("sockets hold {} bytes by default; live --eyes raw needs {}, png does not",
                      found, kEnough),
          fmt::format("sysctl -w net.core.rmem_max={0} net.core.rmem_default={0}", kEnough)};
}

Finding look_at_priority() {
  const bool works = to_be_had() == Priority::real_time;
  return {"real_time", works,
          works ? "ticks of a live session go before what else runs"
                : "not allowed; on a busy machine ticks of a live session begin late",
          "echo '* - rtprio 1' > /etc/security/limits.d/headpin.conf && exec su - $USER"};
}

/// Draws a small plot as PNG and as PDF.
Finding look_at_plots() {
  try {
    const std::string& versions = rsvg().versions;
    for (const char* name : {"plot.png", "plot.pdf"}) {
      plot_file("<svg xmlns='http://www.w3.org/2000/svg' width='2' height='2'/>", name);
    }
    return {"librsvg", true, versions, ""};
  } catch (const std::runtime_error& error) {
    return {"librsvg", false, fmt::format("{}; needed only for plots as PNG or PDF", error.what()),
            "apt-get install librsvg2-2"};
  }
}

/// @param users  what needs it
Finding look_for_program(const char* name, const char* package, const char* users) {
  const char* path = std::getenv("PATH");
  std::string_view rest = path ? path : "";
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    const std::string candidate = fmt::format("{}/{}", rest.substr(0, colon), name);
    if (access(candidate.c_str(), X_OK) == 0) return {name, true, candidate, ""};
    rest = colon == std::string_view::npos ? "" : rest.substr(colon + 1);
  }
  return {name, false, fmt::format("not installed; needed only for {}", users),
          fmt::format("apt-get install {}", package)};
}

void diagnose(bool json, const std::string& gl) {
  const std::vector<Finding> devices = look_at_devices();  // before libEGL is limited to Mesa
  std::vector<Finding> findings = look_at_contexts(gl);
  findings.insert(findings.end(), devices.begin(), devices.end());
  for (const Finding& finding :
       {look_at_multicast(), look_at_receive_buffer(), look_at_priority(), look_at_plots(),
        look_for_program("ffmpeg", "ffmpeg", "videos"),
        look_for_program("Rscript", "r-base-core", "`experiment analyse`")}) {
    findings.push_back(finding);
  }
  nlohmann::json all = nlohmann::json::object();
  for (const Finding& f : findings) {
    all[f.name] = {{"works", f.works}, {"says", f.says}, {"remedy", f.works ? "" : f.remedy}};
    if (json) continue;
    fmt::print("{:<15}{:<5}{}\n", f.name, f.works ? "ok" : "no", f.says);
    if (!f.works && !f.remedy.empty()) fmt::print("{:<20}type: {}\n", "", f.remedy);
  }
  if (json) print_json(all);
}

}  // namespace

void add_doctor(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  auto gl = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("doctor", "Check what works on this computer");
  add_json(*command, *json);
  add_gl(*command, *gl);
  command->footer(
      "OSMesa or EGL is needed only for pictures, librsvg only for plots as PNG or PDF, ffmpeg "
      "only for videos, R only for `experiment analyse`.\nWithout a multicast route, commands "
      "still work with file:// and memq:// URLs.\n\nExample:\n  headpin doctor");
  command->callback([json, gl] { diagnose(*json, *gl); });
}

}  // namespace headpin::apps
