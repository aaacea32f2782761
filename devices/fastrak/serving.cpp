#include "devices/fastrak/serving.h"

#include <array>
#include <optional>

namespace headpin::devices {
namespace {

constexpr Time kPiece{50'000};  // no line fills the outbox in this time
constexpr int kMostReads =
    8;  // at once, of 512 bytes: a real line brings 12 bytes in a millisecond

}  // namespace

Time begin_of(const TrackerSample& first, const FastrakEmulator& emulator, Time now) {
  const Time three_cycles = tick_time(3, kFastrakCycleRate);
  const Time wanted = now + first.device_time;
  const std::optional<Time> next = emulator.next_measured(first.station, wanted);
  for (std::optional<Time> at = next; at && *at <= wanted + 4 * three_cycles;
       at = emulator.next_measured(first.station, *at + Time{1})) {
    const Time begin = *at - first.device_time;
    if ((begin - emulator.stream_zero()) % three_cycles == Time{0}) return begin;
  }
  return next.value_or(wanted) - first.device_time;
}

void serve(FastrakEmulator& emulator, ByteStream& stream, Time now) {
  if (stream.renewed()) emulator.taken(emulator.due(emulator.now()).size());
  // After a delay of the server, the bytes that would have left by now are passed on in pieces.
  // They may be more than the outbox can hold, although no reader was late.
  for (Time then = emulator.now() + kPiece; then < now; then += kPiece) {
    emulator.taken(stream.write(emulator.due(then)));
  }
  std::array<std::uint8_t, 512> heard{};
  for (int reads = 0; reads < kMostReads;
       ++reads) {  // the rest waits: records must leave meanwhile
    const std::size_t n = stream.read(heard);
    if (n > 0) emulator.receive(Bytes(heard).first(n), now);
    if (n < heard.size()) break;
  }
  const Bytes due = emulator.due(now);
  if (!due.empty()) emulator.taken(stream.write(due));
}

}  // namespace headpin::devices
