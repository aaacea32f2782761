#pragma once

#include "study/design.h"
#include "study/questionnaire.h"
#include "tests/support/folder.h"

namespace headpin::study {

inline Design bundled_design(const std::string& name = "uno-slater-1997") {
  return parse_design(slurp(HEADPIN_SOURCE_DIR "/assets/designs/" + name + ".toml"), name);
}

inline Questionnaire bundled_questions() {
  return parse_questionnaire(
      slurp(HEADPIN_SOURCE_DIR "/assets/questionnaires/uno-slater-1997.toml"), "questions.toml");
}

}  // namespace headpin::study
