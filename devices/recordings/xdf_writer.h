#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "devices/recordings/xdf_file.h"

namespace headpin::devices {

/// Writes the chunks of an XDF file in the order and with the intervals of LabRecorder.
///
/// The clock of the streams is that of the recorder, so that the clock offsets are 0. Samples are kept for
/// half a second, then they are a chunk.
class XdfWriter {
 public:
  /// What a stream is made of; its samples are irregular, which keeps their times as they are.
  struct Stream {
    std::string name, type, format;  ///< "double64" or "string"
    std::vector<XdfChannel> channels;
    std::string about = {};  ///< more XML for its <desc>
  };

  /// @param put    takes the bytes of the file
  /// @param about  more XML for the header of the file
  XdfWriter(std::function<void(std::string_view bytes)> put, std::string_view about);

  /// All streams begin before the first sample.
  /// @return  number of the stream, from 0
  std::size_t begin(const Stream& stream);

  /// One number or text for each channel; times of a stream do not go back.
  void add(std::size_t stream, double time, std::span<const double> numbers);
  void add(std::size_t stream, double time, std::span<const std::string> words);

  /// Writes what is due at this time [s]: samples, clock offsets every 5 s, a boundary every 10 s. After a
  /// pause, however long, each is written once.
  void advance(double time);

  /// Writes the rest, and the footers.
  void finish();

  struct Count {
    std::string name;
    std::int64_t samples = 0;
  };
  std::vector<Count> counts() const;

 private:
  struct StreamState {
    Count count;
    double first = 0.0, last = 0.0;
    std::string waiting;  ///< samples that are not in a chunk yet
    std::uint32_t waiting_count = 0;
  };
  void put_chunk(XdfTag tag, std::string_view content);
  void put_samples();
  void put_offsets(double time);
  void put_footer(std::size_t stream);
  std::string& begin_sample(std::size_t stream, double time);

  std::function<void(std::string_view)> put_;
  std::vector<StreamState> states_;
  bool begun_ = false;
  std::vector<double> offsets_;  ///< times of the clock offsets [s]
  double next_offset_ = 0.0, next_boundary_ = 0.0, next_samples_ = 0.0;
};

}  // namespace headpin::devices
