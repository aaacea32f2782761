#include "apps/study_tables.h"

#include <fmt/format.h>

#include "apps/stop.h"
#include "base/output_file.h"
#include "base/sha256.h"

namespace headpin::apps {

StudyTables::StudyTables(const std::filesystem::path& folder)
    : folder_(folder.string(), {.overwrite = true}) {}

void StudyTables::write(const std::string& name, const std::string& text) {
  check_stop();
  base::write_text({folder_.file(name).string(), {.overwrite = true, .durable = false}}, text);
}

void StudyTables::commit(const std::string& last) {
  check_stop();
  folder_.commit(last);
}

std::string made_from(const std::string& participants_csv) {
  return base::sha256(participants_csv) + "  ../tables/participants.csv\n";
}

void print_notes(const Study& study, const std::string& table) {
  for (const study::Note& note : study.design.notes) {
    if (note.table == table) fmt::print("  note: {}\n", note.text);
  }
}

}  // namespace headpin::apps
