// The fit of simulations, and what they say of a study's power.

#include "study/fit.h"

#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "base/random.h"
#include "study/power.h"
#include "study/power_plot.h"
#include "tests/study/study_files.h"

namespace headpin::study {
namespace {

// With a constant alone the estimate is the logit of the share, and the deviance that of the counts.
TEST(Fit, OfAConstantIsTheLogitOfTheShare) {
  const Eigen::MatrixXd x = Eigen::MatrixXd::Ones(4, 1);
  const Eigen::Vector4d y(1, 2, 5, 4);
  const Fit fit = fit_binomial(x, y, 6);
  ASSERT_TRUE(fit.converged);
  EXPECT_NEAR(fit.estimates[0], 0.0, 1e-9);  // 12 of 24
  const double pair_15 = 2 * (std::log(1.0 / 3) + 5 * std::log(5.0 / 3));
  const double pair_24 = 2 * (2 * std::log(2.0 / 3) + 4 * std::log(4.0 / 3));
  EXPECT_NEAR(fit.deviance, 2 * pair_15 + 2 * pair_24, 1e-9);
}

TEST(Fit, OfNothingIsAHalf) {
  const Fit fit = fit_binomial(Eigen::MatrixXd(2, 0), Eigen::Vector2d(3, 6), 6);
  ASSERT_TRUE(fit.converged);
  EXPECT_NEAR(fit.deviance, 2.0 * 6.0 * std::log(2.0), 1e-9);  // 3 of 6 is a half itself
}

// At the maximum of the likelihood its slope is nothing: X'(y - n p) = 0.
TEST(Fit, TheSlopeOfTheLikelihoodIsNothing) {
  Random random(7);
  Eigen::MatrixXd x(60, 4);
  Eigen::VectorXd y(60);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    for (Eigen::Index j = 0; j < x.cols(); ++j) x(i, j) = random.normal();
    y[i] = static_cast<double>(random.next() % 7);
  }
  const Fit fit = fit_binomial(x, y, 6);
  ASSERT_TRUE(fit.converged);
  const Eigen::ArrayXd p = 1.0 / (1.0 + (-(x * fit.estimates).array()).exp());
  EXPECT_LT((x.transpose() * (y.array() - 6.0 * p).matrix()).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(Fit, SeparationIsSaidAndItsDevianceStaysRight) {
  Eigen::MatrixXd x(4, 2);
  x << 1, 0, 1, 0, 1, 1, 1, 1;
  const Fit fit = fit_binomial(x, Eigen::Vector4d(2, 4, 6, 6), 6);
  EXPECT_FALSE(fit.converged);
  const Fit rest = fit_binomial(x.topRows(2).leftCols(1), Eigen::Vector2d(2, 4), 6);
  EXPECT_NEAR(fit.deviance, rest.deviance, 1e-5);  // the separated ones are fitted without error
}

// R's glm leaves such a column out; 0 of it is one of the many ways to write the same fit.
TEST(Fit, LeavesColumnsOutThatAreSumsOfEarlierOnes) {
  Random random(11);
  Eigen::MatrixXd x(30, 5);
  Eigen::VectorXd y(30);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const bool first = random.next() % 2 == 0;
    x.row(i) << 1.0, 0.1 * random.normal(), first, !first, random.normal();
    y[i] = static_cast<double>(random.next() % 7);
  }
  const Fit fit = fit_binomial(x, y, 6);
  Eigen::MatrixXd rest(30, 4);
  rest << x.leftCols(3), x.rightCols(1);
  const Fit without = fit_binomial(rest, y, 6);
  ASSERT_TRUE(fit.converged);
  EXPECT_EQ(fit.deviance, without.deviance);
  EXPECT_EQ(fit.estimates[3], 0.0);
  EXPECT_EQ(fit.estimates[4], without.estimates[3]);
}

// As many independent columns as people, or more: every count is fitted without error.
TEST(Fit, OfFewPeopleIsAsGoodAsItsColumnsAllow) {
  Eigen::MatrixXd x(3, 5);
  x << 1, 0, 0, 2, 1,  //
      0, 1, 0, 5, 0,   //
      0, 1, 0, 1, 1;
  EXPECT_NEAR(fit_binomial(x, Eigen::Vector3d(2, 0, 6), 6).deviance, 0.0, 1e-5);
}

// More people find more; where a term has no effect, one in twenty is chance. Of 80 studies that is 4
// with a deviation of 2.
TEST(Power, GrowsWithPeopleAndIsChanceWithoutAnEffect) {
  const Design design = bundled_design();
  const Questionnaire questions = bundled_questions();
  const auto nothing = [] {};
  const Power few = power_of(design, questions, 36, 80, 1, nothing);
  const Power many = power_of(design, questions, 180, 80, 1, nothing);
  ASSERT_EQ(many.terms.size(), 10u);
  double chance = 0.0;
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_GE(many.terms[i].found, few.terms[i].found - 0.1) << many.terms[i].term;
    chance += many.terms[i].found_without / 10;
  }
  EXPECT_GT(many.terms[3].found, 0.95);  // F
  EXPECT_NEAR(chance, 0.05, 0.04);       // of 800: 0.008
  EXPECT_GT(few.separated, many.separated);
  const Power again = power_of(design, questions, 36, 80, 1, nothing);
  EXPECT_EQ(again.terms[4].found, few.terms[4].found);
}

TEST(Power, IsThereForADesignOfOneTerm) {
  Design design = bundled_design();
  design.terms.resize(1);
  design.terms[0] = {};
  design.terms[0].name = "const";
  design.terms[0].estimate = -1.5;
  const Power power = power_of(design, bundled_questions(), 36, 20, 1, [] {});
  ASSERT_EQ(power.terms.size(), 1u);
  EXPECT_GT(power.terms[0].found, 0.95);
}

// Everybody has exactly one of the three changes, so a constant adds nothing to them, and without one
// of them the constant says the same.
TEST(Power, OfATermDoesNotDependOnTermsThatSayNothingNew) {
  const Design design = bundled_design();
  Design more = design;
  more.terms.insert(more.terms.begin(), Term{});
  more.terms[0].name = "const";
  more.terms[0].estimate = 0.0;
  const auto of = [](const Design& one) {
    return power_of(one, bundled_questions(), 18, 40, 1, [] {});
  };
  const Power power = of(design), same = of(more);
  ASSERT_EQ(same.terms.size(), 11u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(same.terms[i].found, 0.0) << same.terms[i].term;
  for (std::size_t i = 3; i < 10; ++i) {
    EXPECT_EQ(same.terms[i + 1].found, power.terms[i].found) << power.terms[i].term;
  }
  EXPECT_EQ(same.separated, power.separated);
}

// One number of people makes no line; its points are seen all the same.
TEST(PowerPlot, HasACircleForEachPointAndRoomForItsLegend) {
  const auto attribute = [](const std::string& svg, const std::string& name) {
    return std::stod(svg.substr(svg.find(name + "=\"") + name.size() + 2));
  };
  const auto count = [](const std::string& svg, const std::string& what) {
    int found = 0;
    for (std::size_t at = 0; (at = svg.find(what, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  Power power{36, 20, 0.0, {{"E", 0.5, 0.05}}};
  const std::string one = power_svg({power});
  EXPECT_THAT(one, testing::HasSubstr("<circle cx=\"260.0\" cy=\"200.0\""));  // the middle
  EXPECT_EQ(attribute(one, "width"), 620.0);
  EXPECT_EQ(attribute(one, "height"), 420.0);
  power.terms.assign(30, {std::string(40, 'm'), 0.5, 0.05});
  Power more = power;
  more.people = 72;
  const std::string many = power_svg({power, more});
  EXPECT_EQ(count(many, "<circle "), 60);
  EXPECT_GT(attribute(many, "width"), 506.0 + 40 * 7.0);
  EXPECT_GT(attribute(many, "height"), attribute(many.substr(many.rfind("<text ")), "y"));
  EXPECT_EQ(count(many, fmt::format("height=\"{:.0f}\"", attribute(many, "height"))), 2);
}

// A sum of 1/6 for each of six studies is less than 1.
TEST(Power, OfWhatIsAlwaysFoundIsOne) {
  Design design = bundled_design();
  design.terms.resize(1);
  design.terms[0] = {};
  design.terms[0].name = "const";
  design.terms[0].estimate = -1.5;
  for (const int studies : {6, 10, 11, 20}) {
    EXPECT_EQ(power_of(design, bundled_questions(), 36, studies, 1, [] {}).terms[0].found, 1.0);
  }
}

}  // namespace
}  // namespace headpin::study
