#include "render/image.h"

#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "render/png.h"
#include "render/sample_grid.h"
#include "tests/support/folder.h"
#include "tests/support/output_of.h"

namespace headpin::render {
namespace {

namespace fs = std::filesystem;

std::size_t bytes_of(int width, int height) {
  return 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

Image noise(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  Image image{width, height, std::vector<std::uint8_t>(bytes_of(width, height))};
  for (std::uint8_t& byte : image.rgb) byte = static_cast<std::uint8_t>(random());
  return image;
}

// The offset basis and two vectors of draft-eastlake-fnv: of nothing, of "a", of "foobar".
TEST(PixelHash, IsFnv1a64) {
  EXPECT_EQ(pixel_hash({}), 0xcbf29ce484222325u);
  EXPECT_EQ(pixel_hash({0, 0, {'a'}}), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(pixel_hash({0, 0, {'f', 'o', 'o', 'b', 'a', 'r'}}), 0x85944171f73967e8u);
}

// IEC 61966-2-1: half the light of white has code 255 (1.055 * 0.5^(1/2.4) - 0.055) = 187.5.
/// Samples of a picture of w x h pixels, all of one code.
std::vector<std::uint8_t> samples_of(int w, int h, int n, int code) {
  const SampleGrid grid{n};
  return std::vector<std::uint8_t>(
      std::size_t(4) * static_cast<std::size_t>(grid.width(w, h) * grid.height(w, h)),
      static_cast<std::uint8_t>(code));
}

// Half of the light is not half of the code.
TEST(Average, IsOfTheLightNotOfTheCode) {
  const SampleGrid grid{2};
  std::vector<std::uint8_t> half =
      samples_of(1, 1, 2, 0);  // 3 x 3 samples about the pixel's middle
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      // Whole beneath the middle row, and half of it.
      const int code = j == 0 ? 255 : j == 1 ? 188 : 0;
      std::fill_n(half.begin() + std::ptrdiff_t{4} * (j * grid.width(1, 1) + i), 4,
                  static_cast<std::uint8_t>(code));
    }
  }
  EXPECT_EQ(average(half, 1, 1, 2).rgb, (std::vector<std::uint8_t>{188, 188, 188}));
}

TEST(Average, OfEqualSamplesIsTheSampleForEveryCode) {
  for (int n = 1; n <= 8; ++n) {
    for (int code = 0; code < 256; ++code) {
      const Image image = average(samples_of(3, 2, n, code), 3, 2, n);
      ASSERT_EQ(image.rgb, std::vector<std::uint8_t>(18, static_cast<std::uint8_t>(code))) << n;
    }
  }
}

/// What a pixel of a w x h picture makes of light at a single sample, as a share of its light.
double share_of(int w, int h, int n, int i, int j, int x, int y) {
  std::vector<std::uint8_t> rgba = samples_of(w, h, n, 0);
  std::fill_n(
      rgba.begin() + std::ptrdiff_t{4} * (std::ptrdiff_t{j} * SampleGrid{n}.width(w, h) + i), 4,
      255);
  const Image image = average(rgba, w, h, n);
  const std::uint8_t code = image.rgb[static_cast<std::size_t>(3 * (y * w + x))];
  return static_cast<double>(light_of_codes()[code]) / kFullLight;
}

// A sample stands for the square of the grid that it is in the middle of: each pixel takes of it what
// it covers of that, here counted in 200 x 200 points.
TEST(Average, TakesOfEachSampleWhatItsSquareCoversOfThePixel) {
  for (int n = 2; n <= 4; ++n) {
    const int w = 3, h = 2, x = 1, y = 0, count = n * n + 1;  // the pixel of the upper row's middle
    double whole = 0.0;
    for (int j = 0; j < SampleGrid{n}.height(w, h); ++j) {
      for (int i = 0; i < SampleGrid{n}.width(w, h); ++i) {
        int inside = 0;
        for (int v = 0; v < 200; ++v) {
          for (int u = 0; u < 200; ++u) {
            const double a = i + (u + 0.5) / 200 - h - 0.5 * (n % 2), b = j + (v + 0.5) / 200;
            const double at_x = (n * a + b) / count, at_y = (n * b - a) / count;
            if (std::floor(at_x) == x && std::floor(at_y) == h - 1 - y) ++inside;
          }
        }
        const double share = inside / (200.0 * 200.0 * count);
        whole += share;
        ASSERT_NEAR(share_of(w, h, n, i, j, x, y), share, 0.003) << n << ' ' << i << ' ' << j;
      }
    }
    EXPECT_NEAR(whole, 1.0, 1e-3) << n;
  }
}

TEST(Average, TurnsRowsFromTheBottomIntoRowsFromTheTop) {
  const std::vector<std::uint8_t> rgba{1, 2, 3, 255, 4, 5, 6, 255};  // one column, lower row first
  EXPECT_EQ(average(rgba, 1, 2, 1).rgb, (std::vector<std::uint8_t>{4, 5, 6, 1, 2, 3}));
}

TEST(Average, RefusesABufferOfAnotherSize) {
  EXPECT_THROW(average(std::vector<std::uint8_t>(35), 1, 1, 2), std::invalid_argument);
  EXPECT_THROW(average({}, 0, 0, 2), std::invalid_argument);
}

TEST(SideBySide, KeepsTheLeftEyeOnTheLeftInEveryRow) {
  const Image left = noise(3, 5, 1), right = noise(4, 5, 2);
  const Image both = side_by_side(left, right);
  ASSERT_EQ(both.width, 7);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) {
      const Image& eye = x < 3 ? left : right;
      const int at = x < 3 ? x : x - 3;
      for (int c = 0; c < 3; ++c) {
        const auto of_both = static_cast<std::size_t>(3 * (y * 7 + x) + c);
        const auto of_eye = static_cast<std::size_t>(3 * (y * eye.width + at) + c);
        ASSERT_EQ(both.rgb[of_both], eye.rgb[of_eye]);
      }
    }
  }
  EXPECT_THROW(side_by_side(left, noise(3, 4, 3)), std::invalid_argument);
}

TEST(Png, ReadsBackAsItWasWritten) {
  const fs::path folder = fresh_folder("image");
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{360, 240}, std::pair{7, 3}}) {
    const Image image = noise(width, height, 5);
    write_png(folder / "image.png", image, 1.405);
    EXPECT_EQ(read_png(folder / "image.png"), image);
  }
  fs::remove_all(folder);
}

// ffmpeg has its own decoder.
TEST(Png, IsTheSamePictureToAnIndependentDecoder) {
  const fs::path folder = fresh_folder("image");
  const Image image = noise(36, 24, 7);
  write_png(folder / "image.png", image, 1.405);
  const std::string file = (folder / "image.png").string();
  const std::string rgb = output_of("ffmpeg -v error -xerror -err_detect crccheck+explode -i " +
                                    file + " -f rawvideo -pix_fmt rgb24 -");
  EXPECT_EQ(std::vector<std::uint8_t>(rgb.begin(), rgb.end()), image.rgb);
  fs::remove_all(folder);
}

// pHYs holds pixels per unit, across first: of wide pixels fewer go across (PNG, 11.3.4.3). ffmpeg
// 5.1 takes the two numbers for the aspect itself and shows it the other way round.
TEST(Png, HoldsTheAspectAsPixelsPerUnit) {
  const std::vector<std::uint8_t> png = encode_png(noise(4, 4, 1), 1.5);
  const std::string text(png.begin(), png.end());
  const std::size_t at = text.find("pHYs");
  ASSERT_NE(at, std::string::npos);
  const auto number = [&](std::size_t i) {
    return png[i] << 24 | png[i + 1] << 16 | png[i + 2] << 8 | png[i + 3];
  };
  EXPECT_EQ(number(at + 4), 10000);
  EXPECT_EQ(number(at + 8), 15000);
  EXPECT_EQ(png[at + 12], 0);  // unit unknown: an aspect
}

TEST(Png, RefusesEveryCutOffFile) {
  const std::vector<std::uint8_t> png = encode_png(noise(9, 9, 3));
  for (std::size_t size = 0; size + 12 < png.size(); ++size) {  // the last chunk says only "end"
    EXPECT_THROW(decode_png(std::span(png).first(size)), std::runtime_error) << size;
  }
}

TEST(Png, SurvivesDamage) {
  const std::vector<std::uint8_t> png = encode_png(noise(9, 9, 3));
  std::mt19937 random(4);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::uint8_t> damaged = png;
    damaged[random() % png.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
    try {
      const Image image = decode_png(damaged);
      EXPECT_EQ(image.rgb.size(), bytes_of(image.width, image.height));
    } catch (const std::runtime_error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1500);  // most bytes are image data, under a checksum
}

TEST(Png, RefusesAHeaderThatPromisesAHugePicture) {
  std::vector<std::uint8_t> png = encode_png(noise(9, 9, 3));
  png[16] = 0x7f;  // width
  EXPECT_THROW(decode_png(png), std::runtime_error);
}

TEST(Png, RefusesAPictureWithoutPixels) {
  EXPECT_THROW(encode_png({}), std::invalid_argument);
  EXPECT_THROW(encode_png({2, 2, {1, 2, 3}}), std::invalid_argument);
  EXPECT_THROW(encode_png(noise(2, 2, 1), 0.0), std::invalid_argument);
}

TEST(Png, NamesTheFileThatCannotBeWrittenOrRead) {
  try {
    write_png("/nowhere/image.png", noise(2, 2, 1));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(),
                 "/nowhere/image.png: cannot be created: there is no folder /nowhere");
  }
  EXPECT_THROW(read_png("/nowhere/image.png"), std::runtime_error);
}

TEST(Png, LeavesNothingBehindWhereTheFileDoesNotFit) {
  const fs::path folder = fresh_folder("image");
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, 1000};  // a disk that is full after 1000 bytes
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(write_png(folder / "image.png", noise(200, 200, 1)), std::runtime_error);
  EXPECT_TRUE(fs::is_empty(folder));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace headpin::render
