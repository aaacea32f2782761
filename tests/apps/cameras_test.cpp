// Cameras, depth, ids and flow of `headpin frames`, against the table of the bodies' poses.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "base/math.h"
#include "tests/apps/command_line.h"
#include "tests/apps/decoded.h"

namespace headpin {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 360, kHeight = 240;
constexpr int kRoom = 1, kBall = 10, kSkittle = 100;  // ids.csv

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream row(line);
  for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
  return cells;
}

template <typename T>
std::vector<T> values_of(const std::string& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

/// One eye's matrices as cameras.json has them.
struct PinholeOfFile {
  Mat3 K;
  Eigen::Matrix4d T;
  Mat3 K_inverse = K.inverse();
  Eigen::Matrix4d T_inverse = T.inverse();

  Vec3 seen(const Vec3& p_W) const { return (T * p_W.homogeneous()).head<3>(); }
  Vec2 pixel(const Vec3& p_W) const { return (K * seen(p_W)).hnormalized(); }
  Vec3 point(const Vec2& at, double depth) const {
    const Vec3 p_C = depth * (K_inverse * at.homogeneous());
    return (T_inverse * p_C.homogeneous()).head<3>();
  }
};

template <typename Matrix>
Matrix matrix_of(const nlohmann::json& rows) {
  Matrix m;
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      m(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    }
  }
  return m;
}

/// The files of one eye in one frame.
struct FilesOfEye {
  std::vector<std::uint16_t> ids;
  std::vector<float> depth;
};

std::size_t index_of(const Vec2& at) {
  return static_cast<std::size_t>(std::lround(at.y())) * kWidth +
         static_cast<std::size_t>(std::lround(at.x()));
}

bool inside_picture(const Vec2& at) {
  return at.x() >= 0.0 && at.y() >= 0.0 && at.x() <= kWidth - 1 && at.y() <= kHeight - 1;
}

class Cameras : public CommandLine {
 protected:
  /// Replays the bundled trial and reads where its ball and skittles are, by tick and id.
  void replay_and_export() {
    ASSERT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
    ASSERT_EQ(headpin("export game.lcmlog -o tables").code, 0);
    std::istringstream lines(slurp(folder_ / "tables/states.csv"));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      const std::vector<std::string> cells = cells_of(line);
      const std::string& body = cells.at(4);
      const auto number = [&](std::size_t i) { return std::stod(cells.at(i)); };
      if (body != "ball" && !body.starts_with("skittle ")) continue;
      const int id = body == "ball" ? kBall : kSkittle - 1 + std::stoi(body.substr(8));
      poses_[std::stoll(cells.at(0))][id] = {Quat(number(8), number(9), number(10), number(11)),
                                             Vec3(number(5), number(6), number(7))};
    }
    ASSERT_GT(poses_.size(), 1000u);
  }

  FilesOfEye files_of(const std::string& folder, const std::string& eye, std::int64_t frame) const {
    const std::string stem = fmt::format("{}/{}_{:06}", folder, eye, frame);
    return {values_of<std::uint16_t>(decoded(folder_ / (stem + "_ids.png"), "gray16le")),
            values_of<float>(slurp(folder_ / (stem + "_depth.raw")))};
  }

  /// The flow of a .flo of the display's size.
  std::vector<std::array<float, 2>> flow_of(const std::string& name) const {
    const std::string bytes = slurp(folder_ / name);
    EXPECT_EQ(values_of<float>(bytes.substr(0, 4)), std::vector{202021.25F});
    EXPECT_EQ(values_of<std::int32_t>(bytes.substr(4, 8)), (std::vector{kWidth, kHeight}));
    EXPECT_EQ(bytes.size(), 12 + std::size_t{8} * kWidth * kHeight);
    return values_of<std::array<float, 2>>(bytes.substr(12));
  }

  PinholeOfFile camera_of(const nlohmann::json& file, const std::string& eye,
                          const nlohmann::json& frame) const {
    return {matrix_of<Mat3>(file["cameras"][eye]["K"]),
            matrix_of<Eigen::Matrix4d>(frame[eye]["T_cam_world"])};
  }

  std::map<std::int64_t, std::map<int, Pose>> poses_;  ///< by tick and id
};

// The middle of a body is inside of it: its pixel shows the body, or something nearer.
TEST_F(Cameras, SeeEachBodyAtThePixelsThatHaveItsId) {
  replay_and_export();
  ASSERT_EQ(headpin("frames game.lcmlog -o truth --look 1997 --depth --ids --cameras c.json "
                    "--frames 200,210,220,230,240,250,260,270,280,290,300,310,320")
                .code,
            0);
  const nlohmann::json cameras = nlohmann::json::parse(slurp(folder_ / "c.json"));
  ASSERT_EQ(cameras["frames"].size(), 13u);
  std::map<int, int> visible;
  for (const nlohmann::json& frame : cameras["frames"]) {
    for (const std::string eye : {"left", "right"}) {
      const PinholeOfFile camera = camera_of(cameras, eye, frame);
      const FilesOfEye files = files_of("truth", eye, frame["frame"]);
      for (const auto& [id, X_WB] : poses_.at(frame["tick"])) {
        const double depth = camera.seen(X_WB.p).z();
        const Vec2 at = camera.pixel(X_WB.p);
        if (depth <= 0.0 || !inside_picture(at)) continue;
        const std::size_t pixel = index_of(at);
        EXPECT_LT(files.depth.at(pixel), depth) << eye << " " << frame["frame"] << " " << id;
        visible[id] += files.ids.at(pixel) == id;
      }
    }
  }
  for (const int id : {kBall, kSkittle, kSkittle + 1, kSkittle + 9})
    EXPECT_GT(visible[id], 8) << id;
}

TEST_F(Cameras, HaveTheFieldOfViewOfTheDisplayAndColmapTheSameCameras) {
  ASSERT_EQ(headpin("frames " + kDemo + " --frames 7,9 --cameras c.json --colmap model").code, 0);
  const nlohmann::json cameras = nlohmann::json::parse(slurp(folder_ / "c.json"));
  std::istringstream images(slurp(folder_ / "model/images.txt")),
      models(slurp(folder_ / "model/cameras.txt"));
  const auto next_words = [](std::istream& lines) {
    std::string line;
    while (std::getline(lines, line) && line.starts_with('#')) {
    }
    std::istringstream words(line);
    return std::vector<std::string>(std::istream_iterator<std::string>(words), {});
  };
  const auto radians = [](double degrees) { return degrees * std::numbers::pi / 180.0; };
  for (const std::string eye : {"left", "right"}) {
    const nlohmann::json& camera = cameras["cameras"][eye];
    EXPECT_NEAR(camera["fx"], 0.5 * kWidth / std::tan(radians(0.5 * 75.0)), 1e-9);
    EXPECT_NEAR(camera["fy"], 0.5 * kHeight / std::tan(radians(0.5 * 40.0)), 1e-9);
    EXPECT_NEAR(camera["cx"], 0.5 * (kWidth - 1), 1e-9);
    EXPECT_NEAR(camera["cy"], 0.5 * (kHeight - 1), 1e-9);
    const std::vector<std::string> model = next_words(models);
    ASSERT_EQ(model.size(), 8u);
    EXPECT_EQ(model[1], "PINHOLE");
    EXPECT_EQ(std::stod(model[4]), camera["fx"]);
    EXPECT_NEAR(std::stod(model[6]), 0.5 * kWidth, 1e-9);  // COLMAP's first pixel is at (0.5, 0.5)
    EXPECT_NEAR(std::stod(model[7]), 0.5 * kHeight, 1e-9);
  }
  for (const nlohmann::json& frame : cameras["frames"]) {
    for (const std::string eye : {"left", "right"}) {
      const std::vector<std::string> image = next_words(images);
      ASSERT_EQ(image.size(), 10u);
      const auto number = [&](std::size_t i) { return std::stod(image[i]); };
      const auto T = matrix_of<Eigen::Matrix4d>(frame[eye]["T_cam_world"]);
      const Quat q(number(1), number(2), number(3), number(4));
      EXPECT_LT((q.toRotationMatrix() - T.topLeftCorner<3, 3>()).norm(), 1e-12);
      EXPECT_LT((Vec3(number(5), number(6), number(7)) - T.topRightCorner<3, 1>()).norm(), 1e-12);
      EXPECT_EQ(image[8], eye == "left" ? "1" : "2");
      EXPECT_EQ(image[9], fmt::format("{}_{:06}.png", eye, frame["frame"].get<int>()));
      EXPECT_TRUE(next_words(images).empty());  // no points
    }
  }
  EXPECT_EQ(cameras["frames"][1]["frame"], 9);
  EXPECT_EQ(cameras["frames"][1]["t_us"], 150000);
}

/// How far the flow of one eye is from going back: from where it leads, by the depth of the next
/// frame, the tables' poses and the cameras [pixels]; by kind of object.
void add_errors(const std::vector<std::array<float, 2>>& flow,
                const std::array<FilesOfEye, 2>& files, const std::array<PinholeOfFile, 2>& cameras,
                const std::array<std::map<int, Pose>, 2>& poses,
                std::map<int, std::vector<double>>& errors) {
  for (std::size_t i = 0; i < flow.size(); i += 3) {
    const int id = files[0].ids[i];
    const Vec2 from(static_cast<double>(i % kWidth), static_cast<double>(i / kWidth));
    const Vec2 to = from + Vec2(flow[i][0], flow[i][1]);
    if (!inside_picture(to) || (id != kRoom && !poses[0].contains(id))) continue;
    const std::size_t pixel = index_of(to);
    if (files[1].ids[pixel] != id) continue;
    // What is seen at the nearest pixel's centre is a part of a pixel beside the end of the flow. It
    // is taken to be as far beside `from`: exact but for the change of size from frame to frame.
    const Vec2 centre(static_cast<double>(pixel % kWidth), static_cast<double>(pixel / kWidth));
    Vec3 p_W = cameras[1].point(centre, files[1].depth[pixel]);
    if (id != kRoom) p_W = poses[0].at(id) * (poses[1].at(id).inverse() * p_W);
    const Vec2 back = cameras[0].pixel(p_W) + (to - centre);
    const int kind = id >= kSkittle ? kSkittle : id;
    errors[kind].push_back((back - from).norm());
  }
}

TEST_F(Cameras, FlowLeadsToWhereTheSamePointIsInTheNextFrame) {
  replay_and_export();
  ASSERT_EQ(headpin("frames game.lcmlog -o truth --look 1997 --depth --ids --flow "
                    "--cameras c.json --frames 240-241,255-256,305-306,312-313,320-321")
                .code,
            0);
  EXPECT_TRUE(fs::exists(folder_ / "truth/left_000241.flo"));
  EXPECT_FALSE(fs::exists(folder_ / "truth/left_000321.flo"));  // the last frame
  const nlohmann::json file = nlohmann::json::parse(slurp(folder_ / "c.json"));
  std::map<int, std::vector<double>> errors;
  for (std::size_t i = 0; i + 1 < file["frames"].size(); i += 2) {
    const nlohmann::json &now = file["frames"][i], &next = file["frames"][i + 1];
    for (const std::string eye : {"left", "right"}) {
      const std::int64_t number = now["frame"];
      add_errors(flow_of(fmt::format("truth/{}_{:06}.flo", eye, number)),
                 {files_of("truth", eye, number), files_of("truth", eye, number + 1)},
                 {camera_of(file, eye, now), camera_of(file, eye, next)},
                 {poses_.at(now["tick"]), poses_.at(next["tick"])}, errors);
    }
  }
  for (const int kind : {kRoom, kBall, kSkittle}) {
    std::vector<double>& of_kind = errors[kind];
    ASSERT_GT(of_kind.size(), 100u) << kind;
    std::ranges::sort(of_kind);
    EXPECT_LT(of_kind[of_kind.size() / 2], 0.1) << kind;  // median
    EXPECT_LT(of_kind[of_kind.size() * 95 / 100], 0.5) << kind;
  }
}

// From above, the room and the skittles rest before the throw; the hand moves.
TEST_F(Cameras, FlowIsZeroWhereCameraAndWorldRest) {
  ASSERT_EQ(
      headpin("frames " + kDemo + " -o top --frames 100,140 --view top --ids --depth --flow").code,
      0);
  const FilesOfEye files = files_of("top", "left", 100);
  const auto flow = flow_of("top/left_000100.flo");
  std::map<int, double> most;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const double by = Vec2(flow[i][0], flow[i][1]).norm();
    if (files.ids[i] == 0) {
      EXPECT_GT(flow[i][0], 1e9F);  // Middlebury's "unknown"
    }
    double& m = most[files.ids[i]];
    m = std::max(m, by);
  }
  EXPECT_EQ(most.at(kRoom), 0.0);
  EXPECT_EQ(most.at(kSkittle), 0.0);
  EXPECT_GT(most.at(2), 0.1);  // the hand
}

TEST_F(Cameras, FlowOfBothEyesIsSideBySideLikeThePictures) {
  const std::string draw = "frames " + kDemo + " --frames 250-251 --look 1997 --flow ";
  ASSERT_EQ(headpin(draw + "-o two").code, 0);
  ASSERT_EQ(headpin(draw + "-o one --layout side-by-side").code, 0);
  const std::string both = slurp(folder_ / "one/both_000250.flo");
  EXPECT_EQ(values_of<std::int32_t>(both.substr(4, 8)), (std::vector{2 * kWidth, kHeight}));
  constexpr std::size_t kRow = std::size_t{8} * kWidth;
  const std::array eyes = {slurp(folder_ / "two/left_000250.flo"),
                           slurp(folder_ / "two/right_000250.flo")};
  ASSERT_EQ(both.size(), 12 + 2 * kRow * kHeight);
  for (std::size_t y = 0; y < kHeight; ++y) {
    for (std::size_t eye = 0; eye < 2; ++eye) {
      EXPECT_EQ(both.substr(12 + kRow * (2 * y + eye), kRow), eyes[eye].substr(12 + kRow * y, kRow))
          << eye << " " << y;
    }
  }
}

TEST_F(Cameras, AreWrittenLikeOtherOutputs) {
  const std::string draw = "frames " + kDemo + " --frames 3-4 ";
  const nlohmann::json told = json(draw + "--cameras c.json --colmap model --json");
  EXPECT_EQ(told["cameras"], "c.json");
  EXPECT_EQ(told["colmap"], "model");
  EXPECT_EQ(told["frames"], 2);
  const std::string first = slurp(folder_ / "c.json");
  expect_refusal(draw + "--cameras c.json", 1, "c.json: exists already");
  expect_refusal(draw + "--colmap model", 1, "model: exists already");
  EXPECT_EQ(headpin(draw + "-o both --cameras c.json --colmap model --force").code, 0);
  EXPECT_EQ(slurp(folder_ / "c.json"), first);
  expect_refusal(draw + "--cameras OUT.txt", 2, "expected a name that ends in .json");
  expect_refusal(draw + "--video OUT.mkv --flow", 2, "need -o DIR");
  expect_refusal(draw + "-o OUT --layout side-by-side --colmap OUT2", 2, "--colmap names");
  expect_refusal(draw + "-o OUT --colmap OUT/model", 1, "expected another folder");
  ASSERT_EQ(
      headpin("replay " + kDemo + " --set hmd.profile=flight-helmet-lens -o lens.lcmlog").code, 0);
  expect_refusal("frames lens.lcmlog --cameras OUT.json", 1,
                 "its display has a lens: for --cameras, --colmap and --flow expected");
}

TEST_F(Cameras, OnAFullDiskNothingIsLeft) {
  for (const std::string output : {"--cameras OUT.json", "--colmap OUT"}) {
    const std::string command = "cd '" + folder_.string() +
                                "' && { (ulimit -f 0; exec '" HEADPIN_PROGRAM "' frames '" + kDemo +
                                "' --frames 3 " + output +
                                ") 2>&1 >/dev/null </dev/null; echo $? >code.txt; } | cat >err.txt";
    ASSERT_EQ(std::system(command.c_str()), 0);
    EXPECT_EQ(slurp(folder_ / "code.txt"), "1\n") << output;
    EXPECT_THAT(slurp(folder_ / "err.txt"), HasSubstr("OUT")) << output;
    EXPECT_THAT(slurp(folder_ / "err.txt"), HasSubstr("File too large")) << output;
    EXPECT_FALSE(fs::exists(folder_ / "OUT.json"));
    EXPECT_FALSE(fs::exists(folder_ / "OUT"));
  }
}

}  // namespace
}  // namespace headpin
