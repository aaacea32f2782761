#pragma once

#include "base/math.h"
#include "devices/base/sample.h"
#include "devices/fastrak/emulator.h"
#include "devices/lines/byte_stream.h"

namespace headpin::devices {

/// The time from `now` on at which a recording should begin, so that the unit's cycles coincide
/// with its samples.
///
/// Measurements between the samples change the throw: for the bundled trial, the release speed by
/// some centimetres per second, and 6 to 10 skittles fall instead of 9. If the stations' turns allow it, the
/// recording begins a multiple of three cycles after the first record. That is a whole number of
/// microseconds, so all times of a recording from a real unit are shifted by the same amount.
///
/// @param first  measurement in the recording
Time begin_of(const TrackerSample& first, const FastrakEmulator& emulator, Time now);

/// Passes bytes from the stream to the emulator and back. To be called about every millisecond,
/// which determines the timing of the bytes. Takes at most 4096 bytes of the stream in one call, so
/// that it comes to an end whatever a client sends.
void serve(FastrakEmulator& emulator, ByteStream& stream, Time now);

}  // namespace headpin::devices
