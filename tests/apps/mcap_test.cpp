// Trials as MCAP: the file is read by a small reader of its own, its messages by the library of Protocol Buffers.

#include <cstring>
#include <map>
#include <optional>

#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <zlib.h>
#include <zstd.h>

#include "tests/apps/command_line.h"
#include "tests/apps/rewritten.h"
#include "tests/apps/two_versions.h"
#include "tests/support/csv_rows.h"

namespace headpin {
namespace {

namespace pb = google::protobuf;

/// Numbers and strings from bytes, in their order.
struct Bytes {
  std::string_view left;

  std::string_view take(std::size_t size) {
    EXPECT_LE(size, left.size());
    const std::string_view taken = left.substr(0, size);
    left.remove_prefix(taken.size());
    return taken;
  }
  template <typename T>
  T number() {
    T value{};
    const std::string_view raw = take(sizeof value);
    std::memcpy(&value, raw.data(), raw.size());
    return value;
  }
  std::string_view sized() { return take(number<std::uint32_t>()); }
};

struct McapRecord {
  int op = 0;
  std::string_view content;
};

McapRecord next_record(Bytes& bytes) {
  const int op = bytes.number<std::uint8_t>();
  return {op, bytes.take(bytes.number<std::uint64_t>())};
}

struct McapMessage {
  std::string topic;
  std::uint64_t log_ns = 0;
  std::string data;
};

std::uint32_t crc_of_bytes(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// All messages of a file, read forward; its checksums hold.
struct ReadMcap {
  explicit ReadMcap(std::string file) : bytes(std::move(file)) {
    Bytes all{bytes};
    EXPECT_EQ(all.take(8), kMcapBegin);
    while (!all.left.empty() && all.left != kMcapBegin) {
      const std::size_t at = bytes.size() - all.left.size();
      const auto [op, content] = next_record(all);
      if (op == 6) read_chunk({content});
      if (op == 15) {
        EXPECT_EQ(Bytes{content}.number<std::uint32_t>(),
                  crc_of_bytes(std::string_view(bytes).substr(0, at)));
      }
      if (op == 2) check_footer({content}, at);
    }
    EXPECT_EQ(all.left, kMcapBegin);
  }

  void check_footer(Bytes footer, std::size_t at) {
    const auto summary = footer.number<std::uint64_t>();
    footer.number<std::uint64_t>();
    constexpr std::size_t kBeforeCrc = 1 + 3 * 8;  // kind, length, two places
    EXPECT_EQ(footer.number<std::uint32_t>(),
              crc_of_bytes(std::string_view(bytes).substr(summary, at + kBeforeCrc - summary)));
    has_footer = true;
  }

  void read_chunk(Bytes chunk) {
    chunk.take(16);
    std::string records(chunk.number<std::uint64_t>(), '\0');
    const auto crc = chunk.number<std::uint32_t>();
    EXPECT_EQ(chunk.sized(), "zstd");
    const std::string_view packed = chunk.take(chunk.number<std::uint64_t>());
    ASSERT_EQ(ZSTD_decompress(records.data(), records.size(), packed.data(), packed.size()),
              records.size());
    EXPECT_EQ(crc, crc_of_bytes(records));
    for (Bytes inside{records}; !inside.left.empty();) read(next_record(inside));
  }

  void read(const McapRecord& record) {
    Bytes content{record.content};
    if (record.op == 3) {
      const auto id = content.number<std::uint16_t>();
      const std::string_view name = content.sized(), encoding = content.sized();
      if (encoding != "protobuf") return;
      pb::FileDescriptorSet set;
      const std::string_view data = content.sized();
      ASSERT_TRUE(set.ParseFromArray(data.data(), static_cast<int>(data.size())));
      for (const pb::FileDescriptorProto& file : set.file()) {
        if (pool->FindFileByName(file.name())) continue;
        ASSERT_TRUE(pool->BuildFile(file));
      }
      types[id] = std::string(name);
    } else if (record.op == 4) {
      const auto id = content.number<std::uint16_t>();
      const auto schema = content.number<std::uint16_t>();
      topics[id] = std::string(content.sized());
      if (types.contains(schema)) type_of_topic[topics[id]] = types[schema];
    } else if (record.op == 5) {
      const auto channel = content.number<std::uint16_t>();
      content.number<std::uint32_t>();
      const auto time = content.number<std::uint64_t>();
      content.number<std::uint64_t>();
      messages.push_back({topics.at(channel), time, std::string(content.left)});
    }
  }

  /// A message, decoded by the schema in the file.
  std::unique_ptr<pb::Message> decoded(const McapMessage& message) {
    const pb::Descriptor* type = pool->FindMessageTypeByName(type_of_topic.at(message.topic));
    std::unique_ptr<pb::Message> out(factory->GetPrototype(type)->New());
    EXPECT_TRUE(out->ParseFromString(message.data)) << message.topic;
    EXPECT_TRUE(out->GetReflection()->GetUnknownFields(*out).empty()) << message.topic;
    return out;
  }

  static constexpr std::string_view kMcapBegin{"\x89MCAP0\r\n", 8};
  std::string bytes;
  bool has_footer = false;
  std::unique_ptr<pb::DescriptorPool> pool = std::make_unique<pb::DescriptorPool>();
  std::unique_ptr<pb::DynamicMessageFactory> factory =
      std::make_unique<pb::DynamicMessageFactory>(pool.get());
  std::map<std::uint16_t, std::string> types, topics;
  std::map<std::string, std::string> type_of_topic;
  std::vector<McapMessage> messages;
};

const pb::FieldDescriptor* field(const pb::Message& message, const std::string& name) {
  return message.GetDescriptor()->FindFieldByName(name);
}
const pb::Message& part(const pb::Message& message, const std::string& name) {
  return message.GetReflection()->GetMessage(message, field(message, name));
}
double number(const pb::Message& message, const std::string& name) {
  return message.GetReflection()->GetDouble(message, field(message, name));
}
std::string text(const pb::Message& message, const std::string& name) {
  return message.GetReflection()->GetString(message, field(message, name));
}
std::int64_t microseconds_of(const pb::Message& message) {
  const pb::Message& stamp = part(message, "timestamp");
  const auto* reflection = stamp.GetReflection();
  return reflection->GetInt64(stamp, field(stamp, "seconds")) * 1'000'000 +
         reflection->GetInt32(stamp, field(stamp, "nanos")) / 1000;
}

class Mcap : public CommandLine {
 protected:
  Mcap() {
    EXPECT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
    EXPECT_EQ(headpin("export game.lcmlog -o tables").code, 0);
    EXPECT_EQ(headpin("export game.lcmlog --mcap game.mcap").code, 0);
  }
  std::vector<std::map<std::string, std::string>> rows(const std::string& table) const {
    return csv_rows(slurp(folder_ / "tables" / table));
  }
};

std::int64_t microseconds_in(const std::map<std::string, std::string>& row) {
  return std::llround(1e6 * std::stod(row.at("time_s")));
}

TEST_F(Mcap, EveryBodyIsWhereTheTableOfStatesHasItToTheLastBit) {
  ReadMcap mcap(slurp(folder_ / "game.mcap"));
  EXPECT_TRUE(mcap.has_footer);
  std::map<std::pair<std::int64_t, std::string>, std::map<std::string, std::string>> states;
  for (const auto& row : rows("states.csv")) states[{microseconds_in(row), row.at("body")}] = row;
  std::size_t compared = 0;
  for (const McapMessage& message : mcap.messages) {
    if (message.topic != "/tf") continue;
    const auto transforms = mcap.decoded(message);
    const auto* reflection = transforms->GetReflection();
    const auto* list = field(*transforms, "transforms");
    for (int i = 0; i < reflection->FieldSize(*transforms, list); ++i) {
      const pb::Message& one = reflection->GetRepeatedMessage(*transforms, list, i);
      EXPECT_EQ(static_cast<std::uint64_t>(1000 * microseconds_of(one)), message.log_ns);
      const auto found = states.find({microseconds_of(one), text(one, "child_frame_id")});
      if (found == states.end()) continue;
      const pb::Message &place = part(one, "translation"), &turn = part(one, "rotation");
      for (const char* axis : {"x", "y", "z"}) {
        EXPECT_EQ(number(place, axis), std::stod(found->second.at(std::string(axis) + "_m")));
      }
      for (const char* axis : {"x", "y", "z", "w"}) {
        EXPECT_EQ(number(turn, axis), std::stod(found->second.at(std::string("q") + axis)));
      }
      ++compared;
    }
  }
  EXPECT_EQ(compared, 1682u * 11u);  // every tick; the ball and ten skittles
}

TEST_F(Mcap, SkittlesHaveTheShapeOfTheVersionThatIsPlayed) {
  write_two_versions(folder_ / "versions.lcmlog");
  ASSERT_EQ(headpin("export versions.lcmlog --mcap versions.mcap").code, 0);
  ReadMcap mcap(slurp(folder_ / "versions.mcap"));
  std::vector<std::pair<double, std::size_t>> shapes;  // of a skittle: from when, how long
  for (const McapMessage& message : mcap.messages) {
    if (message.topic != "/scene") continue;
    const auto update = mcap.decoded(message);
    const auto* reflection = update->GetReflection();
    const auto* list = field(*update, "entities");
    for (int i = 0; i < reflection->FieldSize(*update, list); ++i) {
      const pb::Message& entity = reflection->GetRepeatedMessage(*update, list, i);
      if (text(entity, "id") != "skittle 1") continue;
      shapes.emplace_back(1e-9 * static_cast<double>(message.log_ns), entity.ByteSizeLong());
    }
  }
  ASSERT_EQ(shapes.size(), 2u);
  EXPECT_EQ(shapes[0].first, 0.0);
  EXPECT_NEAR(shapes[1].first, kTouchesBlue, 0.05);
  EXPECT_NE(shapes[0].second, shapes[1].second);
}

/// The table without its last column, whose cells can have commas; and without the rows that say how the
/// recording ended, which are in lcm/EVENT.
std::string events_without_detail(const std::string& table) {
  constexpr int kCommas = 11;  // before the detail
  std::istringstream lines(table);
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    if (line.find(",ledger,") != line.npos || line.find(",game_hash,") != line.npos) continue;
    std::size_t end = 0;
    for (int i = 0; i < kCommas; ++i) end = line.find(',', end) + 1;
    out += line.substr(0, end - 1) + "\n";
  }
  return out;
}

TEST_F(Mcap, EveryMessageIsOfItsSchemaAndEveryEventIsThere) {
  ReadMcap mcap(slurp(folder_ / "game.mcap"));
  const auto events = csv_rows(events_without_detail(slurp(folder_ / "tables/events.csv")));
  std::size_t next = 0;
  for (const McapMessage& message : mcap.messages) {
    if (!mcap.type_of_topic.contains(message.topic)) continue;
    const auto decoded = mcap.decoded(message);
    if (message.topic != "/events") continue;
    ASSERT_LT(next, events.size());
    EXPECT_EQ(text(*decoded, "name"), events[next].at("kind"));
    EXPECT_EQ(microseconds_of(*decoded), microseconds_in(events[next]));
    EXPECT_EQ(nlohmann::json::parse(text(*decoded, "message"))["value"].get<double>(),
              std::stod(events[next].at("value")));
    ++next;
  }
  EXPECT_EQ(next, events.size());
}

TEST_F(Mcap, EventsThatNoSimulationMakesAreThereToo) {
  const auto events_of = [&](const std::string& name) {
    ReadMcap mcap(slurp(folder_ / name));
    std::vector<std::pair<std::string, std::int64_t>> events;
    for (const McapMessage& message : mcap.messages) {
      if (message.topic != "/events") continue;
      const auto decoded = mcap.decoded(message);
      events.emplace_back(text(*decoded, "name"), microseconds_of(*decoded));
    }
    return events;
  };
  rewrite_trial(folder_ / "game.lcmlog", folder_ / "live.lcmlog", add_told_live);
  ASSERT_EQ(headpin("export live.lcmlog --mcap live.mcap").code, 0);
  auto live = events_of("live.mcap");
  EXPECT_EQ(std::erase(live, std::pair<std::string, std::int64_t>("drawn_by", 0)), 1u);
  EXPECT_EQ(std::erase(live, std::pair<std::string, std::int64_t>("source_amiss", 2'500'000)), 1u);
  EXPECT_EQ(live, events_of("game.mcap"));
}

TEST_F(Mcap, TheMessagesOfTheLogAreCopied) {
  ReadMcap mcap(slurp(folder_ / "game.mcap"));
  std::map<std::string, std::pair<std::int64_t, std::size_t>> found;
  for (const McapMessage& message : mcap.messages) {
    if (!message.topic.starts_with("lcm/")) continue;
    auto& [count, size] = found[message.topic.substr(4)];
    ++count;
    size += message.data.size();
  }
  const nlohmann::json channels = json("info --json game.lcmlog")["channels"];
  EXPECT_EQ(found.size(), channels.size());
  for (const auto& [name, channel] : channels.items()) {
    EXPECT_EQ(found[name].first, channel["messages"]) << name;
    EXPECT_EQ(found[name].second, channel["bytes"]) << name;
  }
}

TEST_F(Mcap, EqualTrialsGiveEqualBytes) {
  EXPECT_EQ(headpin("export game.lcmlog --mcap again.mcap").code, 0);
  EXPECT_EQ(slurp(folder_ / "again.mcap"), slurp(folder_ / "game.mcap"));
}

// Pixels of the bundled trial's display are wider than high: 14055 of them are as wide as 10000 are high.
TEST_F(Mcap, PicturesSayTheShapeOfTheirPixelsAsTheFilesOfFramesDo) {
  const auto pixels_of = [](const std::string& png) {
    const std::size_t at = png.find("pHYs");
    return at == std::string::npos ? "" : png.substr(at + 4, 8);
  };
  std::ofstream(folder_ / "cut.lcmlog") << slurp(kDemo).substr(0, 32000);
  ASSERT_EQ(headpin("export cut.lcmlog --mcap cut.mcap --eyes").code, 0);
  ASSERT_EQ(headpin("frames cut.lcmlog -o eyes --frames 0").code, 0);
  const std::string expected = pixels_of(slurp(folder_ / "eyes/left_000000.png"));
  ASSERT_EQ(expected.size(), 8u);
  EXPECT_NE(expected.substr(0, 4), expected.substr(4));
  int pictures = 0;
  for (const McapMessage& message : ReadMcap(slurp(folder_ / "cut.mcap")).messages) {
    if (message.topic != "/left_eye/image") continue;
    EXPECT_EQ(pixels_of(message.data), expected);
    ++pictures;
  }
  EXPECT_GT(pictures, 0);
}

TEST_F(Mcap, ATrialThatWasCutIsWrittenAsFarAsItGoes) {
  std::ofstream(folder_ / "cut.lcmlog") << slurp(kDemo).substr(0, 60000);
  const Result cut = headpin("export cut.lcmlog --mcap cut.mcap");
  EXPECT_EQ(cut.code, 0);
  EXPECT_THAT(cut.err, testing::HasSubstr("is incomplete"));
  EXPECT_TRUE(ReadMcap(slurp(folder_ / "cut.mcap")).has_footer);
}

// Else /tf would contradict lcm/STATE in the same file.
TEST_F(Mcap, ATrialThatIsSimulatedOtherwiseThanItsStatesIsRefused) {
  rewrite_trial(folder_ / "game.lcmlog", folder_ / "other.lcmlog",
                [](scene::Trial& trial) { change_states_from(1000, trial); });
  expect_refusal("export other.lcmlog --mcap OUT.mcap", 1,
                 "other.lcmlog: tick 1000 (4.166666 s) of the replay differs from the recording");
}

TEST_F(Mcap, ExistingFilesAndWrongUseAreRefused) {
  expect_refusal("export game.lcmlog --mcap game.mcap", 1, "exists already");
  expect_refusal("export game.lcmlog --mcap OUT.mcap --gltf OUT.glb", 2, "--mcap FILE.mcap");
  expect_refusal("export game.lcmlog -o OUT --eyes", 2, "--eyes needs --mcap");
}

}  // namespace
}  // namespace headpin
