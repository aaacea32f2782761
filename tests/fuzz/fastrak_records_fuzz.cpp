#include <algorithm>
#include <cstdlib>

#include "devices/fastrak/codec.h"
#include "devices/fastrak/replies.h"

using namespace headpin;

namespace {

const std::vector<std::vector<int>> kLists = {
    {2, 4, 1},     {2, 11, 16, 1},  {52, 61, 50},        {2, 5, 6, 7, 66, 51},
    {0, 3, 54, 0}, {18, 19, 20, 1}, {53, 55, 56, 57, 1}, {}};

}  // namespace

// Whatever a line holds: every byte is either of a record or skipped, in one piece or in several,
// and what was read in binary is written the same. First byte: the format; second: the piece.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2 || size > 4096) return 0;
  const devices::FastrakFormat format{kLists[data[0] & 7u], (data[0] & 8) != 0,
                                      (data[0] & 16) != 0};
  devices::FastrakFormats formats;
  formats.fill(format);
  const std::size_t piece = std::size_t{1} + data[1];
  const devices::Bytes stream(data + 2, size - 2);

  std::size_t read = 0, done = 0, end = 0;
  bool in_step = true;
  while (done < stream.size()) {
    end = std::min(stream.size(), std::max(end, done) + piece);
    const bool no_more = end == stream.size();
    while (done < end) {
      const devices::Bytes rest = stream.subspan(done, end - done);
      const devices::FastrakFound found = devices::find_record(rest, formats, in_step, no_more);
      if (found.skipped + found.length > rest.size()) std::abort();
      if (no_more && found.skipped + found.length == 0) std::abort();
      if (found.length > 0) {
        const devices::Bytes record = rest.subspan(found.skipped, found.length);
        std::vector<std::uint8_t> again;
        devices::encode_record(found.record, format, again);
        if (again.size() != record.size()) std::abort();
        if (format.binary && !std::equal(again.begin(), again.end(), record.begin())) std::abort();
        read += found.length;
      }
      done += found.skipped + found.length;
      in_step = found.length > 0 || (in_step && found.skipped == 0);
      if (found.length == 0) break;
    }
  }
  if (read > stream.size()) std::abort();

  const std::string_view line(reinterpret_cast<const char*>(stream.data()), stream.size());
  if (const auto status = devices::decode_status(line)) {
    if (!devices::decode_status(devices::encode_status(*status))) std::abort();
  }
  if (const auto on = devices::decode_active(line)) {
    if (devices::decode_active(devices::encode_active(1, *on)) != on) std::abort();
  }
  if (const auto list = devices::decode_list(line, 1)) {
    if (devices::decode_list(devices::encode_list(1, *list), 1) != list) std::abort();
  }
  return 0;
}
