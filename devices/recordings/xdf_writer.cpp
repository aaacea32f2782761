#include "devices/recordings/xdf_writer.h"

#include <bit>

#include <fmt/format.h>

namespace headpin::devices {
namespace {

constexpr double kSamplesEvery = 0.5, kOffsetsEvery = 5.0,
                 kBoundaryEvery = 10.0;  // s, LabRecorder's

void put_number(std::uint64_t number, int bytes, std::string& out) {
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(number >> (8 * i) & 0xff);
}

void put_real(double number, std::string& out) {
  put_number(std::bit_cast<std::uint64_t>(number), 8, out);
}

/// A length: the number of its bytes, and these.
void put_length(std::uint64_t length, std::string& out) {
  const int bytes = length < 0x100 ? 1 : length < 0x1'0000'0000 ? 4 : 8;
  put_number(static_cast<std::uint64_t>(bytes), 1, out);
  put_number(length, bytes, out);
}

std::string of_stream(std::size_t stream) {
  std::string id;
  put_number(stream + 1, 4, id);
  return id;
}

constexpr std::string_view kXml = "<?xml version=\"1.0\"?>";

}  // namespace

XdfWriter::XdfWriter(std::function<void(std::string_view)> put, std::string_view about)
    : put_(std::move(put)) {
  put_(kXdfMagic);
  put_chunk(XdfTag::header, fmt::format("{}<info><version>1.0</version>{}</info>", kXml, about));
}

std::size_t XdfWriter::begin(const Stream& stream) {
  std::string channels;
  for (const XdfChannel& channel : stream.channels) {
    channels += fmt::format("<channel><label>{}</label>", xml_escaped(channel.label));
    if (!channel.object.empty()) {
      channels += fmt::format("<object>{}</object>", xml_escaped(channel.object));
    }
    channels += fmt::format("<type>{}</type><unit>{}</unit></channel>", xml_escaped(channel.type),
                            xml_escaped(channel.unit));
  }
  const std::size_t number = states_.size();
  states_.emplace_back();
  states_.back().count.name = stream.name;
  put_chunk(XdfTag::stream,
            of_stream(number) +
                fmt::format("{}<info><name>{}</name><type>{}</type><channel_count>{}"
                            "</channel_count><nominal_srate>0</nominal_srate><channel_format>{}"
                            "</channel_format><source_id>headpin {}</source_id><desc><channels>{}"
                            "</channels>{}</desc></info>",
                            kXml, xml_escaped(stream.name), xml_escaped(stream.type),
                            stream.channels.size(), stream.format, xml_escaped(stream.name),
                            channels, stream.about));
  return number;
}

void XdfWriter::put_chunk(XdfTag tag, std::string_view content) {
  std::string head;
  put_length(content.size() + 2, head);
  put_number(static_cast<std::uint64_t>(tag), 2, head);
  put_(head);
  put_(content);
}

std::string& XdfWriter::begin_sample(std::size_t stream, double time) {
  StreamState& state = states_[stream];
  if (state.count.samples++ == 0) state.first = time;
  state.last = time;
  ++state.waiting_count;
  state.waiting += '\x08';
  put_real(time, state.waiting);
  return state.waiting;
}

void XdfWriter::add(std::size_t stream, double time, std::span<const double> numbers) {
  std::string& out = begin_sample(stream, time);
  for (const double number : numbers) put_real(number, out);
}

void XdfWriter::add(std::size_t stream, double time, std::span<const std::string> words) {
  std::string& out = begin_sample(stream, time);
  for (const std::string& word : words) {
    put_length(word.size(), out);
    out += word;
  }
}

void XdfWriter::put_samples() {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    StreamState& state = states_[i];
    if (state.waiting_count == 0) continue;
    std::string chunk = of_stream(i) + '\x04';
    put_number(state.waiting_count, 4, chunk);
    put_chunk(XdfTag::samples, chunk + state.waiting);
    state.waiting.clear();
    state.waiting_count = 0;
  }
}

void XdfWriter::put_offsets(double time) {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    std::string chunk = of_stream(i);
    put_real(time, chunk);
    put_real(0.0, chunk);
    put_chunk(XdfTag::offset, chunk);
  }
  offsets_.push_back(time);
}

void XdfWriter::advance(double time) {
  if (!begun_) {
    begun_ = true;
    next_offset_ = next_samples_ = time;
    next_boundary_ = time + kBoundaryEvery;
  }
  // After a pause, one is enough.
  if (time >= next_samples_) {
    put_samples();
    next_samples_ = time + kSamplesEvery;
  }
  if (time >= next_offset_) {
    put_offsets(time);
    next_offset_ = time + kOffsetsEvery;
  }
  if (time >= next_boundary_) {
    put_chunk(XdfTag::boundary, kXdfBoundary);
    next_boundary_ = time + kBoundaryEvery;
  }
}

void XdfWriter::put_footer(std::size_t stream) {
  const StreamState& state = states_[stream];
  std::string offsets;
  for (const double time : offsets_) {
    offsets += fmt::format("<offset><time>{}</time><value>0</value></offset>", time);
  }
  put_chunk(XdfTag::footer,
            of_stream(stream) +
                fmt::format("{}<info><first_timestamp>{}</first_timestamp><last_timestamp>{}"
                            "</last_timestamp><sample_count>{}</sample_count><clock_offsets>{}"
                            "</clock_offsets></info>",
                            kXml, state.first, state.last, state.count.samples, offsets));
}

void XdfWriter::finish() {
  put_samples();
  put_chunk(XdfTag::boundary, kXdfBoundary);
  for (std::size_t i = 0; i < states_.size(); ++i) put_footer(i);
}

std::vector<XdfWriter::Count> XdfWriter::counts() const {
  std::vector<Count> all;
  for (const StreamState& state : states_) all.push_back(state.count);
  return all;
}

}  // namespace headpin::devices
