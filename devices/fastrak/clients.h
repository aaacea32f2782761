#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "devices/fastrak/codec.h"
#include "engine/math.h"

/// What programs that read a Fastrak send it, byte for byte, and what each needs to go on.
///
/// From their sources: VRPN, Vrui, VR Juggler (2006 and 2007), VESS, COVISE, cybergarage, Georgia
/// Tech's daemon and the ROS node made of it, Nontrivial Solutions' serial driver, pylhemus, LINA,
/// BoardLab, FreeVR, and a ROS 2 node that only listens.
namespace headpin::devices {

/// A client's end of the line to a unit.
class FastrakLine {
 public:
  virtual ~FastrakLine() = default;
  void send(std::string_view text) {
    sent_ = text;
    put(text);
  }
  /// What was sent last.
  const std::string& sent() const { return sent_; }
  /// Lets time pass and hands over all that came; no more of it once there is `enough`.
  virtual std::string wait(Time span, std::size_t enough = std::string::npos) = 0;
  /// Throws away what came up to now, as tcflush does.
  virtual void flush() = 0;
  virtual int baud() const { return 115200; }

  std::string ask(std::string_view text, Time span, std::size_t enough = std::string::npos) {
    send(text);
    return wait(span, enough);
  }

 private:
  virtual void put(std::string_view text) = 0;

  std::string sent_;
};

/// One thing that a client needs.
struct FastrakDemand {
  std::string sent;  ///< the last bytes before it, for people
  std::string what;
  bool met = false;
  std::string found;  ///< where it is not met
};

/// Bytes for people: how many, and what they are.
std::string shown_bytes(std::string_view bytes);

struct FastrakClient {
  std::string_view name;
  int least_stations;  ///< that it cannot do without
  /// Its start-up, at a unit in its factory's set-up with so many receivers, from station 1 on.
  void (*start)(FastrakLine& line, int stations, std::vector<FastrakDemand>& demands);
  /// What it wants of the unit then: records as they come, or those that this byte asks for.
  std::string_view poll;
  /// Records of station 1, and of each other one.
  FastrakFormat first, others;
  bool only_last = false;  ///< it switches off all stations but the last
};

std::span<const FastrakClient> fastrak_clients();

/// Whether the unit is one at all, and what it reads: each position in inches, in centimetres and
/// in binary, which must be the same place. Its receivers may move by what they do in a second.
///
/// @return  how many receivers it has, from station 1 on; 0 when it does not say so
int examine_readings(FastrakLine& line, std::vector<FastrakDemand>& demands);

/// Takes a stream apart as the clients do: records of fixed lengths, each `0`, station, blank, and
/// what ends it in its place; the stations in turn. Adds what they need of it.
///
/// @param stream  from the head of a record on; it may end in the middle of one
/// @return        the records
std::vector<FastrakRecord> take_apart(const FastrakClient& client, int stations,
                                      std::string_view stream, std::vector<FastrakDemand>& demands);

/// Start-up of a client and so much of its records.
std::vector<FastrakRecord> run_client(const FastrakClient& client, FastrakLine& line, int stations,
                                      Time span, std::vector<FastrakDemand>& demands);

}  // namespace headpin::devices
