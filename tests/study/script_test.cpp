// The R program of a study.

#include "study/script.h"

#include <gmock/gmock.h>

#include "tests/study/study_files.h"

namespace headpin::study {
namespace {

// Its first line is a comment; a line break in it would begin a line of R.
TEST(Script, HasTheNameOfItsDesignOnOneLine) {
  Design design = bundled_design();
  design.name = "two\nstop('lines')\rmore";
  EXPECT_THAT(r_script(design),
              testing::StartsWith(
                  "# The analysis of a study by the design two stop('lines') more. `headpin"));
}

}  // namespace
}  // namespace headpin::study
