// What the columns of a table are, by their names and as a user tells them.

#include "devices/recordings/table_columns.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/table_motion.h"
#include "devices/recordings/table_objects.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

using Place = std::optional<std::size_t>;

/// A header above four rows of numbers, of which the first ones are times.
std::string numbers_under(const std::string& header) {
  const auto commas = std::ranges::count(header.substr(header.rfind('\n') + 1), ',');
  std::string text = header + "\n";
  for (int row = 0; row < 4; ++row) {
    text += fmt::format("{:.2f}", 0.01 * row);
    for (int c = 0; c < commas; ++c) text += fmt::format(",{}", c);
    text += "\n";
  }
  return text;
}

/// The columns of a table of any cells.
MotionColumns columns_of_text(const std::string& text, const ToldColumns& told = {},
                              bool only_hand_is_left = false) {
  return find_columns(read_any_table(text, "t.csv"), told, only_hand_is_left, "t.csv");
}

/// The columns of a table of numbers.
MotionColumns columns_under(const std::string& header, const ToldColumns& told = {},
                            bool only_hand_is_left = false) {
  return columns_of_text(numbers_under(header), told, only_hand_is_left);
}

/// Where x, y and z of head, left and right hand begin; none for one that is not tracked.
std::array<Place, 3> starts_of(const MotionColumns& columns) {
  return {columns.parts[0].position[0], columns.parts[1].position[0], columns.parts[2].position[0]};
}

std::array<Place, 3> begins_under(const std::string& header, const ToldColumns& told = {},
                                  bool only_hand_is_left = false) {
  return starts_of(columns_under(header, told, only_hand_is_left));
}

/// "OBJECT_x,OBJECT_y,OBJECT_z", and the same of other letters.
std::string xyz_of(const std::string& object, const std::string& before = "") {
  return fmt::format("{0}_{1}x,{0}_{1}y,{0}_{1}z", object, before);
}

std::string posed(const std::string& object) {
  return fmt::format("{0},{1}_qw,{2}", xyz_of(object), object, xyz_of(object, "q"));
}

std::string nine_of(const std::string& object) {
  std::string names;
  for (const char* element : {"00", "01", "02", "10", "11", "12", "20", "21", "22"})
    names += fmt::format("{}{}_m{}", names.empty() ? "" : ",", object, element);
  return names;
}

std::vector<std::pair<std::string, std::string>> told_of(const ToldColumns& columns) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const ToldColumn& one : columns) all.emplace_back(one.key, one.column);
  return all;
}

/// Head with a quaternion, left hand with a matrix, right hand with angles and a trigger.
const std::string kEveryKind = "time," + posed("head") + "," + xyz_of("left") + "," +
                               nine_of("left") + "," + xyz_of("right") + "," +
                               xyz_of("right", "r") + ",right_trigger,battery";

const std::vector<std::string> kEveryMeaning = {"time",
                                                "head, position x",
                                                "head, position y",
                                                "head, position z",
                                                "head, quaternion w",
                                                "head, quaternion x",
                                                "head, quaternion y",
                                                "head, quaternion z",
                                                "left hand, position x",
                                                "left hand, position y",
                                                "left hand, position z",
                                                "left hand, matrix element 0",
                                                "left hand, matrix element 1",
                                                "left hand, matrix element 2",
                                                "left hand, matrix element 3",
                                                "left hand, matrix element 4",
                                                "left hand, matrix element 5",
                                                "left hand, matrix element 6",
                                                "left hand, matrix element 7",
                                                "left hand, matrix element 8",
                                                "right hand, position x",
                                                "right hand, position y",
                                                "right hand, position z",
                                                "right hand, angle about x",
                                                "right hand, angle about y",
                                                "right hand, angle about z",
                                                "right hand, trigger",
                                                ""};

const std::vector<std::string> kEveryKey = {
    "time",     "head.x",   "head.y",   "head.z",   "head.qw",  "head.qx",      "head.qy",
    "head.qz",  "left.x",   "left.y",   "left.z",   "left.m00", "left.m01",     "left.m02",
    "left.m10", "left.m11", "left.m12", "left.m20", "left.m21", "left.m22",     "right.x",
    "right.y",  "right.z",  "right.rx", "right.ry", "right.rz", "right.trigger"};

TEST(TableColumns, MeanWhatTheirNamesSay) {
  const std::string text = numbers_under(kEveryKind);
  const AnyTable table = read_any_table(text, "t.csv");
  const MotionColumns columns = find_columns(table, {}, false, "t.csv");
  EXPECT_EQ(columns.meanings, kEveryMeaning);
  EXPECT_THAT(columns.missing, IsEmpty());
  std::vector<std::pair<std::string, std::string>> wanted;
  for (std::size_t c = 0; c < kEveryKey.size(); ++c)
    wanted.emplace_back(kEveryKey[c], table.columns[c].name);
  EXPECT_EQ(told_of(mapping_of(table, columns)), wanted);
}

TEST(TableColumns, OfARotationVectorAreCalledSo) {
  const MotionOptions options = {.rotations = "vector"};
  const TableFindings found = inspect_table(numbers_under(kEveryKind), "t.csv", options);
  std::vector<std::string> meanings = kEveryMeaning;
  for (std::size_t i = 0; i < 3; ++i)
    meanings[23 + i] = fmt::format("right hand, rotation vector {}", "xyz"[i]);
  for (std::size_t c = 0; c < meanings.size(); ++c)
    EXPECT_EQ(found.columns.at(c).meaning, meanings[c]);
}

TEST(TableColumns, WhoseNamesSayNothingMeanWhatIsTold) {
  ToldColumns told;
  for (std::size_t c = 0; c < kEveryKey.size(); ++c)
    told.push_back({kEveryKey[c], fmt::format("#{}", c + 1)});
  std::string names = "a";
  for (std::size_t c = 1; c < kEveryMeaning.size(); ++c) names += fmt::format(",v{}", c / 2);
  const std::string text = numbers_under(names);
  const AnyTable table = read_any_table(text, "t.csv");
  const MotionColumns columns = find_columns(table, told, false, "t.csv");
  EXPECT_EQ(columns.meanings, kEveryMeaning);
  EXPECT_THAT(columns.missing, IsEmpty());
  // A name that two columns have is none: "v0" is of one, "v1" of two.
  ToldColumns mapped = told;
  mapped[0].column = "a";
  mapped[1].column = "v0";
  EXPECT_EQ(told_of(mapping_of(table, columns)), told_of(mapped));
}

TEST(TableColumns, ThatAreToldCompleteWhatTheNamesSay) {
  const std::string begin = "time," + xyz_of("head") + "," + xyz_of("right") + ",";
  const PartColumns quaternion =
      columns_under(begin + "a,b,c,d",
                    {{"head.qw", "d"}, {"head.qx", "a"}, {"head.qy", "b"}, {"head.qz", "c"}})
          .parts[0];
  EXPECT_EQ(quaternion.rotation, RotationKind::quaternion);
  EXPECT_THAT(quaternion.quaternion, ElementsAre(10u, 7u, 8u, 9u));
  const PartColumns angles =
      columns_under(begin + "a,b,c", {{"right.rx", "c"}, {"right.ry", "a"}, {"right.rz", "b"}})
          .parts[2];
  EXPECT_EQ(angles.rotation, RotationKind::angles);
  EXPECT_THAT(angles.angles, ElementsAre(9u, 7u, 8u));
  ToldColumns nine_told;
  for (int i = 0; i < 9; ++i)
    nine_told.push_back({fmt::format("head.m{}{}", i / 3, i % 3), fmt::format("#{}", 16 - i)});
  const PartColumns matrix = columns_under(begin + "a,b,c,d,e,f,g,h,i", nine_told).parts[0];
  EXPECT_EQ(matrix.rotation, RotationKind::matrix);
  EXPECT_THAT(matrix.matrix, ElementsAre(15u, 14u, 13u, 12u, 11u, 10u, 9u, 8u, 7u));
  EXPECT_THAT(matrix.position, ElementsAre(1u, 2u, 3u));
  // Angles of the file stay, where nothing of the rotation is told.
  const PartColumns found =
      columns_under(begin + xyz_of("right", "r") + ",a", {{"right.trigger", "a"}}).parts[2];
  EXPECT_EQ(found.rotation, RotationKind::angles);
  EXPECT_EQ(found.trigger, 10u);
}

TEST(TableColumns, ThatAreToldGoBeforeThoseOfThatName) {
  const std::string names =
      "time," + xyz_of("hmd") + "," + xyz_of("left") + "," + xyz_of("Kopf") + "," + xyz_of("Hand");
  EXPECT_THAT(begins_under(names), ElementsAre(1u, 4u, Place()));
  EXPECT_THAT(begins_under(names, {{"head", "Kopf_*"}}), ElementsAre(7u, 4u, Place()));
  EXPECT_THAT(begins_under(names, {{"head.x", "Kopf_x"}, {"head.y", "#9"}, {"head.z", "#10"}}),
              ElementsAre(7u, 4u, Place()));
  // Of two hands, one that was not told is not wanted.
  EXPECT_THAT(begins_under(names, {{"right", "Hand_*"}}), ElementsAre(1u, Place(), 10u));
  EXPECT_THAT(begins_under(names, {{"left", "Hand_*"}}), ElementsAre(1u, 10u, Place()));
  EXPECT_THAT(begins_under(names, {{"left", "left*"}, {"right", "Hand_*"}}),
              ElementsAre(1u, 4u, 10u));
}

// A told trigger and told places were passed over beside a name that was told or found.
TEST(TableColumns, ThatAreToldGoBeforeThoseOfAnObjectThatIsTold) {
  const std::string names =
      "time," + posed("hmd") + ",up," + xyz_of("right") + ",right_trigger,button_b,a,b,c,d";
  const ToldColumns components = {{"head.y", "up"}, {"head.qw", "a"},
                                  {"head.qx", "b"}, {"head.qy", "c"},
                                  {"head.qz", "d"}, {"right.trigger", "button_b"}};
  const ToldColumns objects = {{"head", "hmd*"}, {"right", "right*"}};
  ToldColumns first = components, last = objects;
  first.insert(first.end(), objects.begin(), objects.end());
  last.insert(last.end(), components.begin(), components.end());
  for (const ToldColumns& told : {first, last, components}) {
    const MotionColumns columns = columns_under(names, told);
    EXPECT_THAT(columns.parts[0].position, ElementsAre(1u, 8u, 3u));
    EXPECT_THAT(columns.parts[0].quaternion, ElementsAre(14u, 15u, 16u, 17u));
    EXPECT_THAT(columns.parts[2].position, ElementsAre(9u, 10u, 11u));
    EXPECT_EQ(columns.parts[2].trigger, 13u);
  }
}

TEST(TableColumns, OfATriggerThatIsToldAreOfBothHandsUnlessOneHasItsOwn) {
  const std::string names =
      "time," + xyz_of("head") + "," + xyz_of("left") + ",a,b,c,pull,squeezed";
  ToldColumns told = {
      {"trigger", "pull"}, {"right.x", "a"}, {"right.y", "b"}, {"right.z", "c"}, {"left", "left*"}};
  const MotionColumns both = columns_under(names, told);
  EXPECT_EQ(both.parts[1].trigger, 10u);
  EXPECT_EQ(both.parts[2].trigger, 10u);
  EXPECT_EQ(both.meanings[10], "left hand, trigger; right hand, trigger");
  told.push_back({"right.trigger", "squeezed"});
  const MotionColumns own = columns_under(names, told);
  EXPECT_EQ(own.meanings[10], "left hand, trigger");
  EXPECT_EQ(own.meanings[11], "right hand, trigger");
}

TEST(TableColumns, ThatAreToldAreCalledByTheirLowestNameWhereOneHasIt) {
  const std::string header = "all,rigid,rigid,rigid,hand,hand,hand\nstamp,x,y,u [mm],x,y,w";
  for (const char* z : {"u", "u [mm]", "rigid u", "#4"}) {
    const MotionColumns columns = columns_under(
        header, {{"time", "stamp"}, {"head.x", "rigid x"}, {"head.y", "#3"}, {"head.z", z}});
    EXPECT_EQ(columns.time, 0u);
    EXPECT_THAT(columns.parts[0].position, ElementsAre(1u, 2u, 3u)) << z;
  }
}

// The first of them was taken.
TEST(TableColumns, ThatAreToldByANameThatTwoHaveAreRefused) {
  const std::string header = "all,rigid,rigid,rigid,hand,hand,hand\nstamp,x,y,u,x,y,w";
  EXPECT_EQ(complaint([&] {
              columns_under(header, {{"head.x", "x", "m.toml:2"}});
            }),
            "m.toml:2: t.csv has no column 'x'; the 7 columns are all stamp, rigid x, rigid y, "
            "rigid u, hand x, hand y, hand w");
}

TEST(TableColumns, ThatAreToldWronglyAreRefusedWithWhatIsExpected) {
  const std::string names = "time," + xyz_of("HMD") + ",a,ball_x," + xyz_of("hand");
  const auto refused = [&](const std::string& key, const std::string& column) {
    return complaint([&] { columns_under(names, {{key, column, "--columns"}}); });
  };
  EXPECT_EQ(refused("foot.x", "a"),
            "--columns: unknown key 'foot.x'; expected time, trigger, object, head, left or right");
  const std::string components =
      "; expected x, y, z, qw, qx, qy, qz, rx, ry, rz (angles), m00 to m22 or trigger";
  EXPECT_EQ(refused("head.size", "a"), "--columns: unknown component 'head.size'" + components);
  EXPECT_EQ(refused("head.left_x", "a"), "--columns: unknown component 'head.left_x'" + components);
  const std::string star = "; expected a name with one *, such as HMD_*";
  EXPECT_EQ(refused("head", "HMD"), "--columns: head = 'HMD'" + star);
  EXPECT_EQ(refused("head", "*HMD*"), "--columns: head = '*HMD*'" + star);
  const std::string all = fmt::format("; the 9 columns are {}, a, ball_x, {}",
                                      "time, HMD_x, HMD_y, HMD_z", "hand_x, hand_y, hand_z");
  EXPECT_EQ(refused("head", "Kopf_*"), "--columns: no columns of t.csv begin with 'Kopf_'" + all);
  EXPECT_EQ(refused("head", "*_Kopf"), "--columns: no columns of t.csv are called '*_Kopf'" + all);
  const std::string one = "; expected x, y and z of one object";
  EXPECT_EQ(refused("head", "*"),
            "--columns: the columns of t.csv that begin with '' are of 3 objects" + one);
  EXPECT_EQ(refused("head", "HMD*x"),
            "--columns: the columns of t.csv that are called 'HMD*x' lack x, y or z" + one);
  EXPECT_EQ(refused("head", "ball*"),
            "--columns: the columns of t.csv that begin with 'ball' lack x, y or z" + one);
  EXPECT_EQ(refused("head", "a*"),
            "--columns: the columns of t.csv that begin with 'a' lack x, y or z" + one);
  EXPECT_EQ(refused("head", "*_x"),
            "--columns: the columns of t.csv that are called '*_x' lack x, y or z" + one);
  try {
    columns_under(names, {{"time", "t"}});
    FAIL();
  } catch (const WrongColumn& wrong) {
    EXPECT_EQ(wrong.known.size(), 9u);
    EXPECT_EQ(wrong.wrong, "t.csv has no column 't'");
  }
}

TEST(TableColumns, HaveKeysOfPartsAndOfThreeOthers) {
  for (const char* key :
       {"time", "trigger", "object", "head", "left", "right", "head.x", "left.qw"})
    EXPECT_TRUE(is_column_key(key)) << key;
  for (const char* key : {"", "time.x", "foot", "foot.x", "units", "heads"})
    EXPECT_FALSE(is_column_key(key)) << key;
}

TEST(TableColumns, OfSeveralHeadsAreThoseOfTheOneThatTurnsThenOfTheOneThatIsCalledSo) {
  const auto head = [](const std::string& names) {
    return begins_under("time," + names + "," + xyz_of("right"))[0];
  };
  EXPECT_EQ(head(xyz_of("hmd") + "," + posed("main_camera")), 4u);
  EXPECT_EQ(head(posed("main_camera") + "," + xyz_of("hmd")), 1u);
  EXPECT_EQ(head(xyz_of("helmet") + "," + xyz_of("the_hmd")), 4u);
  EXPECT_EQ(head(xyz_of("head_forward") + "," + xyz_of("head")), 4u);
  EXPECT_EQ(complaint([&] { head(xyz_of("camera") + "," + xyz_of("helmet")); }),
            "t.csv: columns: expected one head, found 2 ('camera', 'helmet'); say which, such as "
            "head = 'NAME*'");
}

TEST(TableColumns, OfAHandWithoutASideAreThoseOfTheOnlyOneThatMayBeIt) {
  const std::string head = "time," + xyz_of("head") + ",";
  EXPECT_THAT(begins_under(head + xyz_of("thing")), ElementsAre(1u, Place(), 4u));
  EXPECT_THAT(begins_under(head + xyz_of("thing"), {}, true), ElementsAre(1u, 4u, Place()));
  EXPECT_THAT(begins_under(head + xyz_of("ball") + "," + xyz_of("controller")),
              ElementsAre(1u, Place(), 7u));
  EXPECT_THAT(begins_under(head + xyz_of("ball") + "," + xyz_of("puck")),
              ElementsAre(1u, Place(), Place()));
  EXPECT_THAT(begins_under(head + xyz_of("marker_one") + "," + xyz_of("ball")),
              ElementsAre(1u, Place(), 7u));
  EXPECT_THAT(begins_under(head + xyz_of("marker_one")), ElementsAre(1u, Place(), Place()));
  // One without a place is none, though it turns.
  EXPECT_THAT(begins_under(head + xyz_of("thing") + ",gaze_qw," + xyz_of("gaze", "q")),
              ElementsAre(1u, Place(), 4u));
  // A head may be given by the user; of two objects, either may be one.
  EXPECT_THAT(begins_under("time," + xyz_of("thing")), ElementsAre(Place(), Place(), 1u));
  EXPECT_THAT(begins_under("time," + xyz_of("controller") + "," + xyz_of("ball")),
              ElementsAre(Place(), Place(), Place()));
}

TEST(TableColumns, OfAHandThatIsLeftOrRightAreOfNoOther) {
  const std::string head = "time," + xyz_of("head") + ",";
  for (const bool only_hand_is_left : {false, true}) {
    EXPECT_THAT(begins_under(head + xyz_of("left"), {}, only_hand_is_left),
                ElementsAre(1u, 4u, Place()));
    EXPECT_THAT(begins_under(head + xyz_of("right"), {}, only_hand_is_left),
                ElementsAre(1u, Place(), 4u));
    EXPECT_THAT(begins_under(head + xyz_of("left") + "," + xyz_of("ball"), {}, only_hand_is_left),
                ElementsAre(1u, 4u, Place()));
  }
}

TEST(TableColumns, OfATriggerWithoutAHandAreOfTheHandsUnlessTheySayTheOtherOne) {
  const auto of = [](const std::string& triggers) {
    return columns_under("time," + xyz_of("head") + "," + xyz_of("controller") + "," + triggers);
  };
  const MotionColumns loose = of("button,left_trigger");
  EXPECT_EQ(loose.parts[2].trigger, 7u);
  EXPECT_EQ(loose.parts[0].trigger, std::nullopt);
  EXPECT_EQ(loose.parts[1].trigger, std::nullopt);
  EXPECT_EQ(of("trigger,right_grip").parts[2].trigger, 8u);
  EXPECT_EQ(of("trigger,controller_grip").parts[2].trigger, 8u);
  EXPECT_EQ(of("left_grip,battery").parts[2].trigger, std::nullopt);
}

TEST(TableColumns, OfAButtonOfTheHeadAreNotUsed) {
  const std::string text =
      numbers_under("time," + xyz_of("head") + "," + xyz_of("controller") + ",head_button,pinch");
  const AnyTable table = read_any_table(text, "t.csv");
  const MotionColumns columns = find_columns(table, {}, false, "t.csv");
  EXPECT_EQ(columns.parts[0].trigger, 7u);
  EXPECT_THAT(columns.meanings,
              ElementsAre("time", "head, position x", "head, position y", "head, position z",
                          "right hand, position x", "right hand, position y",
                          "right hand, position z", "", "right hand, trigger"));
  EXPECT_THAT(told_of(mapping_of(table, columns)),
              testing::Not(testing::Contains(Pair("head.trigger", "head_button"))));
}

TEST(TableColumns, ThatAreMissingAreNamedWithThoseThatWereNotUnderstood) {
  const std::string other =
      "not understood: a, b (say what they are, such as time=t, head=HMD_*, right.qw=q0)";
  EXPECT_THAT(columns_under("a," + posed("head") + "," + posed("left") + ",b").missing,
              ElementsAre("no column of the time was found", other));
  EXPECT_THAT(columns_under("time," + posed("head") + "," + posed("right") + ",b").missing,
              IsEmpty());
  EXPECT_THAT(columns_under("time,a,b," + posed("head")).missing,
              ElementsAre("no hand was found (x, y and z of one object)", other));
  EXPECT_THAT(columns_under("time,a,b," + posed("left")).missing,
              ElementsAre("no head was found (x, y and z of one object)", other));
  EXPECT_THAT(columns_under("time," + xyz_of("head") + "," + posed("left")).missing,
              ElementsAre("the head has no rotation"));
  EXPECT_THAT(columns_under("time," + posed("head") + "," + xyz_of("right")).missing,
              ElementsAre("the right hand has no rotation"));
}

/// A table with a row for each object, four times; `others` are further cells.
std::string rows_of_objects(const std::string& names,
                            const std::vector<std::pair<std::string, std::string>>& objects) {
  std::string text = "time," + names + ",x,y,z,qw,qx,qy,qz\n";
  for (int i = 0; i < 4; ++i) {
    for (const auto& [first, second] : objects)
      text += fmt::format("{:.2f},{},{},1,2,3,1,0,0,0\n", 0.01 * i, first, second);
  }
  return text;
}

TEST(TableColumns, WithARowForEachObjectHaveOneOfTheirNames) {
  // The remarks have a number among them.
  const std::string text =
      rows_of_objects("remark,who", {{"head", "HMD"}, {"left", "tracker"}, {"3", "tracker"}});
  const AnyTable table = read_any_table(text, "t.csv");
  const MotionColumns columns = find_columns(table, {}, false, "t.csv");
  EXPECT_EQ(columns.object, 2u);
  EXPECT_THAT(columns.objects, ElementsAre("HMD", "", "tracker"));
  EXPECT_THAT(starts_of(columns), ElementsAre(3u, Place(), 3u));
  EXPECT_EQ(columns.parts[0].rotation, RotationKind::quaternion);
  EXPECT_EQ(columns.meanings[1], "");
  EXPECT_EQ(columns.meanings[2], "the object of the row");
  EXPECT_EQ(columns.meanings[3], "head, position x; right hand, position x");
  EXPECT_THAT(told_of(mapping_of(table, columns)),
              ElementsAre(Pair("time", "time"), Pair("object", "who")));
  EXPECT_THAT(find_columns(table, {}, true, "t.csv").objects, ElementsAre("HMD", "tracker", ""));
}

TEST(TableColumns, OfTheNamesOfObjectsMayBeTold) {
  const std::string text =
      rows_of_objects("remark,who", {{"head", "HMD"}, {"hand", "wand"}, {"left", "wand"}});
  EXPECT_EQ(columns_of_text(text).object, 1u);
  const MotionColumns told = columns_of_text(text, {{"object", "who"}});
  EXPECT_EQ(told.object, 2u);
  EXPECT_THAT(told.objects, ElementsAre("HMD", "", "wand"));
  // Names that say nothing are of a hand.
  const std::string unknown = rows_of_objects("a,who", {{"u", "tracker"}, {"v", "tracker"}});
  EXPECT_EQ(columns_of_text(unknown).object, std::nullopt);
  EXPECT_THAT(columns_of_text(unknown, {{"object", "who"}}).objects,
              ElementsAre("", "", "tracker"));
}

TEST(TableColumns, WithMoreThanTwentyWordsAreNoNamesOfObjects) {
  std::vector<std::pair<std::string, std::string>> objects = {{"a", "head"}, {"a", "right"}};
  for (char c = 'c'; c < 'c' + 18; ++c) objects.emplace_back("a", std::string("thing ") + c);
  EXPECT_EQ(columns_of_text(rows_of_objects("remark,who", objects)).object, 2u);
  objects.emplace_back("a", "one more");
  EXPECT_EQ(columns_of_text(rows_of_objects("remark,who", objects)).object, std::nullopt);
}

TEST(TableObjects, AreWhatTheStarOfAPatternStandsFor) {
  EXPECT_EQ(starred("HMD_x", "HMD_*"), "x");
  EXPECT_EQ(starred("x_HMD", "*_HMD"), "x");
  EXPECT_EQ(starred("ab_x_cd", "ab_*_cd"), "x");
  EXPECT_EQ(starred("abba", "ab*ba"), "");
  EXPECT_EQ(starred("aba", "ab*ba"), std::nullopt);
  EXPECT_EQ(starred("LHand_x", "HMD_*"), std::nullopt);
  EXPECT_EQ(starred("x_LHand", "*_HMD"), std::nullopt);
  EXPECT_EQ(starred("", "HMD*"), std::nullopt);
}

TEST(TableObjects, HaveAMatrixThatCountsFromZeroOrOneAndMayEndWithThePlace) {
  const auto head = [](const std::string& names) {
    const std::string text = numbers_under(names);
    return objects_of(read_any_table(text, "t.csv")).at(0).second.columns;
  };
  const auto nine_from = [](std::size_t first) {
    std::vector<Place> all;
    for (std::size_t i = 0; i < 9; ++i) all.emplace_back(first + i);
    return all;
  };
  const PartColumns from_zero = head("t," + nine_of("head") + "," + xyz_of("head"));
  EXPECT_THAT(from_zero.matrix, testing::ElementsAreArray(nine_from(1)));
  EXPECT_THAT(from_zero.position, ElementsAre(10u, 11u, 12u));
  EXPECT_EQ(from_zero.rotation, RotationKind::matrix);
  const PartColumns from_one =
      head("t,head_r11,head_r12,head_r13,head_r21,head_r22,head_r23,head_r31,head_r32,head_r33");
  EXPECT_THAT(from_one.matrix, testing::ElementsAreArray(nine_from(1)));
  EXPECT_EQ(from_one.rotation, RotationKind::matrix);
  // Four by four: the last row is no part of the pose.
  const std::string four =
      nine_of("head") + ",head_m03,head_m13,head_m23,head_m30,head_m31,head_m32,head_m33";
  const PartColumns pose = head("t," + four);
  EXPECT_THAT(pose.matrix, testing::ElementsAreArray(nine_from(1)));
  EXPECT_THAT(pose.position, ElementsAre(10u, 11u, 12u));
  EXPECT_THAT(pose.quaternion, testing::Each(Place()));
  EXPECT_EQ(pose.trigger, std::nullopt);
  EXPECT_EQ(pose.rotation, RotationKind::matrix);
  // A place that has its own columns is there.
  EXPECT_THAT(head("t," + four + "," + xyz_of("head")).position, ElementsAre(17u, 18u, 19u));
}

TEST(TableObjects, KeepTheirTriggerBesideColumnsThatRiseAndFall) {
  const auto trigger = [](const std::string& names, const std::string& last) {
    std::string text = names + "\n";
    for (const int x : {0, 1, 0, 1}) text += fmt::format("{0},0,{0},{0},{0}{1}\n", x, last);
    return objects_of(read_any_table(text, "t.csv")).at(0).second.columns.trigger;
  };
  const std::string names = "time,right_button,right_x,right_y,right_z";
  EXPECT_EQ(trigger(names, ""), 1u);
  EXPECT_EQ(trigger(names + ",right_pinch", ",0"), 1u);
  EXPECT_EQ(trigger(names + ",right_trigger", ",0"), 5u);
}

}  // namespace
}  // namespace headpin::devices
