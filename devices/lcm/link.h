#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/output_file.h"
#include "devices/base/sample.h"
#include "devices/lcm/url.h"
#include "devices/lcm/viewer_messages.h"

/// Publishes samples and other messages over LCM.
namespace headpin::devices {

/// A connection to LCM by the provider of its URL: udpm, memq, tcpq, or file for a log that is
/// written. LogSource plays one.
class LcmLink {
 public:
  /// A log that is written, file://PATH?mode=w, is a new file, there from the start.
  ///
  /// @param prefix  before the channels of a trial's messages
  /// @throws std::runtime_error  when LCM cannot be opened there, or a log is to be read
  explicit LcmLink(LcmUrl url, std::string_view prefix = "");
  /// @param url  as LcmUrl takes it
  /// @throws std::invalid_argument  for a wrong URL
  explicit LcmLink(const std::string& url, std::string_view prefix = "");
  /// Writes a log. @param log  of the URL, open and empty
  LcmLink(LcmUrl url, base::OutputFile log);
  ~LcmLink();
  LcmLink(const LcmLink&) = delete;
  LcmLink& operator=(const LcmLink&) = delete;

  /// @throws std::runtime_error  when it cannot be sent, as over multicast without a route
  void publish(const Sample& sample);

  /// Any other message, on `channel` behind the prefix.
  void publish(std::string_view channel, std::span<const std::uint8_t> bytes);

  /// For Drake's viewer, and for programs that show the eyes' pictures.
  void publish(std::span<const ViewerLink> links);
  void publish(Time time, std::span<const ViewerPose> poses);
  void publish(const EyePictures& eyes);

  /// bot_core's rigid_transform_t, for programs that do not know headpin's types.
  void publish_pose(const std::string& channel, Time time, const Pose& pose);

  const LcmUrl& url() const { return url_; }

 private:
  friend class LcmSource;
  struct Lcm;
  class LogWriter;
  std::string named(std::string_view channel) const { return prefix_ + std::string(channel); }
  void send(const std::string& channel, std::span<const std::uint8_t> bytes);

  LcmUrl url_;
  std::string prefix_;
  std::unique_ptr<Lcm> lcm_;  // null if a log is written, without liblcm
  std::unique_ptr<LogWriter> written_;
  std::vector<std::uint8_t> bytes_;  // of the current message
};

}  // namespace headpin::devices
