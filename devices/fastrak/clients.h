#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "devices/fastrak/asking.h"
#include "devices/fastrak/codec.h"

/// The bytes that known client programs send to a Fastrak, and the answers that each needs.
///
/// From their sources: VRPN, Vrui, VR Juggler (2006 and 2007), VESS, COVISE, cybergarage, Georgia
/// Tech's daemon and the ROS node made of it, Nontrivial Solutions' serial driver, pylhemus, LINA,
/// BoardLab, FreeVR, and a ROS 2 node that only listens.
namespace headpin::devices {

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
