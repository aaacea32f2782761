#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "devices/fastrak/codec.h"

/// The bytes that known client programs send to a Fastrak, and the answers that each needs.
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
  /// The bytes that were sent last.
  const std::string& sent() const { return sent_; }
  /// Waits and returns all received bytes, until there are `enough`.
  virtual std::string wait(Time span, std::size_t enough = std::string::npos) = 0;
  /// Discards the bytes received so far, like tcflush.
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

/// One requirement of a client.
struct FastrakDemand {
  std::string sent;  ///< the last bytes that were sent before, as text
  std::string what;
  bool met = false;
  std::string found;  ///< what was found instead
};

/// Bytes as text: their number and values.
std::string shown_bytes(std::string_view bytes);

struct FastrakClient {
  std::string_view name;
  int least_stations;  ///< smallest number of receivers that it needs
  /// Its start-up, with a unit in factory settings and this number of receivers, from station 1.
  void (*start)(FastrakLine& line, int stations, std::vector<FastrakDemand>& demands);
  /// How it gets records afterwards: continuously, or by sending this byte.
  std::string_view poll;
  /// Records of station 1, and of each other one.
  FastrakFormat first, others;
  bool only_last = false;  ///< it switches off all stations except the last
};

std::span<const FastrakClient> fastrak_clients();

/// Checks that the unit is a Fastrak, and that its poses agree in all forms: inches and centimetres,
/// ASCII and binary, angles, quaternion, direction cosines and extended precision, up to the motion
/// of a receiver between two readings.
///
/// @return  number of receivers, from station 1; 0 if the unit does not report it
int examine_readings(FastrakLine& line, std::vector<FastrakDemand>& demands);

/// Parses a stream as the clients do: records of fixed lengths, each with `0`, station, blank, and
/// its end; the stations in turn. Adds the requirements of the clients.
///
/// @param stream  from the start of a record; it may end within a record
/// @return        the records
std::vector<FastrakRecord> take_apart(const FastrakClient& client, int stations,
                                      std::string_view stream, std::vector<FastrakDemand>& demands);

/// Start-up of a client, and records for this time.
std::vector<FastrakRecord> run_client(const FastrakClient& client, FastrakLine& line, int stations,
                                      Time span, std::vector<FastrakDemand>& demands);

}  // namespace headpin::devices
