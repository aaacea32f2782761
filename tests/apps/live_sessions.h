#pragma once

#include <cstdlib>
#include <fstream>
#include <string>

#include "scene/record/log.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"
#include "tests/apps/command_line.h"

namespace headpin {

inline const Vec3 kBehind(-0.5, 0.3, 0.2);  // p_TS

/// Sessions run by shell scripts that wait for what they need.
class Sessions : public CommandLine {
 protected:
  Result shell(const std::string& script, const std::string& wrapper = "") const {
    std::ofstream(folder_ / "script.sh")
        << "headpin=" HEADPIN_PROGRAM "\n"
        << "size() { stat -c %s \"$1\" 2>/dev/null || echo 0; }\n"
        << "written() { for i in $(seq 3000); do test $(size $1) -ge $2 && break; sleep 0.02; "
           "done; }\n"                                          // FILE, BYTES
        << "count() { grep -ao $2 $1 2>/dev/null | wc -l; }\n"  // FILE, WORD
        // PROCESS, FILE, WORD, COUNT: until there are so many, or the process is no more
        << "counted() { while kill -0 $1 && [ $(count $2 $3) -lt $4 ]; do sleep 0.1; done; }\n"
        << "there() { while kill -0 $1 && ! [ -e $2 ]; do sleep 0.02; done; }\n"  // PROCESS, FILE
        << "interrupt() { kill -INT $1; wait $1; }\n"
        << script << "\n";
    const std::string command = "cd '" + folder_.string() + "' && " + wrapper +
                                " sh script.sh >out.txt 2>err.txt </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + status, slurp(folder_ / "out.txt"),
            slurp(folder_ / "err.txt")};
  }

  /// Records a session with an emulated Fastrak until it has so many samples.
  ///
  /// @param feed  of the unit
  static std::string fastrak_session(const std::string& feed, const std::string& options,
                                     int samples) {
    return "rm -f live.lcmlog\n$headpin emulate " + feed +
           " --link unit --faults noise=0 --stylus &\nunit=$!\nthere $unit unit\n"
           "publish\n"
           "$headpin live --fastrak unit --record live.lcmlog --eyes none " +
           options + " &\nlive=$!\ncounted $live live.lcmlog TRACKER " + std::to_string(samples) +
           "\ninterrupt $live; code=$?\ninterrupt $unit\nexit $code";
  }

  /// A trial of a head and a hand at rest, the hand behind the transmitter.
  void record_hand_behind() const {
    devices::TrackerSample head, hand;
    head.X_TS.p = Vec3(0.8, 0.1, -0.6);
    hand.station = devices::kHandStation;
    hand.X_TS.p = kBehind;
    scene::TrialHeader header;
    header.scenario = scene::to_toml(scene::Scenario{});
    scene::Recorder recorder(folder_ / "behind.lcmlog", header);
    recorder.write(head);
    recorder.write(hand);
    recorder.close();
  }

  void take_room_of_demo() {
    ASSERT_EQ(headpin("info " + kDemo + " --scenario").code, 0);
    fs::copy(folder_ / "out.txt", folder_ / "room.toml");
  }

  scene::Trial trial(const std::string& name) const { return scene::read_trial(folder_ / name); }
};

}  // namespace headpin
