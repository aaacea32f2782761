#include "scene/page/page_data.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/output_file.h"
#include "scene/page/page_film.h"
#include "scene/record/log.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/totals.h"
#include "tests/scene/demo.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

/// A number of a section by row and name of its column.
float at(const PageData& data, const std::string& name, std::int64_t row,
         const std::string& column) {
  for (const nlohmann::json& section : data.json["sections"]) {
    if (section["name"] != name) continue;
    const auto columns = section["columns"].get<std::vector<std::string>>();
    const auto found = std::ranges::find(columns, column);
    if (found == columns.end()) break;
    return data.floats[section["offset"].get<std::size_t>() +
                       static_cast<std::size_t>(row) * columns.size() +
                       static_cast<std::size_t>(found - columns.begin())];
  }
  ADD_FAILURE() << "no " << column << " in " << name;
  return 0.0f;
}

/// The trial simulated to its end.
Session played(const Recorded& recorded, const Scenario& scenario) {
  Session session = make_session(scenario);
  TrialPlayer source(recorded.file);
  NoPace pace;
  const std::int64_t ticks = recorded.ticks(scenario.rates.physics_hz);
  run(session, source, pace, {}, [&](const Session& s) { return s.tick >= ticks; });
  return session;
}

TEST(PageData, ShowsEveryBodyWhereTheReplayLeavesIt) {
  const Recorded recorded = load_trial(kDemo);
  const PageData data = page_data(recorded, PageLooks(recorded.scenario));
  const Session session = played(recorded, recorded.scenario);
  ASSERT_EQ(data.json["drawn"]["every"], 1);
  const std::int64_t last = data.json["drawn"]["rows"].get<std::int64_t>() - 1;
  EXPECT_EQ(last, session.tick);
  for (const auto& bodies : {session.stage->balls, session.stage->skittles}) {
    for (const engine::BodyId body : bodies) {
      const std::string& name = session.world.bodies[body].name;
      const Vec3& p = session.world.states[body].X_WB.p;
      EXPECT_EQ(at(data, "poses", last, name + " x"), static_cast<float>(p.x())) << name;
      EXPECT_EQ(at(data, "poses", last, name + " y"), static_cast<float>(p.y())) << name;
      EXPECT_EQ(at(data, "poses", last, name + " z"), static_cast<float>(p.z())) << name;
    }
  }
  EXPECT_EQ(at(data, "poses", last, "hand x"), static_cast<float>(hand_pose(session)->p.x()));
  EXPECT_EQ(at(data, "poses", last, "head z"), static_cast<float>(head_pose(session)->p.z()));
  EXPECT_EQ(at(data, "series", last, "impact_j"),
            static_cast<float>(session.world.ledger.impact.energy));
}

TEST(PageData, HasTheScoreBoardsTextsAndCharacters) {
  Recorded recorded = load_trial(kDemo);
  EXPECT_TRUE(page_data(recorded, PageLooks(recorded.scenario)).json["board"].is_null());
  recorded.scenario.game.rules = GameKind::ten_pin;
  recorded.scenario.game.ball_back_s = 2.5;  // within the trial
  recorded.scenario.game.show_score = true;
  const nlohmann::json json = page_data(recorded, PageLooks(recorded.scenario)).json;
  const nlohmann::json& texts = json["board"]["texts"];
  ASSERT_GE(texts.size(), 2u);
  EXPECT_EQ(texts[0], nlohmann::json({1, {"_", "F1       0"}}));
  const Session session = played(recorded, recorded.scenario);
  EXPECT_EQ(texts.back()[1], nlohmann::json(board_text(session)));
  std::set<int> meshes;
  for (const nlohmann::json& mesh : json["meshes"]) meshes.insert(mesh["number"].get<int>());
  for (const nlohmann::json& mesh : json["board"]["characters"]) {
    EXPECT_TRUE(meshes.contains(mesh.get<int>()));
  }
  for (const nlohmann::json& actor : json["actors"]) EXPECT_NE(actor["name"], "score board");
}

TEST(PageData, HasTheRingsOfOilOneByOne) {
  Recorded recorded = load_trial(kDemo);
  EXPECT_TRUE(page_data(recorded, PageLooks(recorded.scenario)).json["rings"]["mesh"].is_null());
  recorded.scenario.ball.rings = true;
  set_elasticity(recorded.scenario.material, 0.0);     // it stays on the lane
  recorded.scenario.hand.spin = Vec3(60.0, 0.0, 0.0);  // topspin
  const nlohmann::json json = page_data(recorded, PageLooks(recorded.scenario)).json;
  const nlohmann::json& rings = json["rings"];
  std::set<int> meshes;
  for (const nlohmann::json& mesh : json["meshes"]) meshes.insert(mesh["number"].get<int>());
  EXPECT_TRUE(meshes.contains(rings["mesh"].get<int>()));
  const Session session = played(recorded, recorded.scenario);
  const std::vector<OilRing>& told = session.game.ringed.value().rings;
  ASSERT_GE(told.size(), 3u);
  ASSERT_EQ(rings["changes"].size(), told.size());
  const double radius = recorded.scenario.ball.radius;
  std::int64_t row = 0;
  for (std::size_t i = 0; i < told.size(); ++i) {
    const nlohmann::json& change = rings["changes"][i];
    EXPECT_GT(change[0], row);
    row = change[0];
    EXPECT_EQ(json["actors"][change[1].get<std::size_t>()]["name"], "ball");
    EXPECT_EQ(change[2], i);
    ASSERT_EQ(change[3].size(), 1u);
    const nlohmann::json& ring = change[3][0];
    const Vec3 centre(ring[4], ring[5], ring[6]);
    EXPECT_LT((centre - radius * told[i].height * told[i].n_B).norm(), 1e-12);
    EXPECT_NEAR(ring[7], radius * std::sqrt(1.0 - told[i].height * told[i].height), 1e-12);
  }
}

TEST(PageData, UnderAnotherConditionIsWhatAReplayUnderItGives) {
  const Recorded recorded = load_trial(kDemo);
  const Condition condition{
      .elasticity = 1.0, .friction = 0.2, .shape = SkittleShape::ellipsoid, .response = "coulomb"};
  Scenario scenario = recorded.scenario;
  set_elasticity(scenario.material, 1.0);
  set_friction(scenario.material, 0.2);
  scenario.collision.shape = SkittleShape::ellipsoid;
  scenario.collision.response = "coulomb";
  const PageData data = page_data(recorded, PageLooks(recorded.scenario), condition, false);
  EXPECT_EQ(data.json["summary"]["state_hash"],
            summary(played(recorded, scenario), {})["state_hash"]);
  EXPECT_TRUE(data.json["meshes"].empty());
}

TEST(PageData, HasThePixelsOfTheDisplayAsItsPicturesHaveThem) {
  for (const double k1 : {0.0, 0.18}) {
    render::Optics optics;
    optics.lens_k1 = k1;
    const nlohmann::json eyes = of_eyes(optics);
    ASSERT_EQ(eyes.size(), 2u);
    for (const nlohmann::json& eye : eyes) {
      EXPECT_EQ(eye["pixel_aspect"], optics.pixel_aspect());
      EXPECT_EQ(eye["lens"], k1 != 0.0);
    }
  }
}

/// Numbers of the meshes that the actors of a page are shown with.
std::set<int> shown_meshes(const nlohmann::json& json) {
  std::set<int> shown;
  for (const nlohmann::json& show : json["shows"]) shown.insert(show[2].get<int>());
  shown.erase(-1);
  return shown;
}

/// Numbers of the meshes that are in a page.
std::set<int> packed_meshes(const nlohmann::json& json) {
  std::set<int> packed;
  for (const nlohmann::json& mesh : json["meshes"]) packed.insert(mesh["number"].get<int>());
  return packed;
}

TEST(PageData, HasTheSkittlesOfTheOtherShapeForARunUnderIt) {
  for (const SkittleShape recorded_shape : {SkittleShape::parts, SkittleShape::ellipsoid}) {
    Recorded recorded = load_trial(kDemo);
    recorded.scenario.skittle.seen = SeenSkittle::collider;
    recorded.scenario.collision.shape = recorded_shape;
    const SkittleShape other_shape =
        recorded_shape == SkittleShape::ellipsoid ? SkittleShape::parts : SkittleShape::ellipsoid;
    const PageLooks looks(recorded.scenario);
    const nlohmann::json own = page_data(recorded, looks).json;
    const nlohmann::json again = page_data(recorded, looks, {.shape = other_shape}, false).json;
    EXPECT_NE(shown_meshes(own), shown_meshes(again));
    EXPECT_THAT(packed_meshes(own), testing::IsSupersetOf(shown_meshes(again)));
  }
}

TEST(PageData, HasTheHandsOfAnotherTrialThatGrabsWhereThisOneDoesNot) {
  Recorded idle = load_trial(kDemo);
  const Recorded grabs = load_trial(kDemo);
  idle.scenario.hand.reach = 1e-3;
  const nlohmann::json without = page_data(idle, PageLooks(idle.scenario)).json;
  const nlohmann::json with = page_data(grabs, PageLooks(grabs.scenario), {}, false).json;
  EXPECT_LT(shown_meshes(without).size(), shown_meshes(with).size());
  EXPECT_THAT(packed_meshes(without), testing::IsSupersetOf(shown_meshes(with)));
}

/// The bundled trial with the states of a replay, the ball in one of them a little elsewhere.
std::string trial_with_states(std::int64_t moved_tick) {
  const std::string path = fresh_folder("page") / "states.lcmlog";
  const Recorded recorded = load_trial(kDemo);
  Session session = make_session(recorded.scenario);
  TrialHeader header = recorded.file.summary().header;
  header.body_names = body_names(*session.stage);
  Recorder recorder(base::OutputFile(path, {.overwrite = true}), header);
  TrialPlayer source(recorded.file);
  TickState state;
  for (int tick = 1; tick <= 300; ++tick) {
    advance(session, source);
    for (const devices::Sample& sample : session.samples) recorder.write(sample);
    tick_state(session, state);
    if (tick == moved_tick) state.bodies[session.stage->balls[0]].X_WB.p.x() += 0.5;
    recorder.write(state);
  }
  recorder.close();
  return path;
}

TEST(PageData, TellsWhetherTheRecordedStatesCameBack) {
  const Recorded recorded = load_trial(trial_with_states(-1));
  const PageData data = page_data(recorded, PageLooks(recorded.scenario), {}, false);
  const nlohmann::json& hash = data.json["hash"];
  EXPECT_EQ(hash["verified_ticks"], 300);
  EXPECT_EQ(hash["recorded"], hash["replayed"]);
  EXPECT_TRUE(hash["first_difference"].is_null());
}

TEST(PageData, ShowsWhatWasRecordedWhereTheReplayDiffersAndSaysWhere) {
  const Recorded recorded = load_trial(trial_with_states(120));
  const PageData data = page_data(recorded, PageLooks(recorded.scenario), {}, false);
  const nlohmann::json& first = data.json["hash"]["first_difference"];
  EXPECT_EQ(first["tick"], 120);
  EXPECT_EQ(first["body"], "ball");
  EXPECT_EQ(data.json["hash"]["verified_ticks"], 119);
  EXPECT_NEAR(at(data, "poses", 120, "ball x") - at(data, "poses", 119, "ball x"), 0.5, 1e-6);
}

TEST(PageData, OfALongTrialDrawsEveryNthTickAndTheLast) {
  const std::string path = fresh_folder("page") / "long.lcmlog";
  const Recorded demo = load_trial(kDemo);
  Recorder recorder(base::OutputFile(path, {.overwrite = true}), demo.file.summary().header);
  for (const int second : {0, 40, 80, 131}) {
    devices::TrackerSample head;
    head.station = devices::kHeadStation;
    head.device_time = Time{second * 1'000'000};
    head.X_TS.p = Vec3(0.01 * second, 0.0, 1.7);
    recorder.write(devices::Sample(head));
  }
  recorder.close();
  const Recorded recorded = load_trial(path);
  const PageData data = page_data(recorded, PageLooks(recorded.scenario), {}, false);
  const nlohmann::json& drawn = data.json["drawn"];
  EXPECT_EQ(drawn["every"], 2);  // 31440 ticks are more than 24000
  EXPECT_EQ(drawn["last_tick"], data.json["ticks"]);
  const std::int64_t ticks = drawn["last_tick"];
  EXPECT_EQ(drawn["rows"], ticks / 2 + 1 + ticks % 2);
}

TEST(PageData, OfTheBytesOfALogIsThatOfTheFile) {
  std::ifstream file(kDemo, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  const Recorded from_file = load_trial(kDemo), from_memory = load_trial(bytes, "demo");
  const PageData a = page_data(from_file, PageLooks(from_file.scenario)),
                 b = page_data(from_memory, PageLooks(from_memory.scenario));
  EXPECT_EQ(a.json, b.json);
  EXPECT_EQ(a.floats, b.floats);
}

TEST(PageData, ShowsOurOwnShapeAndSaysSoWhereAMeshFileIsGone) {
  const TemporaryFolder folder;
  std::filesystem::copy_file(HEADPIN_SOURCE_DIR "/assets/meshes/skittle_hull.obj",
                             folder / "pin.obj");
  const Recorded demo = load_trial(kDemo);
  TrialHeader header = demo.file.summary().header;
  header.scenario = to_toml(
      parse_scenario("[skittle]\nmesh = {file = 'pin.obj'}\n", (folder / "pin.toml").string()));
  const std::string path = (folder / "pin.lcmlog").string();
  Recorder recorder(path, header);
  recorder.write(devices::Sample(devices::TrackerSample{}));
  recorder.close();

  const auto skittle_of = [](const PageLooks& looks) {
    return looks.meshes[static_cast<std::size_t>(looks.looks.true_skittle.mesh)].vertices.size();
  };
  const PageLooks there(load_trial(path).scenario), own{demo.scenario};
  EXPECT_TRUE(there.missing.empty());
  EXPECT_NE(skittle_of(there), skittle_of(own));

  std::filesystem::remove(folder / "pin.obj");
  const Recorded recorded = load_trial(path);
  const PageLooks gone(recorded.scenario);
  ASSERT_EQ(gone.missing.size(), 1u);
  EXPECT_THAT(gone.missing[0], AllOf(HasSubstr("skittles"), HasSubstr("pin.obj")));
  EXPECT_EQ(skittle_of(gone), skittle_of(own));
  EXPECT_EQ(page_data(recorded, gone).json["missing_meshes"][0], gone.missing[0]);
}

// Of 6001 samples every second one is drawn, the later of two; the last one has no other.
TEST(PageData, HasTheDelayOfTheLastSample) {
  const std::string path = fresh_folder("page") / "late.lcmlog";
  const Recorded demo = load_trial(kDemo);
  Recorder recorder(base::OutputFile(path, {.overwrite = true}), demo.file.summary().header);
  for (int i = 0; i < 6001; ++i) {
    devices::TrackerSample head;
    head.station = devices::kHeadStation;
    head.device_time = Time{500 * i};
    head.session_time = head.device_time + Time{i == 6000 ? 250'000 : 0};
    head.X_TS.p = Vec3(0.0, 0.0, 1.7);
    recorder.write(devices::Sample(head));
  }
  recorder.close();
  const Recorded recorded = load_trial(path);
  const PageData data = page_data(recorded, PageLooks(recorded.scenario), {}, false);
  EXPECT_NEAR(at(data, "clock head", 3000, "device_s"), 3.0, 1e-6);
  EXPECT_NEAR(at(data, "clock head", 3000, "tick_after_s"), 0.25, 1e-6);
}

// Where many were as strong as the weakest, the first of all were kept, and the strongest were left out.
TEST(Film, KeepsTheStrongestContacts) {
  const Scenario scenario;
  const PageLooks looks(scenario);
  Session session = make_session(scenario);
  Film film(looks.looks, {}, 4, nullptr);
  film.start(session);
  for (int tick = 1; tick <= 4; ++tick) {
    session.tick = tick;
    session.world.events.assign(15'000, {.b = 1, .impulse_W = Vec3(0.0, 0.0, 1.0)});
    session.world.events.back().impulse_W.z() = 10.0 * tick;
    film.tick(session);
  }
  EXPECT_EQ(film.rows(), 5);
  const Table contacts = film.take_tables().at(2);
  EXPECT_EQ(film.contacts_left_out(), 40'000);
  ASSERT_EQ(contacts.rows(), 20'000u);
  std::vector<float> strongest;
  for (std::size_t at = 8; at < contacts.values.size(); at += contacts.columns.size()) {
    if (contacts.values[at] > 1.0F) strongest.push_back(contacts.values[at]);
  }
  EXPECT_THAT(strongest, testing::ElementsAre(10.0F, 20.0F, 30.0F, 40.0F));
}

}  // namespace
}  // namespace headpin::scene
