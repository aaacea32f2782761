#include "render/video.h"

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/temporary.h"
#include "tests/support/folder.h"
#include "tests/support/output_of.h"

namespace headpin::render {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 72, kHeight = 24;

/// Noise on a slope: nothing that a lossy step would leave alone.
Image picture(int number) {
  std::mt19937 random(static_cast<unsigned>(number));
  Image image{kWidth, kHeight, {}};
  for (int i = 0; i < 3 * kWidth * kHeight; ++i) {
    image.rgb.push_back(
        static_cast<std::uint8_t>(i + 7 * number + static_cast<int>(random() % 64)));
  }
  return image;
}

std::string told(const fs::path& video, const std::string& entries) {
  return output_of("ffprobe -v error -show_entries " + entries + " -of default=nw=1 " +
                   video.string());
}

class Video : public testing::Test {
 protected:
  fs::path file() const { return folder_ / "stereo.mkv"; }
  fs::path copy() const { return folder_ / "stereo.mp4"; }

  /// Puts a program of that name and text before all others.
  void stand_in_for_ffmpeg(const std::string& script) {
    fs::create_directory(folder_ / "bin");
    const fs::path program = folder_ / "bin" / "ffmpeg";
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(program, fs::perms::owner_all);
    const std::string path = (folder_ / "bin").string() + ":" + std::getenv("PATH");
    setenv("PATH", path.c_str(), 1);
  }

  std::size_t files() const {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder_)) count += entry.is_regular_file();
    return count;
  }

  fs::path folder_ = fresh_folder("video");
};

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST_F(Video, DecodesFrameByFrameToThePicturesPutIn) {
  constexpr int kPictures = 30;
  VideoWriter video(open_video(file()), kWidth, kHeight, 60, 1.405);
  for (int i = 0; i < kPictures; ++i) video.add(picture(i));
  video.close();
  const std::string bytes =
      output_of("ffmpeg -v error -i " + file().string() + " -f rawvideo -pix_fmt rgb24 -");
  const std::size_t size = std::size_t{3} * kWidth * kHeight;
  ASSERT_EQ(bytes.size(), kPictures * size);
  for (int i = 0; i < kPictures; ++i) {
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(size) * i;
    const Image decoded{kWidth, kHeight, {first, first + static_cast<std::ptrdiff_t>(size)}};
    EXPECT_EQ(pixel_hash(decoded), pixel_hash(picture(i))) << i;
  }
  EXPECT_EQ(files(), 2u);
}

TEST_F(Video, TellsItsRateItsPixelAspectAndThatItIsStereo) {
  VideoWriter video(open_video(file()), kWidth, kHeight, 60, 1.405);
  for (int i = 0; i < 12; ++i) video.add(picture(i));
  video.close();
  const std::string about =
      told(file(), "stream=sample_aspect_ratio,r_frame_rate:stream_tags=stereo_mode");
  int over = 0, under = 1;
  ASSERT_EQ(std::sscanf(about.c_str(), "sample_aspect_ratio=%d:%d", &over, &under), 2) << about;
  // Matroska keeps how wide one eye is shown, in whole pixels.
  EXPECT_NEAR(1.0 * over / under, 1.405, 1.0 / (kWidth / 2));
  EXPECT_THAT(about, testing::HasSubstr("r_frame_rate=60/1"));
  EXPECT_THAT(about, testing::HasSubstr("stereo_mode=left_right"));
}

TEST_F(Video, HasACopyThatPlaysAnywhere) {
  VideoWriter video(open_video(file()), kWidth, kHeight, 60, 1.405);
  for (int i = 0; i < 12; ++i) video.add(picture(i));
  video.close();
  const std::string about =
      told(copy(), "stream=codec_name,pix_fmt,width,height,sample_aspect_ratio,nb_frames");
  EXPECT_THAT(about, testing::HasSubstr("codec_name=h264"));
  EXPECT_THAT(about, testing::HasSubstr("pix_fmt=yuv420p"));
  EXPECT_THAT(about, testing::HasSubstr("sample_aspect_ratio=1:1"));
  EXPECT_THAT(about, testing::HasSubstr("nb_frames=12"));
  EXPECT_THAT(about, testing::HasSubstr("width=1012"));  // 72 * 10 * 1.405 = 1011.6, made even
  EXPECT_THAT(about, testing::HasSubstr("height=240"));
  // Players that know of stereo find its halves.
  EXPECT_THAT(output_of("ffprobe -v error -show_frames -read_intervals '%+#1' " + copy().string()),
              testing::HasSubstr("side_data_type=Stereo 3D"));
  std::ifstream in(copy(), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));  // a player can start before all is there
}

// Its encoder takes 16384 pixels at most; the lossless video keeps the pixels as they are.
TEST_F(Video, WhoseCopyWouldBeTooWideSaysSoBeforeItBegins) {
  const std::string said =
      message_of([&] { VideoWriter(open_video(file()), 6000, 24, 60, 1.405); });
  EXPECT_THAT(said, testing::HasSubstr(copy().string()));
  EXPECT_THAT(said, testing::HasSubstr("would have 84300x240 pixels"));  // 6000 * 10 * 1.405
  EXPECT_EQ(files(), 0u);
  VideoWriter alone(open_video(file(), {}, false), 6000, 24, 60, 1.405);
  alone.add({6000, 24, std::vector<std::uint8_t>(std::size_t{3} * 6000 * 24, 99)});
  alone.close();
  EXPECT_EQ(files(), 1u);
}

TEST_F(Video, OfOddSizeIsMade) {
  VideoWriter video(open_video(file()), 33, 17, 60, 1.0);
  video.add({33, 17, std::vector<std::uint8_t>(std::size_t{3} * 33 * 17, 99)});
  video.close();
  EXPECT_THAT(told(copy(), "stream=height"), testing::HasSubstr("height=256"));
}

/// A WAV file of a tone, in a file without a name.
int tone(int samples) {
  const auto number = [](std::uint32_t value, int size) {
    std::string bytes;
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> 8 * i & 0xff);
    return bytes;
  };
  const auto size = static_cast<std::uint32_t>(4 * samples);
  std::string wav = "RIFF" + number(size + 36, 4) + "WAVEfmt " + number(16, 4) + number(1, 2) +
                    number(2, 2) + number(48000, 4) + number(192000, 4) + number(4, 2) +
                    number(16, 2) + "data" + number(size, 4);
  for (int i = 0; i < samples; ++i) {
    wav += number(static_cast<std::uint32_t>(80 * i), 2) + number(static_cast<std::uint32_t>(i), 2);
  }
  const int file = base::nameless_file();
  EXPECT_EQ(write(file, wav.data(), wav.size()), static_cast<ssize_t>(wav.size()));
  return file;
}

TEST_F(Video, HasSoundAsItsSecondStream) {
  const int sound = tone(16000);  // a third of a second
  VideoWriter video(open_video(file()), kWidth, kHeight, 60, 1.405, sound);
  for (int i = 0; i < 20; ++i) video.add(picture(i));
  video.close();
  const std::string heard =
      output_of("ffmpeg -v error -i " + file().string() + " -map 0:a -f s16le -");
  ASSERT_EQ(heard.size(), 64000u);
  for (int i = 0; i < 16000; ++i) {
    std::array<std::int16_t, 2> ears{};
    std::memcpy(ears.data(), heard.data() + 4 * i, 4);
    ASSERT_EQ(ears[0], static_cast<std::int16_t>(80 * i)) << i;
    ASSERT_EQ(ears[1], i) << i;
  }
  for (const fs::path& one : {file(), copy()}) {
    EXPECT_THAT(told(one, "stream=index,codec_type"),
                testing::HasSubstr("index=0\ncodec_type=video\nindex=1\ncodec_type=audio"));
  }
  close(sound);
}

TEST_F(Video, IsNotThereBeforeItIsWhole) {
  {
    VideoWriter video(open_video(file()), kWidth, kHeight, 60, 1.405);
    for (int i = 0; i < 20; ++i) video.add(picture(i));
    EXPECT_FALSE(fs::exists(file()));
    EXPECT_FALSE(fs::exists(copy()));
  }
  EXPECT_EQ(files(), 0u);  // dropped without close()
}

TEST_F(Video, KeepsAFileThatIsThereUnlessForced) {
  std::ofstream(folder_ / "stereo.mp4") << "precious";
  EXPECT_THAT(message_of([&] { VideoWriter(open_video(file()), kWidth, kHeight, 60, 1.405); }),
              testing::HasSubstr("stereo.mp4: exists already"));
  VideoWriter video(open_video(file(), {.overwrite = true}), kWidth, kHeight, 60, 1.405);
  video.add(picture(0));
  video.close();
  EXPECT_GT(fs::file_size(copy()), 8u);
}

TEST_F(Video, WithoutFfmpegSaysSo) {
  fs::create_directory(folder_ / "empty");
  setenv("PATH", (folder_ / "empty").c_str(), 1);
  EXPECT_THAT(message_of([&] { VideoWriter(open_video(file()), kWidth, kHeight, 60, 1.405); }),
              testing::HasSubstr("cannot run ffmpeg"));
  EXPECT_EQ(files(), 0u);
}

TEST_F(Video, PassesOnWhatFfmpegSaysWhenItStopsEarly) {
  stand_in_for_ffmpeg("head -c 1000 >/dev/null; echo \"Unknown encoder 'libx264rgb'\" >&2; exit 1");
  VideoWriter video(open_video(file()), kWidth, kHeight, 60, 1.405);
  const std::string message = message_of([&] {
    for (int i = 0; i < 1000; ++i) video.add(picture(0));
  });
  EXPECT_THAT(message, testing::HasSubstr("Unknown encoder 'libx264rgb'"));
  EXPECT_THAT(message, testing::HasSubstr("stereo.mkv"));
  EXPECT_THAT(message_of([&] { video.add(picture(0)); }),
              testing::HasSubstr("is finished already"));
  EXPECT_EQ(files(), 0u);
}

TEST_F(Video, FailsWhenFfmpegFailsAtTheEnd) {
  stand_in_for_ffmpeg("cat >/dev/null; exit 1");
  VideoWriter video(open_video(file()), kWidth, kHeight, 60, 1.405);
  video.add(picture(0));
  EXPECT_THAT(message_of([&] { video.close(); }), testing::HasSubstr("ffmpeg has stopped"));
  EXPECT_EQ(files(), 0u);
}

TEST_F(Video, FailsWhenFfmpegIsKilled) {
  stand_in_for_ffmpeg("cat >/dev/null; kill -9 $$");
  VideoWriter video(open_video(file()), kWidth, kHeight, 60, 1.405);
  video.add(picture(0));
  EXPECT_THAT(message_of([&] { video.close(); }), testing::HasSubstr("ffmpeg has stopped"));
}

TEST_F(Video, LeavesNothingBehindOnAFullDisk) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{20000, 20000};  // a disk that is full after 20 kB
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  VideoWriter video(open_video(file()), kWidth, kHeight, 60, 1.405);
  const std::string message = message_of([&] {
    for (int i = 0; i < 200; ++i) video.add(picture(i));
    video.close();
  });
  EXPECT_THAT(message, testing::HasSubstr("ffmpeg has stopped: "));
  EXPECT_EQ(files(), 0u);
}

TEST_F(Video, RefusesWhatIsNoVideo) {
  EXPECT_THROW(open_video(folder_ / "stereo.mp4"), std::invalid_argument);
  EXPECT_THROW(VideoWriter(open_video(file()), 0, 24, 60, 1.0), std::invalid_argument);
  EXPECT_THROW(VideoWriter(open_video(file()), 72, 24, 0, 1.0), std::invalid_argument);
  EXPECT_THROW(VideoWriter(open_video(file()), 72, 24, 60, 0.0), std::invalid_argument);
  VideoWriter video(open_video(file()), kWidth, kHeight, 60, 1.0);
  EXPECT_THROW(video.add({2, 2, std::vector<std::uint8_t>(12)}), std::invalid_argument);
  EXPECT_THROW(video.close(), std::runtime_error);  // no pictures
  EXPECT_EQ(files(), 0u);
}

}  // namespace
}  // namespace headpin::render
